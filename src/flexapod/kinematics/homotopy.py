"""All complex postures of a six-leg platform by continuation of its polynomial system, Eqs. (T2.42)-(T2.46).

A pose is a point q = (e, g) of projective 7-space: e the quaternion of the rotation, g = t e / 2 that of the
translation. Each leg and the Study condition e.g = 0 are quadrics in q. A generic platform has 40 solutions. They are
found once, for one random complex platform, by monodromy from a single known solution; the solutions of any other
platform follow along a straight line in the space of platforms, which misses the singular ones with probability one.

References
----------
Husty, "An algorithm for solving the direct kinematics of general Stewart-Gough platforms", Mech. Mach. Theory 31 (1996)
365-380 (the quadrics). Sommese & Wampler, "The Numerical Solution of Systems of Polynomials", World Scientific (2005),
chapters 7 and 15 (parameter continuation, monodromy).
"""

from __future__ import annotations

import itertools
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from flexapod.common.arrays import Complex
from flexapod.common.errors import ComputationError

GENERIC_POSTURES = 40  # complex solutions of a generic platform, Raghavan 1993; Ronga & Vust 1995

_SEED = 1998
_MAX_LOOPS = 60
_AT_INFINITY = 1e-6  # norm of e in a unit solution, below which it is not a pose
_LEAVING = 1e-2  # norm of e at which a path that stopped short is taken to go to infinity
_SAME = 1e-9  # unit vectors nearer than this are one solution; distinct ones of a generic system differ by > 1e-7


class Platform(NamedTuple):
    """Platform joints (6, 3), base joints (6, 3) and squared leg lengths (6,); real or complex, of order one."""

    platform: Complex
    base: Complex
    squared: Complex


def _multiplications(v: Complex) -> tuple[Complex, Complex]:
    """Matrices of left and right quaternion multiplication by vectors (n, 3), each (n, 4, 4)."""
    left = np.zeros((len(v), 4, 4), dtype=complex)
    right = np.zeros_like(left)
    for m, side in ((left, 1), (right, -1)):
        m[:, 0, 1:], m[:, 1:, 0] = -v, v
        for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            m[:, 1 + i, 1 + j], m[:, 1 + j, 1 + i] = -side * v[:, k], side * v[:, k]
    return left, right


def quadrics(platform: Platform) -> Complex:
    """Symmetric matrices A_i of the six leg equations and the Study condition, q^T A_i q = 0, Eqs. (T2.43)-(T2.44).

    Returns
    -------
    ndarray of complex, shape (7, 8, 8)
    """
    left, _ = _multiplications(platform.base)
    _, right = _multiplications(platform.platform)
    out = np.zeros((7, 8, 8), dtype=complex)
    constant = np.sum(platform.platform**2 + platform.base**2, axis=1) - platform.squared
    out[:6, :4, :4] = constant[:, None, None] * np.eye(4) + 2 * left @ right
    out[:6, :4, 4:] = 2 * (left - right)
    out[:6, 4:, :4] = np.swapaxes(out[:6, :4, 4:], -1, -2)
    out[:6, 4:, 4:] = 4 * np.eye(4)
    out[6, :4, 4:] = out[6, 4:, :4] = np.eye(4) / 2
    return out


def _solve(matrix: Complex, rhs: Complex) -> Complex:
    """Solutions of linear systems (n, 8, 8), nan where a matrix is exactly singular."""
    try:
        return np.asarray(np.linalg.solve(matrix, rhs[..., None])[..., 0], dtype=np.complex128)
    except np.linalg.LinAlgError:
        out = np.full_like(rhs, np.nan)
        regular = np.linalg.det(matrix) != 0
        out[regular] = np.linalg.solve(matrix[regular], rhs[regular][..., None])[..., 0]
        return out


class _Segment:
    """The quadrics along the straight line from one platform to another: quadratic in s, Eq. (T2.45)."""

    def __init__(self, start: Platform, end: Platform) -> None:
        middle = Platform(*((a + b) / 2 for a, b in zip(start, end, strict=True)))
        at_start, at_middle, at_end = quadrics(start), quadrics(middle), quadrics(end)
        second = 2 * (at_start + at_end - 2 * at_middle)
        self._terms = np.stack([at_start, at_end - at_start - second, second]).reshape(-1, 8).T

    def evaluate(self, q: Complex, s: NDArray) -> tuple[Complex, Complex, Complex]:
        """Residual (n, 7), its derivative by q (n, 7, 8) and by s (n, 7) at q (n, 8), s (n,)."""
        products = (q @ self._terms).reshape(-1, 3, 7, 8)
        x = s[:, None, None]
        row: Complex = products[:, 0] + x * (products[:, 1] + x * products[:, 2])
        slope = products[:, 1] + 2 * x * products[:, 2]
        along = np.einsum("nij,nj->ni", slope, q)
        return np.einsum("nij,nj->ni", row, q), row + row, along

    def _bordered(self, q: Complex, patch: Complex, s: NDArray, residual: bool) -> Complex:
        f, f_q, f_s = self.evaluate(q, s)
        matrix = np.concatenate([f_q, patch[:, None]], axis=1)
        rhs = np.concatenate([f if residual else f_s, np.zeros((len(q), 1), dtype=complex)], axis=1)
        return -_solve(matrix, rhs)

    def tangent(self, q: Complex, patch: Complex, s: NDArray) -> Complex:
        """dq/ds in the affine patch, (n, 8)."""
        return self._bordered(q, patch, s, residual=False)

    def correction(self, q: Complex, patch: Complex, s: NDArray) -> Complex:
        """Newton step at fixed s in the affine patch, (n, 8)."""
        return self._bordered(q, patch, s, residual=True)


def _try_step(segment: _Segment, q: Complex, s: NDArray, h: NDArray, accuracy: float) -> tuple[Complex, NDArray]:
    """Fourth-order prediction and Newton correction of unit vectors q; which of them are trustworthy."""
    patch, half, full = q.conj(), s + h / 2, s + h
    step = h[:, None]
    k1 = segment.tangent(q, patch, s)
    k2 = segment.tangent(q + step / 2 * k1, patch, half)
    k3 = segment.tangent(q + step / 2 * k2, patch, half)
    k4 = segment.tangent(q + step * k3, patch, full)
    x = q + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    first = segment.correction(x, patch, full)
    x = x + first
    second = segment.correction(x, patch, full)
    x = x + second
    size = np.linalg.norm(x, axis=1, keepdims=True)
    moved = np.linalg.norm(x - q, axis=1)
    good = (np.linalg.norm(first, axis=1) < accuracy) & (np.linalg.norm(second, axis=1) < 1e-3 * accuracy)
    return x / size, good & (moved < 0.3)


def _track(start: Platform, end: Platform, q: Complex, accuracy: float = 1e-5) -> tuple[Complex, NDArray[np.bool_]]:
    """Follow solutions q (n, 8) from one platform to another; end points as unit vectors and which arrived."""
    segment = _Segment(start, end)
    q = q / np.linalg.norm(q, axis=1, keepdims=True)
    s, h, streak = np.zeros(len(q)), np.full(len(q), 0.02), np.zeros(len(q), dtype=int)
    active = np.arange(len(q))
    with np.errstate(all="ignore"):
        while len(active):
            step = np.minimum(h[active], 1 - s[active])
            trial, good = _try_step(segment, q[active], s[active], step, accuracy)
            kept, refused = active[good], active[~good]
            q[kept] = trial[good]
            s[kept] = np.where(step[good] >= 1 - s[kept], 1.0, s[kept] + step[good])
            streak[kept] += 1
            streak[refused] = 0
            h[refused] = step[~good] / 2
            grown = kept[streak[kept] >= 2]
            h[grown], streak[grown] = 2 * h[grown], 0
            active = active[(s[active] < 1) & (h[active] > 1e-9)]
        for _ in range(3):
            polished = q + segment.correction(q, q.conj(), np.ones(len(q)))
            polished /= np.linalg.norm(polished, axis=1, keepdims=True)
            usable = np.all(np.isfinite(polished), axis=1) & (s == 1)
            q[usable] = polished[usable]
    return q, s == 1


def distinct(q: Complex, tolerance: float = _SAME) -> NDArray[np.intp]:
    """Find the projectively different rows of unit vectors q (n, 8): their indices."""
    kept: list[int] = []
    for i, row in enumerate(q):
        inner = q[kept].conj() @ row
        gap = np.linalg.norm(row - q[kept] * inner[:, None], axis=1)  # sine of the angle, without cancellation
        if np.all(gap > tolerance):
            kept.append(i)
    return np.array(kept, dtype=np.intp)


def _random_platform(rng: np.random.Generator) -> Platform:
    def draw(*shape: int) -> Complex:
        return (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / np.sqrt(2)

    return Platform(draw(6, 3), draw(6, 3), draw(6))


@lru_cache(maxsize=1)
def _generic() -> tuple[Platform, Complex]:
    """Solve a generic complex platform by monodromy: the platform and its 40 solutions, Eq. (T2.46)."""
    rng = np.random.default_rng(_SEED)
    platform = _random_platform(rng)
    e, t = _random_platform(rng).platform[:2].reshape(6)[:4], _random_platform(rng).platform[:1]
    left, _ = _multiplications(t)
    q = np.concatenate([e, left[0] @ e / 2])[None]
    gap = np.einsum("nij,i,j->n", quadrics(platform)[:6], q[0], q[0]) / np.sum(e**2)
    platform = platform._replace(squared=platform.squared + gap)
    q = q / np.linalg.norm(q)
    for _ in range(_MAX_LOOPS):
        corners = [platform, _random_platform(rng), _random_platform(rng), platform]
        turned, arrived = q, np.ones(len(q), dtype=bool)
        for start, end in itertools.pairwise(corners):
            turned, kept = _track(start, end, turned)
            arrived &= kept
        q = np.concatenate([q, turned[arrived]])
        q = q[distinct(q, 1e-6)]
        if len(q) >= GENERIC_POSTURES:
            break
    if len(q) != GENERIC_POSTURES:
        raise ComputationError(f"Found {len(q)} of {GENERIC_POSTURES} postures of the generic start platform")
    q.flags.writeable = False
    return platform, q


def complex_postures(platform: Platform) -> Complex:
    """All isolated finite complex solutions q = (e, g) of a platform, Eq. (T2.45).

    Parameters
    ----------
    platform : Platform
        Joints and squared lengths of order one.

    Returns
    -------
    ndarray of complex, shape (m, 8)
        Unit vectors; m = 40 on a generic platform, fewer where solutions lie at infinity (e = 0), coincide, or belong
        to a self-motion.
    """
    start, known = _generic()
    target = Platform(*(np.asarray(part, dtype=complex) for part in platform))
    q, arrived = _track(start, target, known)
    first = np.intersect1d(distinct(q), np.flatnonzero(arrived))
    again = np.setdiff1d(np.flatnonzero(np.linalg.norm(q[:, :4], axis=1) > _LEAVING), first)
    if len(again):  # paths that met another or stopped short are followed once more in finer steps
        finer, arrived = _track(start, target, known[again], accuracy=1e-7)
        q, first = np.concatenate([q[first], finer[arrived]]), np.arange(len(first) + np.sum(arrived))
    found = q[first]
    found = found[np.linalg.norm(found[:, :4], axis=1) > _AT_INFINITY]
    return found[distinct(found)]
