"""Length Jacobian of the legs and how near a pose or path is to a singularity, Eqs. (T2.21)-(T2.25)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from flexapod.common.arrays import Array
from flexapod.kinematics.rotations import cross, dot, time_first, time_last
from flexapod.kinematics.trajectory import Poses

STRIDES = (64, 8, 1)  # every so many poses of a path are looked at, where the last look leaves a doubt
ALIKE = 1e-12  # singular values of scaled Jacobians, of order 1, that are equal but for rounding


@dataclass(frozen=True, kw_only=True)
class SingularityPath:
    """Measures of the scaled Jacobian along a path of T poses.

    Attributes
    ----------
    smallest_singular_value, condition, determinant : ndarray, shape (T,)
        Of the scaled Jacobian [-]; the condition is inf where it is singular.
    worst : int
        Index of the pose with the smallest singular value.
    sign_changes : ndarray of int, shape (m,)
        Indices k where the determinant changes sign between the poses k and k + 1.
    """

    smallest_singular_value: Array
    condition: Array
    determinant: Array
    worst: int
    sign_changes: np.ndarray


@dataclass(frozen=True, kw_only=True)
class NearestSingularity:
    """The pose of a path with the smallest singular value of the scaled Jacobian.

    Attributes
    ----------
    worst : int
        Its index, the first of several.
    smallest_singular_value, condition : float
        There [-]; the condition is inf where it is singular.
    sign_changes : ndarray of int, shape (m,)
        Indices k where the determinant changes sign between the poses k and k + 1.
    """

    worst: int
    smallest_singular_value: float
    condition: float
    sign_changes: np.ndarray


def length_jacobian(
    base_joints: ArrayLike,
    platform_joints: ArrayLike,
    position: ArrayLike,
    rotation: ArrayLike,
    point: ArrayLike = (0.0, 0.0, 0.0),
) -> Array:
    """Map from the twist of a platform point to leg rates: rows ``[u_i, (r_i - c) x u_i]``, Eq. (T2.21).

    Parameters
    ----------
    base_joints, platform_joints : array_like, shape (n, 3)
        World axes; platform axes [m].
    position, rotation : array_like, shape (..., 3) and (..., 3, 3)
        Poses of the platform frame.
    point : array_like, shape (3,)
        Reference point of the twist, platform axes [m]; the platform frame's origin by default.

    Returns
    -------
    ndarray, shape (..., n, 6)
        ``l_dot = J [v_point, omega]``, twist in world axes; columns 1-3 [-], 4-6 [m].
    """
    position, rotation = np.asarray(position, dtype=float), np.asarray(rotation, dtype=float)
    joints = np.asarray(platform_joints, dtype=float)
    lead = np.broadcast_shapes(position.shape[:-1], rotation.shape[:-2])
    turn = time_last(np.broadcast_to(rotation, (*lead, 3, 3)).reshape(-1, 3, 3))
    p = np.broadcast_to(position, (*lead, 3)).reshape(-1, 3).T[:, None]
    s = p + joints @ turn - np.asarray(base_joints, dtype=float).T[..., None]  # (3, n, T)
    u = s / np.sqrt(dot(s, s))
    arm = (joints - np.asarray(point, dtype=float)) @ turn
    return time_first([*u, *cross(arm, u)]).reshape(*lead, len(joints), 6)


def characteristic_length(platform_joints: ArrayLike) -> float:
    """Root-mean-square distance of the platform joints from their centroid [m], Eq. (T2.22).

    The radius, for joints on a circle.
    """
    joints = np.asarray(platform_joints, dtype=float)
    return float(np.sqrt(np.mean(np.sum((joints - joints.mean(axis=0)) ** 2, axis=1))))


def dimensionless_jacobian(jacobian: Array, length: float) -> Array:
    """Dimensionless Jacobian: the rotational columns divided by a characteristic length [m], Eq. (T2.23)."""
    return jacobian / np.array([1.0, 1.0, 1.0, length, length, length])


def singularity_measures(jacobians: Array) -> SingularityPath:
    """Distance to singularity along a path, Eq. (T2.24).

    Parameters
    ----------
    jacobians : ndarray, shape (T, m, d)
        Scaled Jacobians of T poses in the order of the path, m at least d; with more rows than columns the determinant
        is the root of that of ``J^T J``, which has no sign.

    Returns
    -------
    SingularityPath
    """
    singular = np.asarray(np.linalg.svd(jacobians, compute_uv=False), dtype=np.float64)
    smallest = singular[:, -1]
    condition = np.divide(singular[:, 0], smallest, out=np.full(len(jacobians), np.inf), where=smallest > 0)
    determinant = _determinant(jacobians, singular)
    return SingularityPath(
        smallest_singular_value=smallest,
        condition=condition,
        determinant=determinant,
        worst=_first(smallest),
        sign_changes=np.flatnonzero(np.signbit(determinant[:-1]) != np.signbit(determinant[1:])),
    )


def _first(smallest: Array) -> int:
    """The first of the smallest numbers, of those that rounding makes differ."""
    return int(np.argmax(smallest <= smallest.min() + ALIKE))


def _determinant(jacobians: Array, singular: Array) -> Array:
    return np.linalg.det(jacobians) if jacobians.shape[1] == jacobians.shape[2] else singular.prod(axis=1)


def most_singular_pose(jacobians: Array) -> NearestSingularity:
    """Most singular pose of a path as `singularity_measures` finds it, at a fraction of its cost, Eq. (T2.24).

    A singular value moves by no more than the matrix does: ``|sigma(J) - sigma(J_k)| <= |J - J_k|`` in the Frobenius
    norm (Weyl). A pose near one whose smallest singular value is known needs none of its own where this bound keeps
    it at or above the smallest found; and as long as that is positive, the determinant has not changed sign between.

    Parameters as for `singularity_measures`.
    """
    j = jacobians
    singular, sign = np.full((len(j), j.shape[2]), np.inf), np.zeros(len(j), dtype=bool)
    bound, best = np.full(len(j), -np.inf), np.inf
    for stride in STRIDES:
        at = np.arange(0, len(j), stride)
        at = at[bound[at] < best]
        if not at.size:
            continue
        singular[at] = np.linalg.svd(j[at], compute_uv=False)
        sign[at] = np.signbit(_determinant(j[at], singular[at]))
        bound[at], best = singular[at, -1], min(best, float(singular[at, -1].min(initial=np.inf)))
        left = np.flatnonzero(bound < best)
        near = np.maximum.accumulate(np.where(np.isfinite(singular[:, 0]), np.arange(len(j)), 0))[left]
        bound[left] = singular[near, -1] - np.sqrt(np.sum((j[left] - j[near]) ** 2, axis=(1, 2)))
        sign[left] = sign[near]
    worst = _first(singular[:, -1])
    smallest = float(singular[worst, -1])
    return NearestSingularity(
        worst=worst,
        smallest_singular_value=smallest,
        condition=float(singular[worst, 0]) / smallest if smallest > 0 else np.inf,
        sign_changes=np.flatnonzero(sign[:-1] != sign[1:]),
    )


def scaled_path(base_joints: ArrayLike, platform_joints: ArrayLike, poses: Poses) -> Array:
    """Scaled Jacobians (T, n, 6) about the centroid of the platform joints, Eq. (T2.23).

    Neither the choice of the platform frame nor the unit of length changes them.
    """
    joints = np.asarray(platform_joints, dtype=float)
    raw = length_jacobian(base_joints, joints, poses.position, poses.rotation, joints.mean(axis=0))
    return dimensionless_jacobian(raw, characteristic_length(joints))


def sharing_inverse(lines: Array, leg_stiffness: Array) -> Array:
    """Axial forces of the legs for unit wrenches, of those that balance the ones of least strain energy, Eq. (T7.30).

    Its transpose is the displacement by unit errors of lengths that springs of these stiffnesses share.

    Parameters
    ----------
    lines : ndarray, shape (T, n, 6)
        Length Jacobians at a point about which moments are taken, n at least 6.
    leg_stiffness : ndarray, shape (n,)
        Axial stiffness of the legs, in any unit.

    Returns
    -------
    ndarray, shape (T, n, 6)

    Raises
    ------
    numpy.linalg.LinAlgError
        A pose is exactly singular.
    """
    if lines.shape[1] == lines.shape[2]:
        return np.asarray(np.linalg.inv(lines.swapaxes(1, 2)), dtype=np.float64)
    per_length = np.sqrt(np.mean(lines[..., :3] ** 2) / np.mean(lines[..., 3:] ** 2))
    unit = np.array([1.0, 1.0, 1.0, per_length, per_length, per_length])
    scaled, weight = lines * unit, (leg_stiffness / leg_stiffness.max())[:, None]
    back = (weight * scaled) @ np.linalg.inv(scaled.swapaxes(1, 2) @ (weight * scaled))
    back = back @ (2 * np.eye(6) - scaled.swapaxes(1, 2) @ back)  # a step of refinement: rounding as of one solution
    return np.asarray(back * unit, dtype=np.float64)


def stiffness(jacobian: Array, leg_stiffness: ArrayLike) -> Array:
    """Stiffness of the unloaded platform on axial springs, ``J^T diag(k) J``, Eq. (T2.25).

    Parameters
    ----------
    jacobian : ndarray, shape (..., n, 6)
        From `length_jacobian`.
    leg_stiffness : array_like, shape () or (n,)
        Axial stiffness of the legs [N/m].

    Returns
    -------
    ndarray, shape (..., 6, 6)
        Force and moment at the Jacobian's point per displacement and turn [N/m, N, N m].
    """
    k = np.broadcast_to(np.asarray(leg_stiffness, dtype=float), jacobian.shape[-2:-1])
    return np.swapaxes(jacobian, -1, -2) @ (k[:, None] * jacobian)
