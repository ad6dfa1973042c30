"""Many poses at once: `kinematics.Poses` from the forms that users give, and coordinates of them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.results.arguments import POSE_KEYS, PoseLike, pose_numbers
from flexapod.common.arrays import Array, floats
from flexapod.common.errors import InputError
from flexapod.common.quantities import number

ORIGIN = np.zeros(3)  # of the platform frame
BATCH = 200  # poses computed together: their matrices stay in the processor's cache


def has_many_poses(pose: PoseLike) -> bool:
    """Test whether poses are given as several: (P, 6), `Poses` of several samples, or names with arrays."""
    if pose is None or isinstance(pose, str):
        return False
    if isinstance(pose, kinematics.Poses):
        return len(pose) != 1
    if isinstance(pose, Mapping):
        return any(np.ndim(value) > 0 for value in pose.values())
    try:
        return np.ndim(pose) > 1
    except ValueError:  # rows of different lengths: `as_poses` refuses them
        return True


def as_poses(robot: model.Robot, pose: PoseLike) -> kinematics.Poses:
    """P poses at rest; they need not be in reach.

    Raises
    ------
    InputError
        Unknown names, arrays that do not fit each other, or another shape than (P, 6).
    """
    if isinstance(pose, kinematics.Poses):
        return kinematics.Poses.at_rest(pose.position, pose.rotation)
    if isinstance(pose, Mapping):
        unknown = [name for name in pose if name not in POSE_KEYS]
        if unknown:
            raise InputError("is not an axis", key=f"pose.{unknown[0]}", allowed=", ".join(POSE_KEYS))
        named = pose_numbers(pose)
        try:
            columns = np.broadcast_arrays(*[floats(named.get(name, 0.0)) for name in POSE_KEYS])
        except ValueError:
            raise InputError("has arrays that do not fit each other", key="pose", allowed="lengths alike") from None
        values = np.stack(columns, axis=-1)
    else:
        values = _numbers([pose_numbers(row) for row in pose] if isinstance(pose, list | tuple) else pose)
    if values.ndim != 2 or values.shape[1] != 6 or not np.isfinite(values).all():
        raise InputError(
            "are not poses",
            key="pose",
            value=values.shape,
            allowed="finite numbers of shape (P, 6): surge, sway, heave [m], roll, pitch, yaw [rad] from home",
        )
    return poses_about_home(robot, values)


def poses_about_home(robot: model.Robot, values: Array) -> kinematics.Poses:
    """Poses at rest from surge, sway, heave [m], roll, pitch, yaw [rad], (P, 6); see `kinematics.poses_from_home`."""
    return kinematics.poses_from_home(robot, values)


def pose_coordinates(robot: model.Robot, path: kinematics.Poses, pivot: Array = ORIGIN) -> Array:
    """Surge to heave [m] of a pivot, roll, pitch, yaw [rad] of the platform from home, (P, 6); inverse of (T2.9)."""
    home = kinematics.home_pose(robot)
    R = path.rotation @ home.rotation[0].T
    angles = [
        np.arctan2(R[:, 2, 1], R[:, 2, 2]),
        -np.arcsin(np.clip(R[:, 2, 0], -1.0, 1.0)),
        np.arctan2(R[:, 1, 0], R[:, 0, 0]),
    ]
    return np.concatenate([path.place(pivot) - home.place(pivot), np.stack(angles, axis=1)], axis=1)


def coordinate_words(at: Mapping[str, float]) -> str:
    """A pose from home: "surge 12 mm, roll 5 deg"."""
    return ", ".join(f"{name} {coordinate_text(name, value)}" for name, value in at.items())


def coordinate_text(name: str, value: float) -> str:
    """A coordinate of a pose, in mm or deg."""
    shown, unit = (1e3 * value, "mm") if name in model.AXES[:3] else (np.rad2deg(value), "deg")
    return f"{number(round(shown, 9), 4)} {unit}"


def _numbers(pose: object) -> Array:
    try:
        return floats(pose)
    except ValueError:
        return np.full(0, np.nan)
