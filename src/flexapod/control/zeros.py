"""Zeros of a state space by its whole equations, each verified, Eqs. (T21.5), (T21.48)-(T21.49)."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import scipy.linalg

from flexapod.common.arrays import Array, Complex
from flexapod.common.resources import one_thread
from flexapod.control.frequency_response import mean_rate

SINGULAR = 1e-13  # of the numbers of the scaled equations: a response that is none anywhere
APART = 1e-6  # distance of roots over their size below which they are one that is there twice
REST = 1e-5  # of the middle rate: roots at rest, which accelerations have twice, are not known better
FAR = 1e6  # of the fastest pole: roots beyond it are those without end, which rounding has brought near
ROUNDS = 12  # of inverse iteration to a root
SETTLED = 1e-12  # step of a root over its size
KNOWN = 1e-2  # of its size: a root that rounding of the equations may move farther is none
SHOWN = 1e-6  # of what a response could add up to without cancelling: less is none, and ten times the doubt of a zero
CANCELS = 1e-7  # distance of a zero from a pole over the pole's size at which both are of motions that nothing shows
BESIDE = (
    1e-4  # distance over the size of a pole, be it of a motion that nothing shows, beside which responses are noise
)
BLOCK = 32  # zeros that are checked side by side


@one_thread()
def zeros_of(A: Array, B: Array, C: Array, D: Array, D_rate: Array | None = None) -> Complex:
    """Zeros of the transfer of as many inputs as outputs, Eq. (T21.5), the slowest first; (z,).

    Without those that cancel poles, and without what is no zero: where the response at it is not small beside what it
    could add up to, or where rounding of the matrices alone would move it by a hundredth of its size.
    """
    n, m = B.shape
    if not n or not m:
        return np.zeros(0, dtype=complex)
    rate = mean_rate(np.linalg.eigvals(A).astype(complex))
    A, change = scipy.linalg.matrix_balance(A / rate)
    B, C = np.asarray(np.linalg.solve(change, B), dtype=float), C @ change
    wide, high = _sizes(B, axis=0), _sizes(C, axis=1)
    P = np.block([[A, B / wide], [C / high[:, None], rate * D / high[:, None] / wide]])
    E = np.eye(n + m)
    E[n:, n:] = 0.0 if D_rate is None else -(rate**2) * D_rate / high[:, None] / wide
    if all(_singular(P - s * E) for s in (0.7 + 0.4j, -0.3 + 1.9j)):
        return np.zeros(0, dtype=complex)
    poles, _ = _roots(A, np.eye(n))
    found, doubt = _roots(P, E)
    near = np.abs(found) <= FAR * np.abs(poles).max(initial=1.0)
    kept = _not_cancelled(found[near], poles)
    found, doubt = found[near][kept], doubt[near][kept]
    upon = np.abs(found[:, None] - poles).min(axis=1, initial=np.inf) <= BESIDE * np.abs(found)
    zeros = rate * found[upon | (_least(P, E, n, found) <= np.maximum(SHOWN, 10 * doubt))]
    return np.asarray(zeros[np.lexsort((zeros.imag, zeros.real, np.abs(zeros)))], dtype=np.complex128)


def _roots(P: Array, E: Array) -> tuple[Complex, Array]:
    """Points s at which P - s E is singular, and what rounding may move them by over their size, Eq. (T21.49).

    Those that rounding decides are left out.
    """
    whole: Any = scipy.linalg.eig(P, E, left=True, right=True, homogeneous_eigvals=True)
    w, left, right = whole
    ends = np.flatnonzero(np.abs(w[1]) > np.finfo(float).eps * np.abs(w[0]))
    points = np.asarray(w[0][ends] / w[1][ends], dtype=np.complex128)
    away = np.abs(points[:, None] - points) + np.where(np.eye(len(points)), np.inf, 0.0)
    alone = (np.abs(points) > REST) & (away.min(axis=1, initial=np.inf) > APART * np.abs(points))
    found, doubts = list(points[~alone]), [0.0] * int((~alone).sum())
    for k in np.flatnonzero(alone & (points.imag >= 0)):
        s, doubt = _nearest(P, E, complex(points[k]), left[:, ends[k]], right[:, ends[k]])
        if doubt > KNOWN:
            continue
        mirrored = [s, s.conjugate()] if points[k].imag else [s]
        found += mirrored
        doubts += [doubt] * len(mirrored)
    return np.array(found, dtype=complex), np.array(doubts)


def _nearest(P: Array, E: Array, s: complex, left: Complex, right: Complex) -> tuple[complex, float]:
    """A root by the quotients of its vectors, which inverse iteration mends, and its doubt."""
    doubt = np.inf
    for _ in range(ROUNDS):
        slope = left.conj() @ E @ right
        if slope == 0:
            return s, np.inf
        size = np.abs(left) @ (np.abs(P) + abs(s) * np.abs(E)) @ np.abs(right)
        doubt = float(np.finfo(float).eps * size / max(abs(slope * s), 1e-300))
        last, s = s, complex(left.conj() @ P @ right / slope)
        if abs(s - last) <= max(SETTLED, doubt) * abs(s):
            break
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # next to a root the matrix is singular: that is what is asked for
            factors = scipy.linalg.lu_factor(P - s * E, check_finite=False)
            right, left = (
                scipy.linalg.lu_solve(factors, E @ right),
                scipy.linalg.lu_solve(factors, E.T @ left, trans=2),
            )
        if not (np.isfinite(right).all() and np.isfinite(left).all()):
            break
        right, left = right / np.linalg.norm(right), left / np.linalg.norm(left)
    return s, doubt


def _not_cancelled(zeros: Complex, poles: Complex) -> list[int]:
    """Places of zeros without those, one for one, that lie upon poles; a size below the middle one counts as that."""
    left = list(range(len(zeros)))
    for pole in poles:
        away = [abs(zeros[k] - pole) for k in left]
        if away and min(away) <= CANCELS * max(abs(pole), 1.0):
            left.pop(int(np.argmin(away)))
    return left


def _least(P: Array, E: Array, n: int, points: Complex) -> Array:
    """Least size of the response at points over what it could add up to without cancelling, (z,)."""
    found = np.zeros(len(points))
    for first in range(0, len(points), BLOCK):
        some = points[first : first + BLOCK, None, None]
        M = P - some * E
        try:
            moved = np.linalg.solve(M[:, :n, :n], M[:, :n, n:])
        except np.linalg.LinAlgError:
            continue
        H = M[:, n:, n:] - M[:, n:, :n] @ moved
        rows, columns = np.linalg.norm(M[:, n:, :n], axis=2), np.linalg.norm(moved, axis=1)
        most = (np.abs(M[:, n:, n:]) + rows[:, :, None] * columns[:, None]).max(axis=(1, 2))
        least = np.linalg.svd(H, compute_uv=False)[:, -1]
        found[first : first + BLOCK] = least / np.where(most > 0, most, 1.0)
    return found


def _singular(matrix: Complex) -> bool:
    sizes = np.linalg.svd(matrix, compute_uv=False)
    return bool(sizes[-1] <= SINGULAR * sizes[0])


def _sizes(channels: Array, axis: int) -> Array:
    size = np.linalg.norm(channels, axis=axis)
    return np.where(size > 0, size, 1.0)
