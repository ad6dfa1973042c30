"""The accuracy of a pose as a Dataset."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from flexapod import rigid
from flexapod.errors import ComputationError, InputError
from flexapod.model import Study
from flexapod.study.accuracy.play import PLACES, half_play, play_at
from flexapod.study.accuracy.sensitivity import Sensitivity, sensitivity
from flexapod.study.accuracy.spread import displacement, samples, spreading
from flexapod.study.accuracy.systematic import systematic
from flexapod.study.arguments import PoseLike, RobotLike, as_pose, at_pose
from flexapod.study.attributes import attributes
from flexapod.study.names import AT_A_POSE, dataset
from flexapod.typing import Array

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["accuracy"]

MOST_DRAWS = 10_000_000


def accuracy(robot: RobotLike, pose: PoseLike = None, *, draws: int = 0, seed: int = 0) -> Dataset:
    """How far the tool is from a pose by errors of geometry, by heat, and how far it may be by tolerances.

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

    Raises
    ------
    InputError
        A pose out of reach; a number of draws that is not one.
    ComputationError
        The pose is singular.
    """
    if isinstance(draws, bool) or not isinstance(draws, int) or not 0 <= draws <= MOST_DRAWS:
        raise InputError("is not a number of draws", key="draws", value=draws, allowed=f"0 to {MOST_DRAWS}")
    study = at_pose(robot)
    path = as_pose(study.robot, pose)
    at = sensitivity(study.robot, path)
    values, labels, remarks = _errors(study, path, at)
    for part in (_tolerances(study, at), _play(study, path, at), _samples(study, path, at, draws, seed)):
        values, labels = values | part[0], labels | part[1]
    return dataset(values, labels, attributes(study, [*study.warnings, *remarks]), AT_A_POSE)


_Named = dict[str, ArrayLike]


def _errors(study: Study, path: rigid.Poses, at: Sensitivity) -> tuple[_Named, _Named, list[str]]:
    robot, remarks, parts = study.robot, [], systematic(study.robot, at)
    first = np.sum([*parts.values(), np.zeros((robot.count, 6))], axis=(0, 1))
    values: _Named = {"pose_error": first, "pose_error_first_order": first}
    labels: _Named = {}
    if not parts:
        return values, labels, remarks
    values["pose_error_by_part"], labels["error"] = np.array(list(parts.values())), list(parts)
    try:
        values["pose_error"] = displacement(robot, path, rigid.built_poses(robot, path))[0]
        if robot.heat is not None and robot.heat.time is not None:
            t = robot.heat.time
            many = path.part(np.zeros(len(t), dtype=int))
            values["pose_drift"] = displacement(robot, many, rigid.built_poses(robot, many, t))
            labels["drift_time"] = t
    except ComputationError as error:
        remarks.append(f"pose_error is of first order, shared by the compliance of the legs: {error.what}")
    return values, labels, remarks


def _tolerances(study: Study, at: Sensitivity) -> tuple[_Named, _Named]:
    found = spreading(study.robot, at)
    covariance = np.sum([*(one.covariance for one in found), np.zeros((6, 6))], axis=0)
    worst = np.sum([*(one.worst for one in found), np.zeros((study.robot.count, 6))], axis=(0, 1))
    values: _Named = {
        "pose_sigma": np.sqrt(np.diag(covariance)), "pose_covariance": covariance, "pose_worst": worst
    }  # fmt: skip
    if not found:
        return values, {}
    values["pose_sigma_by_tolerance"] = np.array([one.sigma for one in found])
    values["pose_worst_by_tolerance"] = np.array([one.worst for one in found])
    return values, {"tolerance": [one.name for one in found]}


def _play(study: Study, path: rigid.Poses, at: Sensitivity) -> tuple[_Named, _Named]:
    if not half_play(study.robot).any():
        return {}, {}
    found = play_at(study, path, at)
    values: _Named = {
        "play_error": found.error[0],
        "play_worst": found.worst[0],
        "play_by_place": np.sign(found.force[0])[..., None] * found.effect[0],
        "pressing_force": found.force[0],
    }
    return values, {"place": list(PLACES)}


def _samples(study: Study, path: rigid.Poses, at: Sensitivity, draws: int, seed: int) -> tuple[_Named, _Named]:
    if not draws:
        return {}, {}
    found: Array = samples(study.robot, path, at, draws, seed)
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
