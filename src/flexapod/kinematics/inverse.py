"""Inverse kinematics: leg lengths and universal-joint angles with rates and accelerations, Eqs. (T2.14)-(T2.20)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.kinematics.rotations import Vector, blocks, cross, time_last
from flexapod.kinematics.trajectory import Poses

BETA_LIMIT = np.deg2rad(85.0)  # 5 deg from the universal joint's own singularity

NO_LENGTH = 1e-9  # m; below this a leg has no direction
_PLAIN = "length rate accel alpha beta alpha_dot beta_dot alpha_ddot beta_ddot".split()  # of legs UPS and SPS
_PARALLEL = 1e-9  # sine of the angle below which a leg counts as parallel to the reference axis


@dataclass(frozen=True, kw_only=True)
class LegState:
    """Legs of the rigid robot at T instants; each array has shape (T, n), of gamma (T, n, 3).

    Attributes
    ----------
    length, rate, accel
        Joint-to-joint length [m] and its time derivatives.
    alpha, beta, alpha_dot, beta_dot, alpha_ddot, beta_ddot
        Angles of the base joint [rad] and their time derivatives; alpha is zero at home, and so is beta but for hinges.
    chi, spin, gamma, chi_dot, spin_dot, gamma_dot, chi_ddot, spin_ddot, gamma_ddot
        Way of the carriage [m or rad] from home, turn about the leg's axis and angles of the platform joint [rad], and
        their time derivatives; None where no leg has one.
    """

    length: Array
    rate: Array
    accel: Array
    alpha: Array
    beta: Array
    alpha_dot: Array
    beta_dot: Array
    alpha_ddot: Array
    beta_ddot: Array
    chi: Array | None = None
    spin: Array | None = None
    gamma: Array | None = None
    chi_dot: Array | None = None
    spin_dot: Array | None = None
    gamma_dot: Array | None = None
    chi_ddot: Array | None = None
    spin_ddot: Array | None = None
    gamma_ddot: Array | None = None

    def coordinate(self, name: str) -> tuple[Array, Array, Array]:
        """Coordinate of `leg_geometry.COORDINATES` with rate and acceleration, (T, n) each; zero without one."""
        if name == "l":
            return self.length, self.rate, self.accel
        key, place = (name[:-1], int(name[-1]) - 1) if name.startswith("gamma") else (name, None)
        parts = (getattr(self, key + end) for end in ("", "_dot", "_ddot"))
        parts = [np.zeros(self.length.shape) if part is None else part for part in parts]
        if place is None or self.gamma is None:
            return parts[0], parts[1], parts[2]
        return parts[0][..., place], parts[1][..., place], parts[2][..., place]


class LegMap(NamedTuple):
    """Legs in their home frames as a linear map of the pose, ``F_i^T (p + R a_i - b_i)``.

    ``reach`` (3 n, 12) takes the nine entries of R, row by row, and p; ``offset`` (3, n, 1) is ``- F_i^T b_i``.
    """

    reach: Array
    offset: Array

    @property
    def number(self) -> int:
        """Number of legs."""
        return self.offset.shape[1]

    @classmethod
    def from_joints(cls, base_joints: Array, platform_joints: Array, frames: Array) -> LegMap:
        """Build the map from joints (n, 3) and home frames (n, 3, 3)."""
        turned = np.einsum("ikc,ij->cikj", frames, platform_joints).reshape(-1, 9)
        moved = np.moveaxis(frames, -1, 0).reshape(-1, 3)
        offset = -np.einsum("ikc,ik->ci", frames, base_joints)[..., None]
        return cls(np.concatenate([turned, moved], axis=1), offset)


class JointTurn(NamedTuple):
    """Cosines and sines of the universal joints' angles, each (n, T): ``Rx(alpha) Ry(beta)`` of Eq. (T2.15)."""

    ca: Array
    sa: Array
    cb: Array
    sb: Array

    @classmethod
    def from_angles(cls, alpha: Array, beta: Array) -> JointTurn:
        """Build the cosines and sines from the angles [rad]."""
        return cls(np.cos(alpha), np.sin(alpha), np.cos(beta), np.sin(beta))

    def into_leg(self, vector: Vector) -> tuple[Array, Array, Array]:
        """Vector of home axes in leg axes."""
        x, y, z = vector
        level = self.ca * z - self.sa * y
        return self.cb * x - self.sb * level, self.ca * y + self.sa * z, self.sb * x + self.cb * level

    def out_of_leg(self, vector: Vector) -> tuple[Array, Array, Array]:
        """Vector of leg axes in home axes."""
        x, y, z = vector
        level = self.cb * z - self.sb * x
        return self.cb * x + self.sb * z, self.ca * y - self.sa * level, self.sa * y + self.ca * level


def leg_frames(
    base_joints: ArrayLike, platform_joints_home: ArrayLike, u_axes: Sequence[ArrayLike | None] | None = None
) -> Array:
    """Home frames [x y z]_i of the legs as columns, leg to world, Eq. (T2.14).

    Parameters
    ----------
    base_joints, platform_joints_home : array_like, shape (n, 3)
        Joint centres at home, world axes [m].
    u_axes : sequence of (3,) or None, optional
        First axis of each leg's universal joint, world axes; made normal to the leg. None: ``Z x z_i``.

    Returns
    -------
    ndarray, shape (n, 3, 3)

    Raises
    ------
    InputError
        If a leg has no length, or its `u_axis` is parallel to it.
    """
    vectors = np.asarray(platform_joints_home, dtype=float) - np.asarray(base_joints, dtype=float)
    axes = [None] * len(vectors) if u_axes is None else list(u_axes)
    return np.stack([leg_frame(i, s, u) for i, (s, u) in enumerate(zip(vectors, axes, strict=True), start=1)])


def leg_frame(number: int, vector: Array, u_axis: ArrayLike | None) -> Array:
    """Home frame (3, 3) of leg `number` along `vector`, Eq. (T2.14); parameters as for `leg_frames`."""
    length = np.linalg.norm(vector)
    if length < NO_LENGTH:
        raise InputError("its joints coincide at home", key=f"leg {number}", next_step="Move one of the two joints")
    z = vector / length
    if u_axis is None:
        x = np.array(cross(np.array([0.0, 0.0, 1.0]), z))
        x = np.array([1.0, 0.0, 0.0]) if np.linalg.norm(x) < _PARALLEL else x
    else:
        u = np.asarray(u_axis, dtype=float)
        x = u - (u @ z) * z
        if np.linalg.norm(x) <= _PARALLEL * np.linalg.norm(u):
            raise InputError(
                "is parallel to the leg at home",
                key=f"leg {number}: u_axis",
                value=u.tolist(),
                allowed="a direction across the leg",
            )
    x = x - (x @ z) * z
    x = x / np.linalg.norm(x)
    return np.stack([x, cross(z, x), z], axis=-1)


def leg_rotations(frames: Array, alpha: Array, beta: Array) -> Array:
    """Leg to world, ``R_i = [x y z]_i Rx(alpha) Ry(beta)``, Eq. (T2.15).

    Parameters
    ----------
    frames : ndarray, shape (n, 3, 3)
        From `leg_frames`.
    alpha, beta : ndarray, shape (T, n)
        [rad].

    Returns
    -------
    ndarray, shape (T, n, 3, 3)
    """
    ca, sa, cb, sb = np.cos(alpha), np.sin(alpha), np.cos(beta), np.sin(beta)
    r = np.zeros((*alpha.shape, 3, 3))
    r[..., 0, 0], r[..., 0, 2] = cb, sb
    r[..., 1, 0], r[..., 1, 1], r[..., 1, 2] = sa * sb, ca, -sa * cb
    r[..., 2, 0], r[..., 2, 1], r[..., 2, 2] = -ca * sb, sa, ca * cb
    return frames @ r


def joint_angles(frames: Array, directions: Array) -> tuple[Array, Array]:
    """Universal-joint angles that point the legs along unit `directions` (T, n, 3), world axes, Eq. (T2.16).

    Returns
    -------
    alpha, beta : ndarray, shape (T, n)
        [rad]; alpha in (-pi, pi], beta in [-pi/2, pi/2].
    """
    d = np.einsum("nij,tni->tnj", frames, directions)
    return np.arctan2(-d[..., 1], d[..., 2]), np.arctan2(d[..., 0], np.hypot(d[..., 1], d[..., 2]))


def leg_lengths(base_joints: ArrayLike, platform_joints: ArrayLike, position: ArrayLike, rotation: ArrayLike) -> Array:
    """Joint-to-joint lengths |p + R a_i - b_i| [m], Eq. (T2.17).

    Parameters
    ----------
    base_joints, platform_joints : array_like, shape (n, 3)
        World axes; platform axes [m].
    position : array_like, shape (..., 3)
    rotation : array_like, shape (..., 3, 3)

    Returns
    -------
    ndarray, shape (..., n)
    """
    r = np.asarray(platform_joints, dtype=float) @ np.swapaxes(np.asarray(rotation, dtype=float), -1, -2)
    return np.linalg.norm(np.asarray(position, dtype=float)[..., None, :] + r - np.asarray(base_joints), axis=-1)


def leg_state(base_joints: Array, platform_joints: Array, frames: Array, poses: Poses) -> LegState:
    """Lengths and universal-joint angles with two time derivatives, Eqs. (T2.16)-(T2.20).

    Parameters
    ----------
    base_joints, platform_joints : ndarray, shape (n, 3)
        World axes; platform axes [m].
    frames : ndarray, shape (n, 3, 3)
        From `leg_frames`.
    poses : Poses
        T poses.

    Returns
    -------
    LegState
        Arrays of shape (T, n).

    Raises
    ------
    InputError
        If a leg has no length, or a universal joint comes within 5 deg of |beta| = 90 deg.
    """
    return state_of(LegMap.from_joints(base_joints, platform_joints, frames), poses)


def state_of(legs: LegMap, poses: Poses) -> LegState:
    """`leg_state` of a robot whose `LegMap` is known."""
    state = LegState(**{name: np.empty((len(poses), legs.number)) for name in _PLAIN})
    for where in blocks(len(poses)):
        s, s_dot, s_ddot = _in_home_frames(legs, poses.part(where))
        length, alpha, beta, turn = _directions(s)
        _refuse_no_length(length)
        _refuse_folded_joint(beta.T, where.start, len(poses))
        rates = _rates(length, turn, turn.into_leg(s_dot), turn.into_leg(s_ddot))
        for name, values in ({"length": length, "alpha": alpha, "beta": beta} | rates).items():
            getattr(state, name)[where] = values.T
    return state


def lengths_of(legs: LegMap, poses: Poses) -> Array:
    """Lengths of the legs at T poses, (T, n) [m]: those of `state_of`, to the bit."""
    found = np.empty((len(poses), legs.number))
    for where in blocks(len(poses)):
        x = np.concatenate([time_last(poses.rotation[where]).reshape(9, -1), poses.position[where].T])
        s = (legs.reach @ x).reshape(3, legs.number, -1) + legs.offset
        across = np.sqrt(s[1] ** 2 + s[2] ** 2)
        found[where] = np.sqrt(s[0] ** 2 + across**2).T
    _refuse_no_length(found)
    return found


def directions_of(legs: LegMap, poses: Poses) -> tuple[Array, Array, Array]:
    """Length [m], alpha and beta [rad] of the legs at T poses, (T, n) each, however far their joints fold."""
    x = np.concatenate([time_last(poses.rotation).reshape(9, -1), poses.position.T])
    length, alpha, beta, _ = _directions((legs.reach @ x).reshape(3, legs.number, -1) + legs.offset)
    return length.T, alpha.T, beta.T


def _in_home_frames(legs: LegMap, poses: Poses) -> Array:
    """Vectors from base to platform joint with two derivatives in the legs' home frames, (3, 3, n, T)."""
    x = np.empty((3, 12, len(poses)))
    w, turn = time_last(poses.omega)[:, None], x[:, :9].reshape(3, 3, 3, -1)
    turn[0] = time_last(poses.rotation)
    turn[1] = cross(w, turn[0])  # R' = w x R
    turn[2] = np.add(cross(time_last(poses.alpha)[:, None], turn[0]), cross(w, turn[1]))
    x[:, :9] = turn.reshape(3, 9, -1)
    x[0, 9:], x[1, 9:], x[2, 9:] = poses.position.T, poses.velocity.T, poses.acceleration.T
    found = (legs.reach @ x).reshape(3, 3, legs.number, -1)
    found[0] += legs.offset
    return found


def _directions(s: Array) -> tuple[Array, Array, Array, JointTurn]:
    """Length, alpha, beta and their turn of legs along `s` (3, n, T) in their home frames, Eqs. (T2.16)-(T2.17)."""
    across = np.sqrt(s[1] ** 2 + s[2] ** 2)
    length = np.sqrt(s[0] ** 2 + across**2)
    with np.errstate(divide="ignore", invalid="ignore"):  # a joint folded to 90 deg is refused by its angle
        turn = JointTurn(ca=s[2] / across, sa=-s[1] / across, cb=across / length, sb=s[0] / length)
    return length, np.arctan2(-s[1], s[2]), np.arctan2(s[0], across), turn


def _rates(length: Array, turn: JointTurn, v: Vector, a: Vector) -> dict[str, Array]:
    """Rates of length and angles from velocity and acceleration of the tip in leg axes, Eqs. (T2.17)-(T2.20)."""
    l_dot = v[2]  # (T2.17)
    wx, wy = -v[1] / length, v[0] / length  # (T2.18)
    alpha_dot, beta_dot = wx / turn.cb, wy
    wz = alpha_dot * turn.sb
    wx_dot = (-a[1] - 2 * l_dot * wx) / length + wy * wz  # (T2.19)
    wy_dot = (a[0] - 2 * l_dot * wy) / length - wx * wz
    return {
        "rate": l_dot,
        "accel": a[2] + length * (wx**2 + wy**2),  # (T2.20)
        "alpha_dot": alpha_dot,
        "beta_dot": beta_dot,
        "alpha_ddot": (wx_dot + alpha_dot * beta_dot * turn.sb) / turn.cb,
        "beta_ddot": wy_dot,
    }


def _refuse_no_length(length: Array) -> None:
    if np.any(length < NO_LENGTH):
        raise InputError("a leg has no length at this pose", key=f"leg {np.argwhere(length < NO_LENGTH)[0][0] + 1}")


def _refuse_folded_joint(beta: Array, first: int, count: int) -> None:
    if np.abs(beta).max(initial=0.0) > BETA_LIMIT:
        instant, leg = np.argwhere(np.abs(beta) > BETA_LIMIT)[0]
        raise InputError(
            f"the universal joint of leg {leg + 1} folds to beta = {np.rad2deg(beta[instant, leg]):.1f} deg "
            f"(sample {first + instant + 1} of {count})",
            key=f"leg {leg + 1}: u_axis",
            allowed="|beta| at most 85 deg",
            next_step="Turn the universal joint's first axis (u_axis), or reduce the motion",
        )
