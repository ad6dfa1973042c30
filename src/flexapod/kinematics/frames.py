"""Frames of a moved base, of a plate on a mount, and of the joints at the two ends of a leg.

Displaced frames: Eqs. (T24.1), (T24.8). Axes of the joints at home: Eqs. (T2.14), (T14.1)-(T14.2).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.kinematics.inverse import leg_frame
from flexapod.kinematics.laws import Law, spline, spline_law
from flexapod.kinematics.trajectory import rotation_matrix
from flexapod.model import Robot
from flexapod.model.study.mount import BaseMotion


class Placed(NamedTuple):
    """A frame that is displaced: a point X of it is at origin + rotation X; shapes (..., 3), (..., 3, 3)."""

    origin: Array
    rotation: Array

    def carried(self, point: Array, rotation: Array) -> tuple[Array, Array]:
        """Transform points (..., 3) and attitudes (..., 3, 3) of the frame into the world."""
        return self.origin + (self.rotation @ point[..., None])[..., 0], self.rotation @ rotation

    def seen(self, point: Array, rotation: Array) -> tuple[Array, Array]:
        """Points (..., 3) and attitudes (..., 3, 3) of the world as the displaced frame sees them."""
        back = self.rotation.swapaxes(-1, -2)
        return (back @ (point - self.origin)[..., None])[..., 0], back @ rotation


def placed(moved: Array, at: Array) -> Placed:
    """Frame displaced by moved (..., 6) [m, rad] at a point (3,): along the axes, and roll, pitch, yaw, Eq. (T24.1)."""
    R = rotation_matrix(moved[..., 3:])
    return Placed(at + moved[..., :3] - R @ at, R)


def base_law(robot: Robot, t: Array) -> Law:
    """Motion of the base at instants (T,): displacements and angles (T, 6), rates, accelerations; zeros if none."""
    given = robot.base_motion
    if given is None:
        still = np.zeros((len(t), 6))
        return Law(still, still, still)
    if given.of == "displacement":
        curve = spline(given.time, given.values)
        return spline_law(t, curve, first=float(given.time[0]), last=float(given.time[-1]))
    return _integrated(given, t)


def base_placed(robot: Robot, t: Array) -> Placed | None:
    """Frame of the base at instants (T,); None where the base is not moved."""
    given = robot.base_motion
    return None if given is None else placed(base_law(robot, t).position, given.at)


def _integrated(given: BaseMotion, t: Array) -> Law:
    """Accelerations straight between rows, none after the last one, integrated from rest, Eq. (T24.8)."""
    time, a = given.time, given.values
    h = np.diff(time)[:, None]
    slope = np.divide(np.diff(a, axis=0), h, out=np.zeros_like(a[1:]), where=h > 0)
    v = np.concatenate([np.zeros((1, 6)), np.cumsum(h * (a[:-1] + a[1:]) / 2, axis=0)])
    x = np.concatenate([np.zeros((1, 6)), np.cumsum(h * v[:-1] + h**2 * (2 * a[:-1] + a[1:]) / 6, axis=0)])
    k = np.clip(np.searchsorted(time, t, side="right") - 1, 0, len(time) - 1)
    ended = k == len(time) - 1
    rise = np.where(ended[:, None], 0.0, slope[np.minimum(k, len(slope) - 1)])
    a = np.where(ended[:, None], 0.0, a[k])
    s = (t - time[k])[:, None]
    return Law(x[k] + s * (v[k] + s * (a / 2 + s * rise / 6)), v[k] + s * (a + s * rise / 2), a + s * rise)


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
