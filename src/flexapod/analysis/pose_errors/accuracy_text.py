"""The accuracy at home in sentences."""

from __future__ import annotations

import numpy as np

from flexapod import kinematics
from flexapod.analysis.pose_errors.backlash import half_play
from flexapod.analysis.pose_errors.bent_legs import is_crooked
from flexapod.analysis.pose_errors.error_sources import AtPose
from flexapod.analysis.pose_errors.tolerances import drift
from flexapod.analysis.results.cause_labels import cause_in_words
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.common.quantities import NOTHING as LENGTH
from flexapod.common.quantities import UNSAID, along_axes, signed, text
from flexapod.common.ranking import first_largest, most
from flexapod.model import Robot, Study

NOTHING = 1e-12  # turn that is rounding [rad]


def accuracy_words(study: Study) -> tuple[str, ...]:
    """What errors of geometry, heat, tolerances and play do to the tool at home; nothing of a robot without them."""
    robot = study.robot
    if robot.platform_fixed or not is_real(robot):
        return ()
    at, found = AtPose(study, kinematics.home_pose(robot)), []
    try:
        parts = at.parts
        whole = np.sum([*parts.values(), np.zeros((robot.count, 6))], axis=(0, 1))
        if whole.any():
            largest = most(parts, key=lambda name: float(np.linalg.norm(parts[name][:, :3].sum(axis=0))))
            found.append(
                f"as built and warm the tool stands {_size(whole)} beside its drawn place at home, most of it by "
                f"{cause_in_words(largest)} ({text(float(np.linalg.norm(parts[largest][:, :3].sum(axis=0))), 'm', 3)})"
            )
        if robot.heat is not None and robot.heat.time is not None:
            found += _drift_words(at, robot.heat.time)
        if spread := at.spreading:
            sigma = np.sqrt(np.diag(np.sum([one.covariance for one in spread], axis=0)))
            found.append(f"tolerances spread the tool at home by {along_axes(sigma[:3])} (standard deviations)")
        if at.is_loose:
            found.append(f"play lets the tool move at home by up to {along_axes(at.play.worst[0, :3])}")
    except ComputationError as error:
        return (f"the accuracy at home cannot be said: {error.what}",)
    return tuple(found)


def _drift_words(at: AtPose, times: Array) -> list[str]:
    """How far the temperatures of a table move the tool from where it is at its start."""
    try:
        moved = drift(at.robot, at.pose, times)
    except ComputationError:  # held more often than it needs: strained by heat, which only forces tell
        return []
    far = np.linalg.norm((moved - moved[0])[:, :3], axis=1)
    last = first_largest(far)
    return [
        f"the temperatures of heat.file move the tool at home by up to {text(float(far[last]), 'm', 3)} from where it "
        f"stands at the start, at t = {times[last]:.4g} s"
    ]


def rest_words(study: Study, pose: kinematics.Poses, off: Array) -> str:
    """How far the centre of mass at rest is off its drawn place, `off` (3,) [m]: by heat and by weight, with signs."""
    size = float(np.linalg.norm(off))
    if size < LENGTH:
        return "At rest the centre of mass is where it is drawn."
    words = f"At rest the centre of mass is off by {signed(off)}"
    parts = kinematics.built_parts(study.robot)
    try:
        each = AtPose(study, pose).parts if parts else {}
    except ComputationError:  # held more often than it needs: strained by heat, which only forces tell
        each = {}
    moved = np.sum([*each.values(), np.zeros((study.robot.count, 6))], axis=(0, 1))
    arm = pose.rotation[0] @ (study.robot.com - study.robot.tool)
    built = moved[:3] + np.cross(moved[3:], arm)
    if np.linalg.norm(built) < UNSAID * size:
        return f"{words}."
    by = "heat" if all(name.startswith("heat") for name in each) else "heat and geometry as built"
    return f"{words}: by {by} {signed(built, off)}, by weight and load {signed(off - built, off)}."


def is_real(robot: Robot) -> bool:
    """Whether anything is said of how the robot differs from the drawing."""
    some = bool(half_play(robot).any()) or is_crooked(robot)
    return bool(kinematics.built_parts(robot)) or robot.tolerances is not None or some


def _size(moved: Array) -> str:
    turned = float(np.linalg.norm(moved[3:]))
    words = text(float(np.linalg.norm(moved[:3])), "m", 3)
    return words if turned < NOTHING else f"{words} and {text(turned, 'rad', 3)}"
