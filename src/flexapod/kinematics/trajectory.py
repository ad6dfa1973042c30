"""Motion of the rigid platform: from laws of surge ... yaw to poses, rates and accelerations, Eqs. (T2.9)-(T2.13).

``R = Rz(yaw) Ry(pitch) Rx(roll)``; translations and turns act on the pivot, a point fixed in the platform.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.kinematics.laws import Law, rest_to_rest, spline, spline_law
from flexapod.kinematics.rotations import cross, time_first, time_last
from flexapod.model import CsvMotion, Motion, WaypointMotion


@dataclass(frozen=True, kw_only=True)
class Poses:
    """Poses of the platform frame at instants, with rates and accelerations (world axes).

    Attributes
    ----------
    position, velocity, acceleration : ndarray, shape (T, 3)
        Of the platform frame's origin [m], [m/s], [m/s^2].
    rotation : ndarray, shape (T, 3, 3)
        Platform to world.
    omega, alpha : ndarray, shape (T, 3)
        Angular velocity [rad/s] and acceleration [rad/s^2].
    """

    position: Array
    rotation: Array
    velocity: Array
    omega: Array
    acceleration: Array
    alpha: Array

    def __post_init__(self) -> None:
        for name in _PARTS:
            view = getattr(self, name).view()  # the caller's array stays writeable
            view.flags.writeable = False
            object.__setattr__(self, name, view)

    def __len__(self) -> int:
        return len(self.position)

    @classmethod
    def at_rest(cls, position: ArrayLike, rotation: ArrayLike) -> Poses:
        """Poses without rates: `position` (T, 3) or (3,), `rotation` (T, 3, 3) or (3, 3)."""
        p = np.array(position, dtype=float, ndmin=2)
        r = np.empty((len(p), 3, 3))
        r[...] = rotation
        still = np.zeros((4, *p.shape))
        return cls(
            position=p, rotation=r, velocity=still[0], omega=still[1], acceleration=still[2], alpha=still[3]
        )  # fmt: skip

    def part(self, where: slice | NDArray[np.intp]) -> Poses:
        """The poses of a range, or those chosen."""
        return Poses(**{name: getattr(self, name)[where] for name in _PARTS})

    def place(self, local: ArrayLike) -> Array:
        """World position of points fixed in the platform: the first result of `point`."""
        local = np.asarray(local, dtype=float)
        if local.ndim == 1:
            return self.position + self.rotation @ local
        return self.position[:, None] + local @ np.swapaxes(self.rotation, -1, -2)

    def point(self, local: ArrayLike) -> tuple[Array, Array, Array]:
        """World position, velocity, acceleration of points fixed in the platform, Eq. (T2.13).

        Parameters
        ----------
        local : array_like, shape (3,) or (n, 3)
            Platform-frame coordinates [m].

        Returns
        -------
        tuple of ndarray, each shape (T, 3) or (T, n, 3)
        """
        local = np.asarray(local, dtype=float)
        arm = np.matmul(np.atleast_2d(local), time_last(self.rotation))  # (3, n, T)
        w, a = time_last(self.omega), time_last(self.alpha)
        spin = cross(w, arm)
        bend = [x + y for x, y in zip(cross(a, arm), cross(w, spin), strict=True)]
        found = []
        for origin, relative in ((self.position, arm), (self.velocity, spin), (self.acceleration, bend)):
            world = time_first([o + r for o, r in zip(origin.T, relative, strict=True)])
            found.append(world if local.ndim == 2 else world[:, 0])
        place, rate, change = found
        return place, rate, change


_PARTS = tuple(field.name for field in fields(Poses))


def rotation_matrix(angles: ArrayLike) -> Array:
    """Platform-to-world rotation of roll, pitch, yaw [rad], Eq. (T2.9).

    Parameters
    ----------
    angles : array_like, shape (..., 3)
        Roll, pitch, yaw about the world's x, y, z.

    Returns
    -------
    ndarray, shape (..., 3, 3)
    """
    angles = np.asarray(angles, dtype=float)
    (cr, cp, cy), (sr, sp, sy) = (f(np.moveaxis(angles, -1, 0)) for f in (np.cos, np.sin))
    r = np.empty((*angles.shape[:-1], 3, 3))
    r[..., 0, 0], r[..., 0, 1], r[..., 0, 2] = cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr
    r[..., 1, 0], r[..., 1, 1], r[..., 1, 2] = sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr
    r[..., 2, 0], r[..., 2, 1], r[..., 2, 2] = -sp, cp * sr, cp * cr
    return r


def turning_axes(angles: Array) -> Array:
    """World axes about which roll, pitch and yaw (T, 3) turn the platform at an instant, in columns, (T, 3, 3)."""
    pitch, yaw = angles[:, 1:].T
    cp, sp, cy, sy = np.cos(pitch), np.sin(pitch), np.cos(yaw), np.sin(yaw)
    zero = np.zeros_like(cp)
    return np.moveaxis(np.array([[cy * cp, -sy, zero], [sy * cp, cy, zero], [-sp, zero, zero + 1]]), -1, 0)


def angular_motion(angles: Law) -> tuple[Array, Array]:
    """World angular velocity and acceleration of roll, pitch, yaw laws, Eqs. (T2.10)-(T2.11).

    Parameters
    ----------
    angles : Law
        Roll, pitch, yaw [rad] with rates and accelerations, each shape (T, 3).

    Returns
    -------
    omega, alpha : ndarray, shape (T, 3)
        [rad/s], [rad/s^2], world axes.
    """
    pitch, yaw = time_last(angles.position)[1:]
    roll_dot, pitch_dot, yaw_dot = time_last(angles.rate)
    roll_ddot, pitch_ddot, yaw_ddot = time_last(angles.acceleration)
    cp, sp, cy, sy = np.cos(pitch), np.sin(pitch), np.cos(yaw), np.sin(yaw)
    roll_axis, pitch_axis = (cy * cp, sy * cp, -sp), (-sy, cy, 0.0)
    roll_axis_dot = (
        -yaw_dot * roll_axis[1] - pitch_dot * cy * sp,
        yaw_dot * roll_axis[0] - pitch_dot * sy * sp,
        -pitch_dot * cp,
    )
    pitch_axis_dot = (-yaw_dot * cy, -yaw_dot * sy, 0.0)
    omega, alpha = np.empty(angles.rate.shape), np.empty(angles.rate.shape)
    for k in range(3):
        omega[:, k] = roll_dot * roll_axis[k] + pitch_dot * pitch_axis[k]
        alpha[:, k] = roll_ddot * roll_axis[k] + pitch_ddot * pitch_axis[k]
        alpha[:, k] += roll_dot * roll_axis_dot[k] + pitch_dot * pitch_axis_dot[k]
    omega[:, 2] += yaw_dot
    alpha[:, 2] += yaw_ddot
    return omega, alpha


def poses_from_coordinates(home: Poses, law: Law, pivot: ArrayLike = (0.0, 0.0, 0.0)) -> Poses:
    """Poses of the platform frame from surge, sway, heave, roll, pitch, yaw, Eq. (T2.12).

    Parameters
    ----------
    home : Poses
        Of the platform frame at home: one sample.
    law : Law
        The six coordinates with rates and accelerations, each shape (T, 6) [m, rad]; zero at home.
    pivot : array_like, shape (3,)
        Platform-frame point that the translations move and the turns leave in place [m].

    Returns
    -------
    Poses
    """
    pivot = np.asarray(pivot, dtype=float)
    position, rotation = places(home, law, pivot)
    omega, alpha = angular_motion(Law(*(part[:, 3:] for part in law)))
    arm = rotation @ pivot
    spin = np.stack(cross(omega.T, arm.T), axis=-1)
    bend = np.stack(cross(alpha.T, arm.T), axis=-1) + np.stack(cross(omega.T, spin.T), axis=-1)
    return Poses(
        position=position,
        rotation=rotation,
        velocity=law.rate[:, :3] - spin,
        omega=omega,
        acceleration=law.acceleration[:, :3] - bend,
        alpha=alpha,
    )


def places(home: Poses, law: Law, pivot: Array) -> tuple[Array, Array]:
    """Position (T, 3) and rotation (T, 3, 3) of `poses_from_coordinates` alone."""
    rotation = rotation_matrix(law.position[:, 3:]) @ home.rotation[0]
    return home.position[0] + home.rotation[0] @ pivot + law.position[:, :3] - rotation @ pivot, rotation


def _waypoints(motion: WaypointMotion, t: Array) -> Law:
    """Profile from each waypoint to the next, at rest in each; from home at t = 0 unless one is given there."""
    times, rows = motion.times, motion.poses
    out = [np.tile(rows[0], (len(t), 1)), np.zeros((len(t), 6)), np.zeros((len(t), 6))]
    for start, end, stroke in zip(times[:-1], times[1:], np.diff(rows, axis=0), strict=True):
        leg = rest_to_rest(t, profile=motion.profile, amplitude=1.0, duration=end - start, start=start)
        for total, part in zip(out, leg, strict=True):
            total += part[:, None] * stroke
    return Law(*out)


def coordinates(motion: Motion, t: ArrayLike) -> Law:
    """Surge, sway, heave [m], roll, pitch, yaw [rad] of a motion with rates and accelerations.

    Parameters
    ----------
    motion : flexapod.model.Motion
        Any motion; a CSV table is interpolated by `laws.spline` (quintic, at rest at both ends).
    t : array_like, shape (T,)
        Instants [s].

    Returns
    -------
    Law
        Each part of shape (T, 6); constant before the start and after the end of the motion.
    """
    t = np.atleast_1d(np.asarray(t, dtype=float))
    if isinstance(motion, WaypointMotion):
        return _waypoints(motion, t)
    if isinstance(motion, CsvMotion):
        curve = spline(motion.time, motion.pose)
        return spline_law(t, curve, first=float(motion.time[0]), last=float(motion.time[-1]))
    unit = rest_to_rest(t, profile=motion.profile, amplitude=1.0, duration=motion.duration)
    target = motion.target
    return Law(*(part[:, None] * target for part in unit))


def sample(home: Poses, motion: Motion, t: ArrayLike) -> Poses:
    """Commanded poses of the rigid platform at instants `t` [s], shape (T,); exact rates and accelerations.

    Raises
    ------
    InputError
        If an instant is not finite.
    """
    return poses_from_coordinates(home, coordinates(motion, check_instants(t)), motion.pivot)


def check_instants(t: ArrayLike) -> Array:
    """Instants (T,) [s], refused where one is not finite."""
    t = np.atleast_1d(np.asarray(t, dtype=float))
    if not np.all(np.isfinite(t)):
        raise InputError("instants must be finite", key="t", allowed="finite seconds")
    return t
