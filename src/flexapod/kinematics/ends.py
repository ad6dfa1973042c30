"""Axes of the joints at the two ends of a leg, at home, Eqs. (T2.14), (T14.1)-(T14.2)."""

from __future__ import annotations

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.kinematics.inverse import leg_frame

_ALONG = 1e-9  # sine of the angle below which an axis counts as parallel to the leg


def base_frame(number: int, axis: Array | None, foot: Array, tip: Array, *, exact: bool) -> tuple[Array, float]:
    """Frame R0 of leg `number`, leg to world, and beta at home [rad].

    An `exact` axis is as given and beta what it then is: that of a hinge, and that of a universal joint whose axis
    guides the platform, which no ball joint releases. Else the part normal to the leg counts, and beta is zero.
    """
    if not exact or axis is None:
        return leg_frame(number, tip - foot, axis), 0.0
    way = tip - foot
    return _hinge(number, axis, way, "base_joint.axis"), float(
        np.arcsin(axis @ way / np.linalg.norm(axis) / np.linalg.norm(way))
    )


def platform_frame(number: int, letter: str, axis: Array | None, axes: Array) -> Array:
    """Axes of the platform joint at home in the world, `axes` being those of the leg.

    Universal joint: y is the axis as given, fixed to the platform, by default along the leg's x. Hinge: x is the axis
    as given. Every other joint has the axes of the leg.
    """
    x, z = axes[:, 0], axes[:, 2]
    if letter == "U":
        y = x if axis is None else axis / np.linalg.norm(axis)
        across = np.asarray(np.cross(y, z), dtype=float)
        size = np.linalg.norm(across)
        if size <= _ALONG:
            raise _parallel(number, y if axis is None else axis, "platform_joint.axis")
        across = across / size
        return np.stack([across, y, np.cross(across, y)], axis=-1)
    if letter == "R":
        return _hinge(number, x if axis is None else axis, z, "platform_joint.axis")
    if axis is not None:
        return _hinge(number, axis, z, "platform_joint.axis")
    return axes


def _hinge(number: int, axis: Array, way: Array, key: str) -> Array:
    """Frame with x along an axis and z as near to a direction as it can be."""
    x = axis / np.linalg.norm(axis)
    z = way - (way @ x) * x
    if np.linalg.norm(z) <= _ALONG * np.linalg.norm(way):
        raise _parallel(number, axis, key)
    z = z / np.linalg.norm(z)
    return np.stack([x, np.cross(z, x), z], axis=-1)


def _parallel(number: int, axis: Array, key: str) -> InputError:
    return InputError(
        "is parallel to the leg at home",
        key=f"leg {number}: {key}",
        value=axis.tolist(),
        allowed="a direction across the leg",
    )
