"""Where things are in space: the robot of a result at an instant, its modes, its motion. For pictures and reports."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from flexapod import model, rigid
from flexapod.rigid.trajectory import coordinates
from flexapod.typing import Array

__all__ = ["Scene", "bent", "motion_coordinates", "motion_end", "scene", "study_of"]

STATIONS = 25  # points of a drawn piston


@dataclass(frozen=True, kw_only=True)
class Scene:
    """Points of a robot in the world [m]: joints (6, 3), cylinder mouths (6, 3), piston lines (6, n, 3), CoM, centre.

    `magnified` says by which factor lateral deflections are drawn larger than they are.
    """

    base: Array
    platform: Array
    mouth: Array
    piston: Array
    com: Array
    centre: Array
    magnified: float = 1.0


def study_of(data: xr.Dataset) -> model.Study | model.ActuatorStudy:
    """The study that a result carries as text in its attributes."""
    return model.loads(data.attrs["study"], path=data.attrs.get("study_path") or None)


def motion_end(data: xr.Dataset) -> float | None:
    """Instant from which the rigid payload rests [s]; None where it moves until the end or never."""
    if "com_position_rigid" not in data:
        return None
    path = data.com_position_rigid.values
    away = np.abs(path - path[-1]).max(axis=1)
    moving = np.flatnonzero(away > 1e-9 * max(float(away.max()), 1e-12))
    if not moving.size or moving[-1] >= len(path) - 2:
        return None
    return float(data.time[moving[-1] + 1])


def motion_coordinates(data: xr.Dataset) -> xr.Dataset:
    """Commanded surge, sway, heave [m], roll, pitch, yaw [rad] with rates and accelerations, dims (time, coordinate)."""
    study = study_of(data)
    law = coordinates(study.motion, data.time.values)
    dims = ("time", "coordinate")
    parts = {name: (dims, getattr(law, name)) for name in ("position", "rate", "acceleration")}
    return xr.Dataset(parts, coords={"time": data.time, "coordinate": list(model.AXES)})


def scene(data: xr.Dataset, time: float = 0.0, magnify: float | None = None) -> Scene:
    """The robot of a result at an instant [s].

    Parameters
    ----------
    data : xarray.Dataset
        Result of a simulation, with its study in the attributes.
    time : float
        Instant [s]; the nearest output is taken.
    magnify : float, optional
        Factor on lateral deflections; None draws them as they are.
    """
    robot, at = study_of(data).robot, data.sel(time=time, method="nearest")
    R = _matrix(at.platform_quaternion.values)
    com = at.com_position.values
    centre = com - R @ robot.payload.com
    tip = at.tip_deflection.values if "tip_deflection" in at else np.zeros((6, 2))
    zeta = np.linspace(0.0, 1.0, STATIONS)
    shape = 0.5 * (3 * zeta**2 - zeta**3)  # of a cantilever under a force at its tip
    factor = 1.0 if magnify is None else magnify
    return bent(robot, centre, R, com, factor * tip[:, :, None] * shape, factor)


def bent(robot: model.Robot, centre: Array, R: Array, com: Array, lateral: Array, magnified: float = 1.0) -> Scene:
    """Scene of a pose with lateral deflections (6, 2, n) of the pistons from their cylinders' axes, mouth to tip.

    The joints stay where the pose puts them: a cylinder turns as far as its piston's tip is off its axis.
    """
    base, platform = robot.base_joints, centre + robot.platform_joints @ R.T
    chord = platform - base
    length = np.linalg.norm(chord, axis=1)
    axis = chord / length[:, None]
    frames = rigid.home_frames(robot)
    alpha, beta = rigid.joint_angles(frames, axis[None])
    turned = rigid.leg_rotations(frames, alpha, beta)[0]
    mouth = np.array([leg.cylinder.mouth for leg in robot.legs])
    place = mouth[:, None] + (length - mouth)[:, None] * np.linspace(0.0, 1.0, lateral.shape[2])
    offset = lateral - (place / length[:, None])[:, None] * lateral[:, :, -1:]
    across = np.einsum("ixd,idn->inx", turned[:, :, :2], offset)
    lines = base[:, None] + place[:, :, None] * axis[:, None] + across
    return Scene(
        base=base, platform=platform, mouth=lines[:, 0], piston=lines, com=com, centre=centre, magnified=magnified
    )


def _matrix(quaternion: Array) -> Array:
    """Rotation matrix (3, 3) of a unit quaternion w x y z."""
    w, v = quaternion[0], quaternion[1:]
    cross = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return np.eye(3) + 2 * w * cross + 2 * cross @ cross
