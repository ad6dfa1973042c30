"""Loops of drives that are unstable at poses, or on the way of a motion.

Whether fixed steps follow what a motion leaves vibrating, Eq. (T8.24).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.checks.estimates import residual_vibration
from flexapod.analysis.results.poses import coordinate_words, coordinates_of
from flexapod.common.arrays import Array
from flexapod.common.errors import FlexapodError
from flexapod.common.quantities import number, text
from flexapod.common.ranking import first_largest
from flexapod.model import Study
from flexapod.solve.modal.at_poses import locked_poses, robot_modes
from flexapod.solve.modal.modal_loops import unstable_words
from flexapod.solve.modal.modes import RobotModes, modes_of

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


FEWEST = 20.0  # steps a period, whose length is then 0.8 % too long, Eq. (T6.16)
DRIFT = 0.1  # periods by which a mode may come too late to the motion's end
EXCITED = 1e-3  # of the largest deviation: smaller vibrations are not looked at
PER_PERIOD, MOST = 12, 4000  # instants of the motion, of a period of the highest mode that is asked; of all


def step_warnings(study: Study, step: float, deviation: Callable[[], Array]) -> list[str]:
    """A remark where a mode that the motion leaves vibrating has too few of the fixed steps a period.

    How a mode vibrates is estimated as for `flexapod check`: it answers by itself to the inertia of the rigid path.
    What starts, loads and floors excite is not asked for. ``deviation``: of the tool, (T, 3) [m].
    """
    end = study.motion.end_time - study.motion.hold
    ends = 0 < end <= study.duration * (1 + 1e-9)  # else nothing is left of the motion, or it is not over
    if study.simulation.tolerance is not None or study.robot.platform_fixed or not ends:
        return []
    try:
        at = kinematics.poses(study.robot, study.motion, np.array([end]))
        rest = kinematics.Poses.at_rest(at.position, at.rotation)
        modes = robot_modes(study.robot, study.simulation, rest, study.load, end)
    except FlexapodError:
        return []
    if modes.growth:
        return []
    frequency, amplitude, needed = _vibrations(study, modes, end)
    followed = frequency * step * needed < 1 + 1e-9
    excited = amplitude > EXCITED * np.abs(deviation()).max()
    if not (excited & ~followed).any():
        return []
    worst = int(np.where(followed, 0, amplitude).argmax())
    finest = float((1 / (frequency * needed))[excited].min())
    digit = 10.0 ** np.floor(np.log10(finest))
    return [
        f"the motion leaves the tool vibrating by some {number(1e6 * amplitude[worst], 2)} um at "
        f"{number(frequency[worst], 3)} Hz: {number(1 / (frequency[worst] * step), 3)} steps a period are fewer than "
        f"the {number(needed[worst], 2)} that follow it. Set simulation.tolerance = 1e-4 in place of step, or step = "
        f"{np.floor(finest / digit * (1 + 1e-9)) * digit:.1g} s"
    ]


def _vibrations(study: Study, modes: RobotModes, end: float) -> tuple[Array, Array, Array]:
    """Frequencies [Hz], amplitudes of the tool [m] after the motion, and steps a period that they need, Eq. (T8.24)."""
    highest = modes.frequency[modes.damping_ratio < 1].max(initial=0.0)
    t = np.linspace(0.0, end, int(min(np.ceil(PER_PERIOD * highest * end), MOST)) + 2)
    path = kinematics.poses(study.robot, study.motion, t)
    found = residual_vibration(study.robot, modes, t, path, from_rest=study.initial.start != "moving")
    with np.errstate(divide="ignore"):  # of an undamped robot the ratio is 0, or rounding on either side of it
        periods = np.minimum(found.frequency * end, 1 / (2 * np.pi * np.maximum(found.damping_ratio, 0.0)))
    return found.frequency, found.amplitude, steps_needed(periods)


def steps_needed(periods: Array) -> Array:
    """Steps a period that follow a vibration over so many of its periods, Eq. (T8.24)."""
    return np.maximum(FEWEST, 2 * np.pi * np.sqrt(periods / (12 * DRIFT)))
