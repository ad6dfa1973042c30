"""The accuracy of a pose as a Dataset."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from flexapod import kinematics
from flexapod.analysis.pose_errors.backlash import PLACES
from flexapod.analysis.pose_errors.error_sources import PoseErrors
from flexapod.analysis.pose_errors.tolerances import sample_displacements, thermal_drift, tool_displacement
from flexapod.analysis.results.arguments import PoseLike, RobotLike, as_pose, study_at_pose
from flexapod.analysis.results.attributes import attributes
from flexapod.analysis.results.remarks import remark
from flexapod.analysis.results.variables import AT_A_POSE, dataset
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError, InputError
from flexapod.common.resources import one_thread

if TYPE_CHECKING:
    from xarray import Dataset

MOST_DRAWS = 10_000_000


@one_thread()
def accuracy(robot: RobotLike, pose: PoseLike = None, *, draws: int = 0, seed: int = 0) -> Dataset:
    """Error of the tool at a pose by geometry and heat, and its possible error by tolerances.

    Parameters
    ----------
    robot : Robot, Study or path
        With `geometry`, `heat`, `tolerances`; what is missing of them is exact.
    pose : pose, optional
        As for `modes`; default home.
    draws : int
        Number of machines drawn within the tolerances, whose poses are computed exactly.
    seed : int
        Of the draws.

    Returns
    -------
    xarray.Dataset
        At the tool, along and about world x, y, z (`component`), real less drawn: `pose_error` exact,
        `pose_error_by_part` (error, leg, component) to first order; over the instants of `heat.file` `pose_drift`.
        `pose_sigma`, `pose_covariance` and, of tolerances given as boxes, `pose_worst`, the largest size of each
        component; the first and the last also by tolerance and leg. Of draws `sample_mean`, `sample_covariance`,
        `sample_largest`. Of play under gravity and load at rest `play_error`, by the signs of the forces, and
        `play_worst`, whatever they are; `play_by_place` (place, leg, component), and `pressing_force` (place, leg).
        Of legs with a bow or eccentric joints `leg_bow` (leg), their largest distance from the line of the joints
        under thrust, and `euler_share`, thrust over Euler load.

    Raises
    ------
    InputError
        A pose out of reach; a number of draws that is not one.
    ComputationError
        The pose is singular.

    Examples
    --------
    >>> data = fx.accuracy(fx.preset("machine-hexapod"))
    >>> print((1e6 * data.pose_sigma[:3]).round(1).values)  # um, x y z
    [37.6 37.6 13.9]
    """
    if isinstance(draws, bool) or not isinstance(draws, int) or not 0 <= draws <= MOST_DRAWS:
        raise InputError("is not a number of draws", key="draws", value=draws, allowed=f"0 to {MOST_DRAWS}")
    study = study_at_pose(robot)
    at = PoseErrors(study, as_pose(study.robot, pose))
    values, labels, remarks = _errors(at)
    for part in (_tolerances(at), _forces(at), _samples(at, draws, seed)):
        values, labels = values | part[0], labels | part[1]
    return dataset(values, labels, attributes(study, [*study.warnings, *remarks]), AT_A_POSE)


_Named = dict[str, ArrayLike]


def _errors(at: PoseErrors) -> tuple[_Named, _Named, list[str]]:
    robot, remarks, parts = at.robot, [], at.parts
    first = np.sum([*parts.values(), np.zeros((robot.count, 6))], axis=(0, 1))
    values: _Named = {"pose_error": first, "pose_error_first_order": first}
    labels: _Named = {}
    if not parts:
        return values, labels, remarks
    values["pose_error_by_part"], labels["error"] = np.array(list(parts.values())), list(parts)
    bent = 0.0 if at.bent_legs is None else parts["bent_legs"].sum(axis=0)
    try:
        values["pose_error"] = tool_displacement(robot, at.pose, kinematics.built_poses(robot, at.pose))[0] + bent
        if robot.heat is not None and robot.heat.time is not None:
            values["pose_drift"], labels["drift_time"] = (
                thermal_drift(robot, at.pose, robot.heat.time) + bent,
                robot.heat.time,
            )
    except ComputationError as error:
        remarks.append(remark("first order", why=error.what))
    return values, labels, remarks


def _tolerances(at: PoseErrors) -> tuple[_Named, _Named]:
    found = at.tolerance_effects
    covariance = np.sum([*(one.covariance for one in found), np.zeros((6, 6))], axis=0)
    worst = np.sum([*(one.worst for one in found), np.zeros((at.robot.count, 6))], axis=(0, 1))
    values: _Named = {
        "pose_sigma": np.sqrt(np.diag(covariance)), "pose_covariance": covariance, "pose_worst": worst
    }  # fmt: skip
    if not found:
        return values, {}
    values["pose_sigma_by_tolerance"] = np.array([one.sigma for one in found])
    values["pose_worst_by_tolerance"] = np.array([one.worst for one in found])
    return values, {"tolerance": [one.name for one in found]}


def _forces(at: PoseErrors) -> tuple[_Named, _Named]:
    """Values and labels of errors that depend on forces: play, and legs that are not straight."""
    values: _Named = {}
    if at.has_backlash:
        found = at.play
        values = {
            "play_error": found.error[0],
            "play_worst": found.worst[0],
            "play_by_place": np.sign(found.force[0])[..., None] * found.effect[0],
        }
    if at.bent_legs is not None:
        values |= {"leg_bow": at.bent_legs.deflection, "euler_share": at.bent_legs.share}
    return (values | {"pressing_force": at.play.force[0]}, {"place": list(PLACES)}) if values else ({}, {})


def _samples(at: PoseErrors, draws: int, seed: int) -> tuple[_Named, _Named]:
    if not draws:
        return {}, {}
    found: Array = sample_displacements(
        at.robot, at.pose, at.sensitivity, at.thrust, lambda: at.density_effect, count=draws, seed=seed
    )
    fits = np.isfinite(found).all(axis=1)
    if not fits.any():
        raise ComputationError(
            "no machine within the tolerances fits together without strain",
            next_step="Joints that hold too much take no errors across them: leave draws out",
        )
    found = found[fits]
    values = {
        "sample_mean": found.mean(axis=0),
        "sample_covariance": np.cov(found.T, bias=True),
        "sample_largest": np.abs(found).max(axis=0),
        "sample_count": len(found),
    }
    return values, {}
