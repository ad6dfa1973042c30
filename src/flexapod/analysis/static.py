"""Modes and stiffness, commands of the drives held: a pose in, a Dataset out; for modes also many poses."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.checks.checks import pose_remarks
from flexapod.analysis.checks.plausibility import rest_warnings
from flexapod.analysis.checks.stability import unstable
from flexapod.analysis.modes_at_poses import modes_at_poses
from flexapod.analysis.results.arguments import LoadLike, PoseLike, RigidPose, RobotLike, read_subject, study_at_pose
from flexapod.analysis.results.attributes import attributes
from flexapod.analysis.results.mode_shapes import STATIONS, mode_values
from flexapod.analysis.results.poses import as_poses, has_many_poses
from flexapod.analysis.results.variables import ONE_POSE_FORMS, dataset
from flexapod.common.errors import InputError
from flexapod.common.resources import one_thread
from flexapod.solve.batch import RestStates
from flexapod.solve.modal.actuator_modes import actuator_modes
from flexapod.solve.modal.at_poses import stiffness_at
from flexapod.solve.modal.elastic_robot import ElasticRobot
from flexapod.solve.modal.modes import single_pose_modes
from flexapod.solve.system import State, System

if TYPE_CHECKING:
    from xarray import Dataset


@one_thread()
def modes(
    robot: RobotLike | model.ActuatorStudy,
    pose: PoseLike = None,
    *,
    load: LoadLike = None,
    fidelity: str | None = None,
    modes: int | None = None,
    axial_modes: int | None = None,
    basis: str | None = None,
    friction: str | None = None,
    shapes: bool = False,
) -> Dataset:
    """Undamped and damped modes about the static equilibrium, commands of the drives held, Eqs. (T7.2)-(T7.5).

    Of a single actuator those of its straight beam at t = 0, hub and extension held: `frequency`, `damping_ratio`,
    `kind`; it takes neither pose nor load.

    Parameters
    ----------
    robot : Robot, Study, ActuatorStudy or path
    pose : pose, optional
        Surge, sway, heave [m], roll, pitch, yaw [rad] from home, by name or as (6,); default home. Many poses at once:
        names with arrays, or (P, 6).
    load : Load, wrench or array_like (6,), optional
        Fx Fy Fz [N], Mx My Mz [N m] at the tool, world axes; in place of the study's; a law is
        taken just before t = 0, where a simulation from equilibrium starts: a step at t = 0 has not come yet. So is the
        table of a force drive; law "rigid" pushes as the rigid robot needs at rest in the pose.
    fidelity, modes, axial_modes, basis, friction : optional
        In place of those of the study; a bare robot has assumed-modes, 3 per plane, tip-load, friction "sliding".
    shapes : bool
        Of many poses also damping ratios, kinds and shapes: ten times the time, and much memory.

    Returns
    -------
    xarray.Dataset
        `frequency` [Hz] ascending, `damping_ratio`, `kind`, `platform_shape`, `leg_shape`, `leg_stretch`;
        `platform_position`, `platform_quaternion`, `com_sag` of the equilibrium. Shapes are mass-normalised.
        Many poses: `frequency` (pose, mode), `com_sag`, position and quaternion, `pose_from_home`, and in `reason` why
        a pose has none (NaN); it is not an error there. `cut_off` marks poses that a singularity separates from home;
        a map calls them out of reach.

    Raises
    ------
    InputError
        A pose out of reach, rigid legs on prescribed strokes (nothing can move), or a pure force drive.
    ComputationError
        No equilibrium at this pose.

    Examples
    --------
    >>> data = fx.modes(fx.preset("machine-hexapod"))
    >>> print(data.frequency[:3].round(1).values, data.kind[:3].values)
    [56.2 56.2 83.2] ['payload' 'payload' 'payload']
    """
    settings = {"fidelity": fidelity, "modes": modes, "axial_modes": axial_modes, "basis": basis, "friction": friction}
    if isinstance(robot := read_subject(robot), model.ActuatorStudy):
        return _beam(robot, {"pose": pose, "load": load}, settings)
    if has_many_poses(pose):
        study = model.override(study_at_pose(robot, load), **settings)  # type: ignore[arg-type]
        return modes_at_poses(study, as_poses(study.robot, pose), shapes=shapes, attrs=_settings(study))
    study, at = _problem(robot, pose, load, settings)
    found = single_pose_modes(ElasticRobot(study.robot, study.simulation, study.load).lock(at))
    values = mode_values(study.robot, found, at.poses)
    coords = {"mode": list(range(1, len(values["frequency"]) + 1)), "station": STATIONS}
    state, loops = found.equilibrium.state, unstable(found.growth)
    return dataset(values, coords, _attributes(study, at, found.system, state, loops), ONE_POSE_FORMS)


def _beam(study: model.ActuatorStudy, given: dict[str, object], settings: dict[str, object]) -> Dataset:
    """Modes of a single actuator's beam."""
    for key, value in given.items():
        if value is not None:
            raise InputError(
                "has no meaning for a single actuator, whose straight beam vibrates where it stands at t = 0",
                key=key,
                value=str(value),
                next_step="Leave it out; actuator.free_length and elevation (or angle) say where the beam stands",
            )
    study = model.override(study, **settings)  # type: ignore[arg-type]
    found = actuator_modes(study.actuator, study.simulation)
    values = {"frequency": found.frequency, "damping_ratio": found.damping_ratio, "kind": list(found.kind)}
    return dataset(values, {"mode": np.arange(1, len(found.kind) + 1)}, _settings(study))


@one_thread()
def stiffness(
    robot: RobotLike,
    pose: PoseLike = None,
    *,
    load: LoadLike = None,
    fidelity: str | None = None,
    modes: int | None = None,
    axial_modes: int | None = None,
    basis: str | None = None,
    friction: str | None = None,
) -> Dataset:
    """Stiffness at the tool about the static equilibrium, commands of the drives held, Eqs. (T7.6)-(T7.8).

    Parameters
    ----------
    robot, pose, load, fidelity, modes, axial_modes, basis, friction
        As for `modes`.

    Returns
    -------
    xarray.Dataset
        `stiffness` (wrench, component), world axes [N/m, N, N m/rad]: the sum over the legs of `stiffness_share` and of
        `stiffness_turning`, what the joint forces and the load add when the platform turns.

    Raises
    ------
    InputError
        A pose out of reach, no compliance (rigid legs on prescribed strokes), or a pure force drive.
    ComputationError
        No equilibrium at this pose.

    Examples
    --------
    >>> K = fx.stiffness(fx.preset("machine-hexapod")).stiffness
    >>> print([f"{1e-6 * float(K[i, i]):.1f} N/um" for i in range(3)])
    ['35.6 N/um', '35.6 N/um', '252.7 N/um']
    """
    settings = {"fidelity": fidelity, "modes": modes, "axial_modes": axial_modes, "basis": basis, "friction": friction}
    study, at = _problem(robot, pose, load, settings)
    found = stiffness_at(ElasticRobot(study.robot, study.simulation, study.load).lock(at))
    values = {"stiffness": found.total, "stiffness_share": found.legs, "stiffness_turning": found.load}
    return dataset(values, attrs=_attributes(study, at, found.system, found.equilibrium.state))


def _problem(
    robot: RobotLike, pose: PoseLike, load: LoadLike, settings: dict[str, object]
) -> tuple[model.Study, kinematics.RigidPoses]:
    study = model.override(study_at_pose(robot, load), **settings)  # type: ignore[arg-type]
    return study, RigidPose(study.robot, pose)


def _attributes(
    study: model.Study, at: kinematics.RigidPoses, system: System, state: State, loops: Iterable[str] = ()
) -> dict[str, object]:
    remarks = [
        *loops,
        *pose_remarks(at),
        *rest_warnings(study.robot, system, RestStates.from_state(state)),
    ]
    return _settings(study, remarks)


def _settings(study: model.Study | model.ActuatorStudy, remarks: Iterable[str] = ()) -> dict[str, object]:
    s = study.simulation
    basis = s.lateral_basis if s.lateral_shapes else "none"
    settings = {"fidelity": s.fidelity, "basis": basis, "modes": s.lateral_shapes}
    return attributes(study, [*study.warnings, *remarks]) | settings
