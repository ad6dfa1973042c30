"""Loops of drives that are unstable at poses, or on the way of a motion."""

from __future__ import annotations

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.results.poses import coordinate_words, coordinates_of
from flexapod.common.arrays import Array
from flexapod.common.errors import FlexapodError
from flexapod.common.quantities import text
from flexapod.common.ranking import first_largest
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.modal.modal_loops import unstable_words
from flexapod.solve.modal.modes import modes_of

__all__ = ["loop_remarks", "loops", "unstable_at"]

INSTANTS = 11


def loops(robot: model.Robot) -> bool:
    """Whether a robot has loops that can be unstable."""
    return any(leg.screw is not None and leg.screw.loops for leg in robot.legs)


def loop_remarks(study: model.Study, poses: kinematics.Poses | None = None) -> list[str]:
    """That they are, at poses or at some instants of the motion, of which the worst is named.

    Nothing where they are not, or where there are no modes.
    """
    if not loops(study.robot):
        return []
    t = np.linspace(0.0, min(study.duration, study.motion.end_time - study.motion.hold), INSTANTS)
    poses = kinematics.poses(study.robot, study.motion, t) if (moving := poses is None) else poses
    at_rest = kinematics.Poses.at_rest(poses.position, poses.rotation)
    try:
        locked = locked_poses(study.robot, study.simulation, at_rest, study.load)
        rates = modes_of(locked).growth
    except FlexapodError:
        return []
    if rates is None or not rates.any():
        return []
    worst, count = first_largest(rates), int((rates > 0).sum())
    last = text(float(t[locked.at[worst]]), "s")
    where = f" at {count} of {INSTANTS} instants, most at t = {last}" if moving else ""
    return unstable_words(float(rates[worst]), where)


def unstable_at(robot: model.Robot, poses: kinematics.Poses, rates: Array) -> list[str]:
    """At how many of P poses they are, and at which one most; ``rates`` (P,): growth there [1/s]."""
    if not (count := int((rates > 0).sum())):
        return []
    worst = first_largest(rates)
    at = coordinates_of(robot, poses.part(slice(worst, worst + 1)))[0]
    moved = {name: x for name, x in zip(model.AXES, at.tolist(), strict=True) if abs(x) > 1e-9}
    where = f"at {coordinate_words(moved)} from home" if moved else "at home"
    return unstable_words(float(rates[worst]), f" at {count} of {rates.size} poses, most {where}")
