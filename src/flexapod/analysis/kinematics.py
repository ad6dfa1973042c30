"""The rigid robot as Datasets: mobility, lengths, poses, forces over a motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from flexapod import kinematics, model
from flexapod.analysis.checks.checks import check_geometry
from flexapod.analysis.results.arguments import LoadLike, PoseLike, RobotLike, as_pose, as_study, study_at_pose
from flexapod.analysis.results.attributes import attributes
from flexapod.analysis.results.lazy_arrays import LazyArrays
from flexapod.analysis.results.leg_results import drive_forms, leg_labels, rigid_leg_results, rigid_reactions
from flexapod.analysis.results.rigid_path import RigidPath, open_force_words
from flexapod.analysis.results.robot_results import rigid_force_results
from flexapod.analysis.results.variables import dataset
from flexapod.common.arrays import Array, floats
from flexapod.common.errors import InputError
from flexapod.common.resources import one_thread
from flexapod.common.units import quantities
from flexapod.kinematics.rotations import quaternion
from flexapod.mechanics.elements.registry import refuse_tables

if TYPE_CHECKING:
    from xarray import Dataset


@one_thread()
def mobility(robot: RobotLike, pose: PoseLike = None) -> Dataset:
    """Motions of the rigid robot at one pose and next to it, by rank, Eqs. (T14.11)-(T14.15).

    Parameters
    ----------
    robot : Robot, Study or path
    pose : pose, optional
        As for `modes`; default home.

    Returns
    -------
    xarray.Dataset
        `mobility`, `locked` (with all drives locked), `redundant` conditions of joints, `self_stress` (forces that
        drives and joints can exert against each other), `freedoms` of all joints, `gruebler` (motions by counting),
        `motions` by name with their `motion_twist` (platform frame's origin, world axes), `mobility_nearby` and
        `locked_nearby` at two displaced poses; the attribute `words` says it in sentences.

    Raises
    ------
    InputError
        A pose that the legs do not reach.

    Examples
    --------
    >>> data = fx.mobility(fx.preset("tripod"))
    >>> int(data.mobility), [str(name) for name in data.motions.values]
    (3, ['heave', 'roll', 'pitch'])
    """
    study = study_at_pose(robot)
    legs = kinematics.rigid_limbs(study.robot)
    at = None if pose is None else kinematics.posture(study.robot, as_pose(study.robot, pose, check=False))
    found, near = (
        kinematics.mobility(legs, at),
        [kinematics.mobility(legs, there) for there in kinematics.displaced(legs, at)],
    )
    lengths = np.array([legs.L_c] * 3 + [1.0] * 3)
    values = {
        "mobility": found.mobility,
        "locked": found.locked,
        "redundant": found.redundant,
        "self_stress": found.self_stress,
        "freedoms": found.freedoms,
        "gruebler": found.gruebler,
        "motions": np.array(kinematics.motion_names(legs, found.platform, at), dtype=str),
        "motion_twist": found.platform.T * lengths,
        "mobility_nearby": [m.mobility for m in near],
        "locked_nearby": [m.locked for m in near],
    }
    attrs = attributes(study, study.warnings) | {"words": "\n".join(kinematics.mobility_words(legs, at))}
    return dataset(values, attrs=attrs)


@one_thread()
def inverse_kinematics(
    robot: RobotLike,
    motion: model.Motion | None = None,
    *,
    duration: float | None = None,
    output_step: float | None = None,
) -> Dataset:
    """Leg lengths, rates, accelerations and joint angles of the rigid robot along a motion, Eqs. (T2.14)-(T2.20).

    Parameters
    ----------
    robot : Robot, Study or path
        A robot with its motion, a whole study, or its file.
    motion : Motion, optional
        In place of the study's.
    duration, output_step : float, optional
        In place of those of [simulation], s.

    Returns
    -------
    xarray.Dataset
        `leg_length_command`, its rate and acceleration, `leg_angle_rigid`, the rigid path of centre of mass and tool.

    Raises
    ------
    InputError
        The path leaves a stroke, pulls a piston out, folds a universal joint or is singular.

    Examples
    --------
    >>> data = fx.inverse_kinematics(fx.preset("paper-robot"))
    >>> print(f"{1e3 * float(data.leg_length_command.sel(leg=1)[0]):.1f} mm")
    915.2 mm
    """
    path, remarks = _path(_study(robot, motion, None, duration, output_step))
    return _path_dataset(path, _legs_and_payload(path), remarks)


@one_thread()
def inverse_dynamics(
    robot: RobotLike,
    motion: model.Motion | None = None,
    *,
    load: LoadLike = None,
    duration: float | None = None,
    output_step: float | None = None,
) -> Dataset:
    """Actuator forces and joint reactions of the rigid robot by Newton and Euler, Eqs. (T2.26)-(T2.36).

    Parameters
    ----------
    robot : Robot, Study or path
        A robot with its motion, a whole study, or its file.
    motion : Motion, optional
        In place of the study's.
    load : Load, wrench or array_like (6,), optional
        Fx Fy Fz [N], Mx My Mz [N m] at the tool, world axes, or a law; in place of the study's.
    duration, output_step : float, optional
        In place of those of [simulation], s.

    Returns
    -------
    xarray.Dataset
        `actuator_force_rigid`, `joint_force_rigid`, `base_force_rigid`, `base_moment_rigid` and the variables of
        `inverse_kinematics`.

    Raises
    ------
    InputError
        As `inverse_kinematics`.

    Examples
    --------
    >>> data = fx.inverse_dynamics(fx.preset("machine-hexapod"))
    >>> data.actuator_force_rigid.dims, data.actuator_force_rigid.units
    (('time', 'leg'), 'N')
    """
    path, remarks = _path(_study(robot, motion, load, duration, output_step))
    refuse_tables(path.robot.legs, "the rigid robot")
    forces = {**LazyArrays(rigid_force_results(path)), **rigid_reactions(path)}
    values = _legs_and_payload(path) | forces
    return _path_dataset(path, values, [*remarks, *open_force_words(path.forces)])


@one_thread()
def forward_kinematics(
    robot: RobotLike,
    lengths: ArrayLike,
    guess: PoseLike = None,
    *,
    time: ArrayLike | None = None,
) -> Dataset:
    """Poses of the rigid robot at given leg lengths, each near the one before, Eqs. (T2.41), (T14.17).

    Parameters
    ----------
    robot : Robot, Study or path
    lengths : array_like, shape (drives,) or (T, drives)
        Joint-to-joint lengths [m] of the driven legs, in their order; of a driven carriage its place as the study file
        counts it [m, of a crank rad]. One of each gives a single pose.
    guess : pose, optional
        Near the first one, as for `modes`; default home. All postures of six legs UPS: `flexapod.kinematics.postures`.
    time : array_like, shape (T,), optional
        Instants of the lengths [s]; default 0, 1, 2, ...

    Returns
    -------
    xarray.Dataset
        `platform_position`, `platform_quaternion`, `com_position`, `tool_position`, over `time` for a path of lengths;
        `leg_length_command`, and `drive_command` of legs that are not all driven along their strokes.

    Raises
    ------
    InputError
        Lengths that are not a number for each drive, a guess that is not a pose, or instants that do not fit.
    ComputationError
        No pose near the guess fits.

    Examples
    --------
    >>> data = fx.forward_kinematics(fx.preset("paper-robot"), [1, 1, 1, 1, 1, 1])
    >>> print(f"{1e3 * float(data.platform_position.sel(axis='z')):.1f} mm")
    986.1 mm
    """
    study = study_at_pose(robot)
    kind = "angle" if kinematics.rigid_limbs(study.robot).carriage == "crank" else "length"
    lengths = quantities(lengths, kind, key="lengths")
    given = _numbers(lengths, "lengths", "lengths [m] or places of carriages [m, rad], one for each drive")
    single = given.ndim == 1
    found = kinematics.forward_kinematics(study.robot, given, as_pose(study.robot, guess, check=False))
    given = np.atleast_2d(given)
    time = quantities(time, "time", key="time")
    t = np.arange(len(found), dtype=float) if time is None else _numbers(time, "time", "instants [s], (T,)")
    if single and time is not None:
        raise InputError("has no meaning for a single pose", key="time", next_step="Leave it out")
    if t.shape != (len(found),):
        raise InputError("does not fit the lengths", key="time", value=t.shape, allowed=f"({len(found)},)")
    values = {
        **_drives(study, t, found, given),
        "platform_position": found.position,
        "platform_quaternion": quaternion(found.rotation),
        "com_position": found.place(study.robot.com),
        "tool_position": found.place(study.robot.tool),
    }
    length, place, *_ = kinematics.reach(study.robot, found)
    excess = [*kinematics.strokes(study.robot, t, length), *kinematics.pull_out(study.robot, t, length)]
    excess += kinematics.carriages(study.robot, t, place)
    remarks = [*study.warnings, *(e.message for e in excess)]
    result = dataset(values, {"time": t}, attributes(study, remarks), drive_forms(study.robot))
    return result.isel(time=0, drop=True) if single else result


def _drives(study: model.Study, t: Array, found: kinematics.Poses, given: Array) -> dict[str, Array]:
    """Lengths of all legs as given, or where legs are not all driven along their strokes places of drives as well."""
    if all(leg.driven == "stroke" for leg in study.robot.legs):
        return {"leg_length_command": given}
    values = rigid_leg_results(RigidPath(study, t, found))
    return {name: values[name] for name in ("leg_length_command", "drive_command") if name in values}


def _legs_and_payload(path: RigidPath) -> dict[str, Array]:
    """Legs and payload of the rigid robot along its path, by name."""
    poses, robot = path.poses, path.robot
    return {
        **rigid_leg_results(path),
        "com_position_rigid": poses.place(robot.com),
        "tool_position_rigid": poses.place(robot.tool),
        "platform_quaternion_rigid": quaternion(poses.rotation),
    }


def _path_dataset(path: RigidPath, values: dict[str, Array], remarks: list[str]) -> Dataset:
    labels = {"time": path.time, **leg_labels(path.robot, rigid=True)}
    return dataset(values, labels, attributes(path.study, remarks), drive_forms(path.robot))


def _numbers(values: ArrayLike, key: str, allowed: str) -> Array:
    try:
        return floats(values)
    except ValueError:
        raise InputError("are not numbers", key=key, allowed=allowed) from None


def _study(
    robot: RobotLike,
    motion: model.Motion | None,
    load: LoadLike,
    duration: float | None,
    output_step: float | None,
) -> model.Study:
    study = as_study(robot, motion, load)
    return model.override(study, duration=duration, output_step=output_step)


def _path(study: model.Study) -> tuple[RigidPath, list[str]]:
    """The path at the instants of the output, once it has been checked, and remarks."""
    simulation, path = study.simulation, RigidPath(study)
    remarks = check_geometry(study, path)
    instants = np.arange(simulation.outputs(study.duration) + 1, dtype=float) * simulation.stored_step
    return path.at(instants), [*study.warnings, *remarks]
