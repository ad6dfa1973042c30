"""Forward kinematics: the pose from six leg lengths, near a guess or all real ones, Eqs. (T2.40)-(T2.42)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from flexapod.common.arrays import Array, Complex
from flexapod.common.errors import ComputationError, InputError
from flexapod.kinematics.homotopy import Platform, complex_postures
from flexapod.kinematics.inverse import leg_lengths
from flexapod.kinematics.jacobian import length_jacobian
from flexapod.kinematics.rotations import exponential
from flexapod.kinematics.trajectory import Poses

RESIDUAL = 1e-12  # largest length error of a pose, relative to the longest leg

_MAX_ITERATIONS = 100
_SHORTEST_STEP = 1e-3  # fraction of a Newton step below which a sample is given up
_LARGEST_TURN = 0.7  # rad in one step
_REAL = 1e-6  # imaginary part of a unit solution vector below which a real pose is tried


@dataclass(frozen=True, kw_only=True)
class Postures:
    """All poses that fit six leg lengths.

    Attributes
    ----------
    poses : Poses
        The real ones, from the highest to the lowest.
    complex_count : int
        Number of different finite complex solutions: 40 on a generic platform, fewer on special ones, where the rest
        lies at infinity, coincides or belongs to a self-motion.
    """

    poses: Poses
    complex_count: int


def _checked(lengths: ArrayLike) -> Array:
    lengths = np.atleast_2d(np.asarray(lengths, dtype=float))
    if lengths.ndim != 2 or lengths.shape[1] != 6 or not np.all(np.isfinite(lengths) & (lengths > 0)):
        raise InputError("six positive leg lengths are needed", key="lengths", allowed="(6,) or (T, 6) in metres")
    return lengths


def _residual(base: Array, platform: Array, lengths: Array, p: Array, r: Array) -> tuple[Array, Array]:
    error = leg_lengths(base, platform, p, r) - lengths
    return error, np.max(np.abs(error), axis=1) / np.max(lengths, axis=1)


def _newton(base: Array, platform: Array, lengths: Array, p: Array, r: Array) -> tuple[Array, Array, Array]:
    """Damped Newton on SE(3), Eq. (T2.41): position, rotation and relative residual of each sample."""
    error, size = _residual(base, platform, lengths, p, r)
    scale = np.ones(len(p))
    for _ in range(_MAX_ITERATIONS):
        busy = (size > RESIDUAL / 100) & (scale > _SHORTEST_STEP)
        if not np.any(busy):
            break
        jacobian = length_jacobian(base, platform, p, r)
        twist = -np.einsum("tij,tj->ti", np.linalg.pinv(jacobian, rcond=1e-14), error)
        turn = np.linalg.norm(twist[:, 3:], axis=1)
        twist *= (scale * np.minimum(1.0, _LARGEST_TURN / np.maximum(turn, _LARGEST_TURN)))[:, None]
        p_new, r_new = p + twist[:, :3], exponential(twist[:, 3:]) @ r
        error_new, size_new = _residual(base, platform, lengths, p_new, r_new)
        better = busy & (size_new < size)
        p, r = np.where(better[:, None], p_new, p), np.where(better[:, None, None], r_new, r)
        error, size = np.where(better[:, None], error_new, error), np.where(better, size_new, size)
        scale = np.where(better, np.minimum(1.0, 2 * scale), scale / 2)
    return p, r, size


def newton(
    base_joints: ArrayLike, platform_joints: ArrayLike, lengths: ArrayLike, position: ArrayLike, rotation: ArrayLike
) -> Poses:
    """Poses at given leg lengths near given guesses, all samples at once, Eq. (T2.41).

    Parameters
    ----------
    base_joints, platform_joints : array_like, shape (6, 3)
        World axes; platform axes [m].
    lengths : array_like, shape (6,) or (T, 6)
        Joint-to-joint lengths [m].
    position, rotation : array_like, shape (3,) or (T, 3); (3, 3) or (T, 3, 3)
        Guesses, one for all samples or one each.

    Returns
    -------
    Poses
        At rest; residual of the lengths below `RESIDUAL` times the longest leg.

    Raises
    ------
    InputError
        If the lengths are not six positive numbers.
    ComputationError
        If no pose is found from a guess.
    """
    base, platform, targets = np.asarray(base_joints, float), np.asarray(platform_joints, float), _checked(lengths)
    p = np.array(np.broadcast_to(np.asarray(position, float), (len(targets), 3)))
    r = np.array(np.broadcast_to(np.asarray(rotation, float), (len(targets), 3, 3)))
    p, r, size = _newton(base, platform, targets, p, r)
    if not np.all(size <= RESIDUAL):
        k = int(np.argmax(size > RESIDUAL))
        raise ComputationError(
            f"No pose fits the leg lengths of sample {k + 1} near the guess (relative residual {size[k]:.1e})",
            next_step="Start from a nearer guess, or list all postures",
        )
    return Poses.at_rest(p, r)


def newton_path(base_joints: ArrayLike, platform_joints: ArrayLike, lengths: ArrayLike, start: Poses) -> Poses:
    """Poses along a path of lengths (T, 6): each sample starts from the one before, the first from `start`."""
    p, r = start.position[0], start.rotation[0]
    found = []
    for row in _checked(lengths):
        pose = newton(base_joints, platform_joints, row, p, r)
        p, r = pose.position[0], pose.rotation[0]
        found.append((p, r))
    return Poses.at_rest([pose[0] for pose in found], [pose[1] for pose in found])


def real_postures(q: Complex) -> tuple[Array, Array]:
    """Positions (m, 3) and rotations (m, 3, 3) of the real solutions among unit vectors q (n, 8), Eq. (T2.42)."""
    phase = np.take_along_axis(q, np.argmax(np.abs(q), axis=1)[:, None], axis=1)
    aligned = q * phase.conj() / np.abs(phase)
    real = (np.max(np.abs(aligned.imag), axis=1) < _REAL) & (np.linalg.norm(aligned[:, :4], axis=1) > 1e-6)
    e, g = np.split(aligned[real].real, 2, axis=1)
    size = np.linalg.norm(e, axis=1, keepdims=True)
    (w, v), g = (e[:, :1] / size, e[:, 1:] / size), g / size
    position = 2 * (w * g[:, 1:] - g[:, :1] * v - np.cross(g[:, 1:], v))  # vector part of 2 g conj(e)
    turn = 2 * np.arctan2(np.linalg.norm(v, axis=1, keepdims=True), w)
    axis = v / np.maximum(np.linalg.norm(v, axis=1, keepdims=True), 1e-300)
    return position, exponential(turn * axis)


def all_postures(base_joints: ArrayLike, platform_joints: ArrayLike, lengths: ArrayLike) -> Postures:
    """All real poses of a six-leg platform at given leg lengths, Eqs. (T2.42)-(T2.46).

    Parameters
    ----------
    base_joints, platform_joints : array_like, shape (6, 3)
        World axes; platform axes [m].
    lengths : array_like, shape (6,)
        Joint-to-joint lengths [m].

    Returns
    -------
    Postures
        Each pose at rest, refined to a residual below `RESIDUAL` times the longest leg.

    Raises
    ------
    InputError
        If the lengths are not six positive numbers.
    """
    base, platform = np.asarray(base_joints, float), np.asarray(platform_joints, float)
    target = _checked(lengths)[0]
    unit = float(np.max(target))
    base_centre, platform_centre = base.mean(axis=0), platform.mean(axis=0)
    scaled = Platform((platform - platform_centre) / unit, (base - base_centre) / unit, (target / unit) ** 2)
    q = complex_postures(scaled)
    p, r = real_postures(q)
    p = p * unit + base_centre - r @ platform_centre
    p, r, size = _newton(base, platform, np.broadcast_to(target, (len(p), 6)), p, r)
    good = size <= RESIDUAL
    p, r = p[good], r[good]
    order = np.argsort(-p[:, 2], kind="stable")
    return Postures(poses=Poses.at_rest(p[order].reshape(-1, 3), r[order]), complex_count=len(q))
