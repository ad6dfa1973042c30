"""Rows of an error budget at a resting pose, Eqs. (T17.1)-(T17.2)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from flexapod import kinematics
from flexapod.analysis.pose_errors.disturbances import vibration_rows
from flexapod.analysis.pose_errors.error_sources import ErrorRow
from flexapod.analysis.pose_errors.error_sources import accuracy_rows as built_rows
from flexapod.analysis.pose_errors.sensitivity import Sensitivity, sensitivity
from flexapod.analysis.results.causes import cause_names, errors_of
from flexapod.analysis.results.poses import BATCH
from flexapod.analysis.results.remarks import remark
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.analysis.results.time_history import Record
from flexapod.common.arrays import Array, Index
from flexapod.common.errors import ComputationError, InputError
from flexapod.common.quantities import NOTHING
from flexapod.kinematics.rotations import blocks, difference, matrix, quaternion
from flexapod.model import Robot, Study
from flexapod.solve.batch import RestStates
from flexapod.solve.frames import floor
from flexapod.solve.linear.random_vibration import SOURCES
from flexapod.solve.modal.elastic_robot import ElasticRobot
from flexapod.solve.statics.equilibrium import FOUND
from flexapod.solve.statics.locked_robot import LockedPoses, single_equilibrium
from flexapod.solve.statics.lost_motion import places_with_friction, reversal
from flexapod.solve.system import System

ROUNDING = 1e-9  # of the largest row, in place and in rotation


class ToolDeviation(NamedTuple):
    """The tool at T instants, displacement and rotation from the rigid path, world axes.

    ``whole`` (T, 6); ``by_leg`` (T, causes, legs, 6): what each of `cause_names` in each leg does to it.
    """

    whole: Array
    by_leg: Array


def elastic_causes(robot: Robot) -> tuple[str, ...]:
    """Names of the compliant parts; differences from the nominal geometry have rows of their own."""
    built = {part.cause for part in kinematics.built_parts(robot)}
    return tuple(name for name in cause_names(robot) if name not in built)


def tool_deviation(
    system: System, path: RigidPath, states: Record | RestStates, known: Sensitivity | None = None
) -> ToolDeviation:
    """Displacement of the tool at the instants of a path, and the causes' shares to first order, Eq. (T17.1).

    `known`: the sensitivity there, where it is.
    """
    robot, errors = path.robot, errors_of(system, path, states)
    columns = (known or sensitivity(path)).coordinate
    R = matrix(states.pose[:, 3:])
    tool = states.pose[:, :3] + R @ (robot.tool - robot.com)
    if robot.base_motion is not None:  # as seen from the base that is moved
        tool, R = floor(system, robot, states.q).seen(tool, R)
    attitude = states.pose[:, 3:] if robot.base_motion is None else quaternion(R)
    turn = difference(attitude, quaternion(path.poses.rotation))
    return ToolDeviation(
        whole=np.concatenate([tool - path.poses.place(robot.tool), turn], axis=1),
        by_leg=np.einsum("tclk,tlkx->tclx", errors.cause_array, columns),
    )


def static_deviation(elastic: ElasticRobot, path: RigidPath, some: Index) -> ToolDeviation:
    """The tool at rest at some poses of a path under gravity and the load at t = 0, temperatures as at t = 0."""
    found = []
    for chosen in blocks(len(some), BATCH):
        here = some[chosen]
        still = RigidPath(path.study, np.zeros(len(here)), path.poses.part(here))
        locked = elastic.lock(still)
        code = locked.equilibria.code
        if (code != FOUND).any():
            k = int(np.flatnonzero(code != FOUND)[0])
            raise ComputationError(
                f"no equilibrium of the pose at t = {path.time[here[k]]:.4g} s: {locked.equilibria.one(k).reason}",
                next_step="See `flexapod check`.",
            )
        found.append(tool_deviation(locked.system, still, locked.equilibria.states))
    return ToolDeviation(*(np.concatenate(parts) for parts in zip(*found, strict=True)))


def budget_rows(study: Study, locked: LockedPoses) -> tuple[list[ErrorRow], Array, list[str]]:
    """Rows at the one pose of a locked robot, what the systematic ones add up to (6,), and why a row is missing.

    That is the static deviation of the tool, and what simulations leave out: legs that are not straight.

    Raises
    ------
    ComputationError
        There is no equilibrium, or the pose is singular.
    """
    single_equilibrium(locked)
    ((table, whole, remarks),) = budget_rows_by_pose(study, locked)
    return significant_rows(table), whole, remarks


def names_of_rows(study: Study) -> tuple[str, ...]:
    """Names of the parts of `budget_rows_by_pose`, the same at all poses."""
    built = (row.part for row in built_rows(study, kinematics.home_pose(study.robot)))
    given = study.disturbance
    shaken = [words for name, words in SOURCES.items() if getattr(given, name, None) is not None]
    rubs = (f"{place} friction" for place in places_with_friction(study.robot))
    return tuple(dict.fromkeys([*elastic_causes(study.robot), *built, *rubs, *shaken]))


def budget_rows_by_pose(study: Study, locked: LockedPoses) -> Iterator[tuple[list[ErrorRow], Array, list[str]]]:
    """Rows of each pose whose equilibrium was found, what the systematic ones add up to, and why a row is missing."""
    poses = locked.rigid.resting(locked.at).poses
    path = RigidPath(study, np.zeros(len(poses)), poses)
    known = sensitivity(path)
    found = tool_deviation(locked.system, path, locked.equilibria.states[locked.at], known)
    rubs = reversal(locked)
    for k, (whole, by_leg) in enumerate(zip(*found, strict=True)):
        here, remarks = slice(k, k + 1), []
        table, systematic = _with_built(study, poses.part(here), known.part(here), whole, by_leg)
        table += _friction_rows(rubs, k)
        if study.disturbance is not None:
            try:
                table += vibration_rows(study, locked.one(k))
            except InputError as error:  # without damping no size, of drives that hold no noise: the rest is as before
                remarks.append(remark("no vibration", why=error))
        yield table, systematic, remarks


def _friction_rows(found: Mapping[str, Array], k: int) -> list[ErrorRow]:
    """Rows of the hysteretic error by friction at the kth pose."""
    how = "friction at its limits on the flexible robot at rest, whichever way things slide"
    return [ErrorRow(f"{place} friction", "hysteretic", "", by_leg[k], how) for place, by_leg in found.items()]


def _with_built(
    study: Study, pose: kinematics.Poses, known: Sensitivity, whole: Array, by_leg: Array
) -> tuple[list[ErrorRow], Array]:
    """Rows of compliant parts and of differences from nominal, and the sum of the systematic ones."""
    how = "static equilibrium under gravity and the load at t = 0; of each leg to first order"
    shares = dict(zip(cause_names(study.robot), by_leg, strict=True))
    table = [ErrorRow(name, "systematic", "repeatable", shares[name], how) for name in elastic_causes(study.robot)]
    built, simulated = built_rows(study, pose, known), {part.name for part in kinematics.built_parts(study.robot)}
    beside = [row.by_leg.sum(axis=0) for row in built if row.kind == "systematic" and row.part not in simulated]
    return [*table, *built], whole + np.sum([np.zeros(6), *beside], axis=0)


def significant_rows(table: list[ErrorRow]) -> list[ErrorRow]:
    """The rows that are more than rounding."""
    sizes = np.array([np.abs(row.by_leg).max(axis=0) for row in table]).reshape(-1, 2, 3).max(axis=2)
    kept = (sizes > np.maximum(ROUNDING * sizes.max(axis=0), NOTHING)).any(axis=1) if table else []
    return [row for row, keep in zip(table, kept, strict=True) if keep]
