"""Rows of an error budget at a resting pose, Eqs. (T17.1)-(T17.2)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from flexapod import kinematics
from flexapod.analysis.modes_at_poses import poses_of
from flexapod.analysis.pose_errors.disturbances import vibration_rows
from flexapod.analysis.pose_errors.error_sources import ErrorRow
from flexapod.analysis.pose_errors.error_sources import rows as built_rows
from flexapod.analysis.pose_errors.sensitivity import Sensitivity, sensitivity
from flexapod.analysis.results.causes import cause_names, errors_of
from flexapod.analysis.results.poses import batches
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.analysis.results.time_history import Record
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError, InputError
from flexapod.common.quantities import NOTHING
from flexapod.kinematics.rotations import difference, matrix, quaternion
from flexapod.model import Robot, Study
from flexapod.solve.batch import RestStates
from flexapod.solve.frames import floor
from flexapod.solve.linear.random_vibration import SOURCES
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.statics.equilibrium import FOUND
from flexapod.solve.statics.locked_robot import LockedPoses, the_equilibrium
from flexapod.solve.statics.lost_motion import places_with_friction, reversal
from flexapod.solve.system import System

ROUNDING = 1e-9  # of the largest row, in place and in rotation


class Moved(NamedTuple):
    """The tool at T instants, displacement and rotation from the rigid path, world axes.

    ``whole`` (T, 6); ``by_leg`` (T, causes, legs, 6): what each of `cause_names` in each leg does to it.
    """

    whole: Array
    by_leg: Array


def elastic_causes(robot: Robot) -> tuple[str, ...]:
    """Names of what gives way; what differs from the drawing has rows of its own."""
    built = {part.cause for part in kinematics.built_parts(robot)}
    return tuple(name for name in cause_names(robot) if name not in built)


def moved(
    robot: Robot, system: System, path: RigidPath, states: Record | RestStates, known: Sensitivity | None = None
) -> Moved:
    """Displacement of the tool at the instants of a path, and the causes' shares to first order, Eq. (T17.1).

    `known`: the sensitivity there, where it is.
    """
    errors = errors_of(robot, system, path, states)
    columns = (known or sensitivity(robot, path.poses)).coordinate
    R = matrix(states.pose[:, 3:])
    tool = states.pose[:, :3] + R @ (robot.tool - robot.com)
    if robot.base_motion is not None:  # as seen from the base that is moved
        tool, R = floor(system, robot, states.q).seen(tool, R)
    attitude = states.pose[:, 3:] if robot.base_motion is None else quaternion(R)
    turn = difference(attitude, quaternion(path.poses.rotation))
    return Moved(
        whole=np.concatenate([tool - path.poses.place(robot.tool), turn], axis=1),
        by_leg=np.einsum("tclk,tlkx->tclx", errors.stacked, columns),
    )


def at_rest(study: Study, poses: kinematics.Poses, t: Array) -> Moved:
    """The tool at resting poses under gravity and the load at t = 0, temperatures as at t = 0.

    ``t`` (P,): instants of the poses, for what is said of those without an equilibrium.
    """
    found = []
    for chosen in batches(len(poses)):
        locked = locked_poses(study.robot, study.simulation, poses.part(chosen), study.load)
        code = locked.equilibria.code
        if (code != FOUND).any():
            k = int(np.flatnonzero(code != FOUND)[0])
            raise ComputationError(
                f"no equilibrium of the pose at t = {t[chosen][k]:.4g} s: {locked.equilibria.one(k).reason}",
                next_step="See `flexapod check`.",
            )
        found.append(_rest(study, locked, poses.part(chosen)))
    return Moved(*(np.concatenate(parts) for parts in zip(*found, strict=True)))


def _rest(study: Study, locked: LockedPoses, poses: kinematics.Poses) -> Moved:
    path = RigidPath(study, np.zeros(len(poses)), poses)
    return moved(study.robot, locked.system, path, locked.equilibria.states)


def rows(study: Study, pose: kinematics.Poses) -> tuple[list[ErrorRow], Array, list[str]]:
    """Rows at one pose, what the systematic ones add up to (6,), and why a row is missing.

    That is the static deviation of the tool, and what simulations leave out: legs that are not straight.

    Raises
    ------
    InputError
        A pure force drive.
    ComputationError
        There is no equilibrium, or the pose is singular.
    """
    locked = locked_poses(study.robot, study.simulation, pose, study.load)
    the_equilibrium(locked)
    ((table, whole, remarks),) = rows_of_poses(study, locked)
    return without_rounding(table), whole, remarks


def names_of_rows(study: Study) -> tuple[str, ...]:
    """Names of the parts of `rows_of_poses`, the same at all poses."""
    built = (row.part for row in built_rows(study, kinematics.home_pose(study.robot)))
    given = study.disturbance
    shaken = [words for name, words in SOURCES.items() if getattr(given, name, None) is not None]
    rubs = (f"{place} friction" for place in places_with_friction(study.robot))
    return tuple(dict.fromkeys([*elastic_causes(study.robot), *built, *rubs, *shaken]))


def rows_of_poses(study: Study, locked: LockedPoses) -> Iterator[tuple[list[ErrorRow], Array, list[str]]]:
    """Rows of each pose whose equilibrium was found, what the systematic ones add up to, and why a row is missing."""
    poses = poses_of(locked.path, locked.at)
    path, known = RigidPath(study, np.zeros(len(poses)), poses), sensitivity(study.robot, poses)
    found = moved(study.robot, locked.system, path, locked.equilibria.states[locked.at], known)
    rubs = reversal(locked)
    for k, (whole, by_leg) in enumerate(zip(*found, strict=True)):
        here, remarks = slice(k, k + 1), []
        table, systematic = _with_built(study, poses.part(here), known.part(here), whole, by_leg)
        table += _friction_rows(rubs, k)
        if study.disturbance is not None:
            try:
                table += vibration_rows(study, locked.one(k))
            except InputError as error:  # without damping no size, of drives that hold no noise: the rest is as before
                remarks.append(f"vibration by disturbances has no row: {error}")
        yield table, systematic, remarks


def _friction_rows(found: Mapping[str, Array], k: int) -> list[ErrorRow]:
    """What friction leaves open at one of some poses."""
    how = "friction at its limits on the flexible robot at rest, whichever way things slide"
    return [ErrorRow(f"{place} friction", "hysteretic", "", by_leg[k], how) for place, by_leg in found.items()]


def _with_built(
    study: Study, pose: kinematics.Poses, known: Sensitivity, whole: Array, by_leg: Array
) -> tuple[list[ErrorRow], Array]:
    """Rows of what gives way and of what differs from the drawing, and what the systematic ones add up to."""
    how = "static equilibrium under gravity and the load at t = 0; of each leg to first order"
    shares = dict(zip(cause_names(study.robot), by_leg, strict=True))
    table = [ErrorRow(name, "systematic", "repeatable", shares[name], how) for name in elastic_causes(study.robot)]
    built, simulated = built_rows(study, pose, known), {part.name for part in kinematics.built_parts(study.robot)}
    beside = [row.by_leg.sum(axis=0) for row in built if row.kind == "systematic" and row.part not in simulated]
    return [*table, *built], whole + np.sum([np.zeros(6), *beside], axis=0)


def without_rounding(table: list[ErrorRow]) -> list[ErrorRow]:
    """The rows that are more than rounding."""
    sizes = np.array([np.abs(row.by_leg).max(axis=0) for row in table]).reshape(-1, 2, 3).max(axis=2)
    kept = (sizes > np.maximum(ROUNDING * sizes.max(axis=0), NOTHING)).any(axis=1) if table else []
    return [row for row, keep in zip(table, kept, strict=True) if keep]
