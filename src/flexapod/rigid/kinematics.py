"""Inverse kinematics: leg lengths and universal-joint angles with rates and accelerations, Eqs. (T2.14)-(T2.20)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from flexapod.errors import InputError
from flexapod.rigid.trajectory import Poses
from flexapod.typing import Array

__all__ = ["BETA_LIMIT", "LegState", "joint_angles", "leg_frames", "leg_lengths", "leg_rotations", "leg_state"]

BETA_LIMIT = np.deg2rad(85.0)  # 5 deg from the universal joint's own singularity

_NO_LENGTH = 1e-9  # m; below this a leg has no direction
_PARALLEL = 1e-9  # sine of the angle below which a leg counts as parallel to the reference axis


@dataclass(frozen=True, kw_only=True)
class LegState:
    """Legs of the rigid robot at T instants; each array has shape (T, 6).

    Attributes
    ----------
    length, rate, accel
        Joint-to-joint length [m] and its time derivatives.
    alpha, beta, alpha_dot, beta_dot, alpha_ddot, beta_ddot
        Angles of the universal joint [rad] and their time derivatives; zero at home.
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
    return np.stack([_leg_frame(i, s, u) for i, (s, u) in enumerate(zip(vectors, axes, strict=True), start=1)])


def _leg_frame(number: int, vector: Array, u_axis: ArrayLike | None) -> Array:
    length = np.linalg.norm(vector)
    if length < _NO_LENGTH:
        raise InputError("its joints coincide at home", key=f"leg {number}", next_step="Move one of the two joints")
    z = vector / length
    if u_axis is None:
        x = np.cross([0.0, 0.0, 1.0], z)
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
    return np.stack([x, np.cross(z, x), z], axis=-1)


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
    ca, sa, cb, sb, zero = np.cos(alpha), np.sin(alpha), np.cos(beta), np.sin(beta), np.zeros_like(alpha)
    rows = [[cb, zero, sb], [sa * sb, ca, -sa * cb], [-ca * sb, sa, ca * cb]]
    return frames @ np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


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
    tip, tip_dot, tip_ddot = poses.point(platform_joints)
    s = tip - base_joints
    length = np.linalg.norm(s, axis=-1)
    if np.any(length < _NO_LENGTH):
        raise InputError("a leg has no length at this pose", key=f"leg {np.argwhere(length < _NO_LENGTH)[0][1] + 1}")
    alpha, beta = joint_angles(frames, s / length[..., None])
    _refuse_folded_joint(beta)
    body = leg_rotations(frames, alpha, beta)
    v = np.einsum("tnij,tni->tnj", body, tip_dot)  # in leg axes
    a = np.einsum("tnij,tni->tnj", body, tip_ddot)
    l_dot = v[..., 2]  # (T2.17)
    wx, wy = -v[..., 1] / length, v[..., 0] / length  # (T2.18)
    cb, sb = np.cos(beta), np.sin(beta)
    alpha_dot, beta_dot = wx / cb, wy
    wz = alpha_dot * sb
    wx_dot = (-a[..., 1] - 2 * l_dot * wx) / length + wy * wz  # (T2.19)
    wy_dot = (a[..., 0] - 2 * l_dot * wy) / length - wx * wz
    return LegState(
        length=length,
        rate=l_dot,
        accel=a[..., 2] + length * (wx**2 + wy**2),  # (T2.20)
        alpha=alpha,
        beta=beta,
        alpha_dot=alpha_dot,
        beta_dot=beta_dot,
        alpha_ddot=(wx_dot + alpha_dot * beta_dot * sb) / cb,
        beta_ddot=wy_dot,
    )


def _refuse_folded_joint(beta: Array) -> None:
    bad = np.argwhere(np.abs(beta) > BETA_LIMIT)
    if len(bad):
        instant, leg = bad[0]
        raise InputError(
            f"the universal joint of leg {leg + 1} folds to beta = {np.rad2deg(beta[instant, leg]):.1f} deg "
            f"(sample {instant + 1} of {len(beta)})",
            key=f"leg {leg + 1}: u_axis",
            allowed="|beta| at most 85 deg",
            next_step="Turn the universal joint's first axis (u_axis), or reduce the motion",
        )
