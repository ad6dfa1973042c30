"""The robot at one pose with its drives locked: modes and stiffness, a pose in, a Dataset out."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.transform import Rotation

from flexapod import model, rigid
from flexapod.solve.modes import RobotModes, robot_modes
from flexapod.solve.rotation import matrix
from flexapod.solve.stiffness import robot_stiffness
from flexapod.study.arguments import LoadLike, PoseLike, as_pose, at_pose
from flexapod.study.attributes import attributes
from flexapod.study.checks import path_remarks
from flexapod.study.kinds import mode_kinds
from flexapod.study.names import ONE_POSE_FORMS, dataset
from flexapod.typing import Array

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["modes", "stiffness"]

STATIONS = np.linspace(0.0, 1.0, 41)


def modes(
    robot: model.Robot | model.Study,
    pose: PoseLike = None,
    *,
    load: LoadLike = None,
    fidelity: str | None = None,
    modes: int | None = None,
    axial_modes: int | None = None,
    basis: str | None = None,
) -> Dataset:
    """Undamped and damped modes about the static equilibrium, drives locked, Eqs. (T7.2)-(T7.5).

    Parameters
    ----------
    robot : Robot or Study
    pose : pose, optional
        Surge, sway, heave [m], roll, pitch, yaw [rad] from home, by name or as (6,); default home.
    load : Load, wrench or array_like (6,), optional
        Fx Fy Fz [N], Mx My Mz [N m] at the tool, world axes; in place of the study's; a law is taken at t = 0.
    fidelity, modes, axial_modes, basis : optional
        In place of those of the study; a bare robot has assumed-modes, 3 per plane, tip-load.

    Returns
    -------
    xarray.Dataset
        `frequency` [Hz] ascending, `damping_ratio`, `kind`, `platform_shape`, `leg_shape`, `leg_stretch`;
        `platform_position`, `platform_quaternion`, `com_sag` of the equilibrium. Shapes are mass-normalised.

    Raises
    ------
    InputError
        A pose out of reach, rigid legs on prescribed strokes (nothing can move), or a pure force drive.
    ComputationError
        No equilibrium at this pose.
    """
    settings = {"fidelity": fidelity, "modes": modes, "axial_modes": axial_modes, "basis": basis}
    study, path, wrench = _problem(robot, pose, load, settings)
    found = robot_modes(study.robot, study.simulation, path, wrench)
    at, R = found.equilibrium.state.pose, matrix(found.equilibrium.state.pose[3:])
    com = study.robot.payload.com
    platform = np.concatenate([found.shapes[:, -6:-3], found.shapes[:, -3:] @ R.T], axis=1)
    values = {
        "frequency": found.frequency,
        "damping_ratio": found.damping_ratio,
        "kind": np.array(mode_kinds(found, wrench)),
        "platform_shape": platform,
        "leg_shape": _leg_shapes(study.robot, found),
        "leg_stretch": _stretch(study.robot, at, platform),
        "platform_position": at[:3] - R @ com,
        "platform_quaternion": Rotation.from_matrix(R).as_quat(canonical=True, scalar_first=True),
        "com_sag": at[:3] - path.point(com)[0][0],
    }
    coords = {"mode": np.arange(1, len(found.frequency) + 1), "station": STATIONS}
    return dataset(values, coords, _attributes(study, path), ONE_POSE_FORMS)


def stiffness(
    robot: model.Robot | model.Study,
    pose: PoseLike = None,
    *,
    load: LoadLike = None,
    fidelity: str | None = None,
    modes: int | None = None,
    axial_modes: int | None = None,
    basis: str | None = None,
) -> Dataset:
    """Stiffness at the tool about the static equilibrium, drives locked, Eqs. (T7.6)-(T7.8).

    Parameters
    ----------
    robot, pose, load, fidelity, modes, axial_modes, basis
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
    """
    settings = {"fidelity": fidelity, "modes": modes, "axial_modes": axial_modes, "basis": basis}
    study, path, wrench = _problem(robot, pose, load, settings)
    found = robot_stiffness(study.robot, study.simulation, path, wrench)
    values = {"stiffness": found.total, "stiffness_share": found.legs, "stiffness_turning": found.load}
    return dataset(values, attrs=_attributes(study, path))


def _problem(
    robot: model.Robot | model.Study, pose: PoseLike, load: LoadLike, settings: dict[str, object]
) -> tuple[model.Study, rigid.Poses, Array]:
    study = model.override(at_pose(robot, load), **settings)  # type: ignore[arg-type]
    return study, as_pose(study.robot, pose), rigid.wrench(study.load, np.zeros(1))[0]


def _attributes(study: model.Study, path: rigid.Poses) -> dict[str, object]:
    s = study.simulation
    basis = s.lateral_basis if s.lateral_shapes else "none"
    settings = {"fidelity": s.fidelity, "basis": basis, "modes": s.lateral_shapes}
    return attributes(study, [*study.warnings, *path_remarks(study.robot, np.zeros(1), path)]) | settings


def _leg_shapes(robot: model.Robot, found: RobotModes) -> Array:
    """Lateral displacement of every leg off the line of its joints, (m, 6, 2, stations) [m]."""
    shapes, n = found.system.kernel.shapes, found.system.n
    first, k = 3 + shapes.axial.count, shapes.a.count
    legs = found.shapes[:, : 6 * n].reshape(-1, 6, n)[:, :, first:].reshape(len(found.shapes), 6, 2, k)
    result = np.zeros((*legs.shape[:3], len(STATIONS)))
    for i, leg in enumerate(robot.legs):
        length = found.equilibrium.state.q[i, shapes.l_index]
        zeta = np.clip((STATIONS * length - leg.cylinder.mouth) / (length - leg.cylinder.mouth), 0.0, 1.0)
        values = shapes.a.values(zeta) if k else np.zeros((0, len(STATIONS)))
        off_chord = values - np.outer(shapes.a.tip, STATIONS)
        result[:, i] = legs[:, i] @ off_chord
    return result


def _stretch(robot: model.Robot, pose: Array, platform: Array) -> Array:
    """Change of the joint-to-joint lengths in each mode, (m, 6) [m]: rows of the Jacobian at the CoM, Eq. (T2.21)."""
    jacobian = rigid.length_jacobian(
        robot.base_joints, robot.platform_joints - robot.payload.com, pose[:3], matrix(pose[3:]), np.zeros(3)
    )
    return platform @ jacobian.T
