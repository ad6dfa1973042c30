"""Frames that move: how a base is moved over time, and where a plate on a mount stands, Eqs. (T24.1), (T24.8)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flexapod.common.arrays import Array
from flexapod.kinematics.laws import Law, spline, spline_law
from flexapod.kinematics.trajectory import rotation_matrix
from flexapod.model import Robot
from flexapod.model.study.mount import BaseMotion

__all__ = ["Placed", "base_law", "base_placed", "placed"]


class Placed(NamedTuple):
    """A frame that is displaced: a point X of it is at origin + rotation X; shapes (..., 3), (..., 3, 3)."""

    origin: Array
    rotation: Array

    def carried(self, point: Array, rotation: Array) -> tuple[Array, Array]:
        """Where points (..., 3) and attitudes (..., 3, 3) of the frame are in the world."""
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
    """How the base is moved at instants (T,): displacements and angles (T, 6), rates, accelerations; zeros if not."""
    given = robot.base_motion
    if given is None:
        still = np.zeros((len(t), 6))
        return Law(still, still, still)
    if given.of == "displacement":
        curve = spline(given.time, given.values)
        return spline_law(t, curve, first=float(given.time[0]), last=float(given.time[-1]))
    return _integrated(given, t)


def base_placed(robot: Robot, t: Array) -> Placed | None:
    """Where the base is at instants (T,); None where it is not moved."""
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
