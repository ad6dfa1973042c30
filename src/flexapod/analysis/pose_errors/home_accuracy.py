"""The accuracy of the tool at home, and how far the centre of mass rests off its drawn place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod import kinematics
from flexapod.analysis.pose_errors.backlash import half_play
from flexapod.analysis.pose_errors.bent_legs import has_bent_legs
from flexapod.analysis.pose_errors.error_sources import PoseErrors
from flexapod.analysis.pose_errors.tolerances import thermal_drift
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.common.quantities import NOTHING
from flexapod.common.ranking import first_largest, largest_item
from flexapod.model import Robot, Study


@dataclass(frozen=True, kw_only=True)
class HomeAccuracy:
    """Errors of the tool at home [m], [rad]; None of those that the robot does not have.

    `moved` (6,): by geometry as built and heat, `largest` the part that does most of it, `largest_size` [m] how
    much;
    `drift`: how far the temperatures of a table move it from its start [m], and when [s]; `sigma` (3,): standard
    deviations by tolerances; `play` (3,): largest way by play.
    """

    moved: tuple[float, ...] | None
    largest: str
    largest_size: float
    drift: tuple[float, float] | None
    sigma: tuple[float, ...] | None
    play: tuple[float, ...] | None


def home_accuracy(study: Study) -> HomeAccuracy | str | None:
    """Errors of the tool at home by geometry, heat, tolerances and play, or why they are unknown.

    None of a robot without them.
    """
    robot = study.robot
    if robot.platform_fixed or not differs_from_drawing(robot):
        return None
    at = PoseErrors(study, kinematics.home_pose(robot))
    try:
        sizes = {name: float(np.linalg.norm(part[:, :3].sum(axis=0))) for name, part in at.parts.items()}
        whole = np.sum([*at.parts.values(), np.zeros((robot.count, 6))], axis=(0, 1))
        largest = largest_item(sizes, key=lambda name: sizes[name]) if whole.any() else ""
        times = None if robot.heat is None else robot.heat.time
        spread = at.tolerance_effects
        return HomeAccuracy(
            moved=tuple(whole.tolist()) if whole.any() else None,
            largest=largest,
            largest_size=sizes.get(largest, 0.0),
            drift=None if times is None else _drift(at, times),
            sigma=_sigma([one.covariance for one in spread]) if spread else None,
            play=tuple(at.play.worst[0, :3].tolist()) if at.has_backlash else None,
        )
    except ComputationError as error:
        return error.what


def _sigma(covariances: list[Array]) -> tuple[float, ...]:
    return tuple(np.sqrt(np.diag(np.sum(covariances, axis=0)))[:3].tolist())


def _drift(at: PoseErrors, times: Array) -> tuple[float, float] | None:
    """Largest drift of the tool by a table of temperatures, from its start [m], and its time [s]."""
    try:
        moved = thermal_drift(at.robot, at.pose, times)
    except ComputationError:  # held more often than it needs: strained by heat, which only forces tell
        return None
    far = np.linalg.norm((moved - moved[0])[:, :3], axis=1)
    last = first_largest(far)
    return float(far[last]), float(times[last])


@dataclass(frozen=True, kw_only=True)
class RestOffset:
    """Centre of mass at rest less its drawn place, `off` (3,) [m]; of it `built` (3,) by geometry as built and heat.

    `by_heat`: it is heat alone; what is left is by weight and load.
    """

    off: tuple[float, ...]
    built: tuple[float, ...]
    by_heat: bool


def rest_offset(study: Study, pose: kinematics.Poses, off: Array) -> RestOffset:
    """Parts of what the centre of mass at rest is off its drawn place, `off` (3,) [m]."""
    known = np.linalg.norm(off) >= NOTHING and kinematics.built_parts(study.robot)
    try:
        each = PoseErrors(study, pose).parts if known else {}
    except ComputationError:  # held more often than it needs: strained by heat, which only forces tell
        each = {}
    moved = np.sum([*each.values(), np.zeros((study.robot.count, 6))], axis=(0, 1))
    arm = pose.rotation[0] @ (study.robot.com - study.robot.tool)
    built = moved[:3] + np.cross(moved[3:], arm)
    return RestOffset(
        off=tuple(off.tolist()),
        built=tuple(built.tolist()),
        by_heat=all(name.startswith("heat") for name in each),
    )


def differs_from_drawing(robot: Robot) -> bool:
    """Test whether the study says anything of how the robot differs from the drawing."""
    some = bool(half_play(robot).any()) or has_bent_legs(robot)
    return bool(kinematics.built_parts(robot)) or robot.tolerances is not None or some
