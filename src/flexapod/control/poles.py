"""Poles and zeros of a state space, frequencies and damping ratios, (T21.4)-(T21.5)."""

from __future__ import annotations

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from flexapod.arrays import Array

__all__ = ["INTEGRATES", "SWINGS", "damping_of", "poles_of", "swings_of", "zeros_of"]

Complex = NDArray[np.complex128]

RANK = 1e-11  # of the largest number of its row or column: less counts as none
INTEGRATES = 1e-7  # of the largest pole: a double pole at 0 splits that far
SWINGS = 1e-6  # imaginary part over the size of a pole that oscillates
CANCELS = 1e-7  # distance of a zero from a pole over the pole's size at which both are of motions that nothing shows


def poles_of(A: Array) -> Complex:
    """Eigenvalues, the slowest first; of a pair the one below the real axis first, (n,)."""
    values = np.linalg.eigvals(A).astype(complex)
    return values[np.lexsort((np.imag(values), np.real(values), np.abs(values)))]


def damping_of(poles: Complex, sample: float | None) -> tuple[Complex, Array, Array]:
    """Those of `swings_of` of positive or no imaginary part, by frequency."""
    s, frequency, ratio = swings_of(poles, sample)
    upper = np.flatnonzero(s.imag >= 0)
    order = upper[np.lexsort((s.real[upper], frequency[upper]))]
    return s[order], frequency[order], ratio[order]


def swings_of(poles: Complex, sample: float | None) -> tuple[Complex, Array, Array]:
    """Poles [1/s], their frequencies [Hz] and damping ratios, arrays of one shape, Eq. (T21.4).

    Of a sampled system the poles log(z) / T of the continuous one behind it.
    """
    if sample is not None:
        with np.errstate(divide="ignore"):
            behind = np.log(np.asarray(poles, dtype=complex))
        poles = np.real(behind) / sample + 1j * (np.imag(behind) / sample)  # by parts: of a pole at 0 it is -inf
    size = np.abs(poles)
    ratio = np.divide(-poles.real, size, out=np.zeros(poles.shape), where=(size > 0) & np.isfinite(size))
    return poles, size / (2 * np.pi), np.where(np.isinf(size), 1.0, ratio)


def zeros_of(A: Array, B: Array, C: Array, D: Array, poles: Complex) -> Complex:
    """Zeros of the transfer of as many inputs as outputs, Eq. (T21.5), without those that cancel poles; (z,).

    Pencil compressed by rows and then by columns until D is regular (Emami-Naeini & Van Dooren, Automatica 18, 1982).
    """
    rate = _middle_rate(poles)
    A, change = scipy.linalg.matrix_balance(A / rate)
    B, C = np.asarray(np.linalg.solve(change, B), dtype=float), C @ change
    wide, high = _sizes(B, axis=0), _sizes(C, axis=1)
    B, C, D = B / wide, C / high[:, None], rate * D / high[:, None] / wide
    A, B, C, D = _rows_compressed(A, B, C, D)
    A, B, C, D = _rows_compressed(A.T, C.T, B.T, D.T)
    if len(A) == 0 or D.shape[0] != D.shape[1]:
        return np.zeros(0, dtype=complex)
    found = np.linalg.eigvals(A - B @ np.linalg.solve(D, C)) if D.size else np.linalg.eigvals(A)
    return _without_cancelled((rate * found).astype(complex), poles, rate)


def _middle_rate(poles: Complex) -> float:
    """A rate amid those of the poles, so that numbers of the pencil are of one size."""
    size = np.abs(poles)
    size = size[size > INTEGRATES * size.max(initial=0.0)]
    return float(np.exp(np.log(size).mean())) if size.size else 1.0


def _sizes(channels: Array, axis: int) -> Array:
    size = np.linalg.norm(channels, axis=axis)
    return np.where(size > 0, size, 1.0)


def _rows_compressed(A: Array, B: Array, C: Array, D: Array) -> tuple[Array, Array, Array, Array]:
    """The same zeros with a D whose rows are independent: states held by outputs without feed-through are left out."""
    while C.shape[0]:
        left, values, _ = np.linalg.svd(D)
        rank = int((values > RANK).sum())
        if rank == C.shape[0]:
            break
        C, D = left.T @ C, left.T @ D  # rows below `rank` have no feed-through
        basis, held = _held(C[rank:])
        if held == 0:
            return A, B, C[:rank], D[:rank]
        A, B, C, D = _without_held(A, B, C[:rank], D[:rank], basis.T[:, ::-1], len(A) - held)
    return A, B, C, D


def _held(free: Array) -> tuple[Array, int]:
    """Directions of states by how much outputs without feed-through hold them, and how many they hold."""
    if not free.shape[1]:
        return np.zeros((0, 0)), 0
    _, sizes, basis = np.linalg.svd(free)
    return basis, int((sizes > RANK * max(1.0, float(np.abs(free).max(initial=0.0)))).sum())


def _without_held(A: Array, B: Array, C: Array, D: Array, turn: Array, stay: int) -> tuple[Array, Array, Array, Array]:
    """The system turned so that held states are last, without these: what they do counts as outputs."""
    A, B, C = turn.T @ A @ turn, turn.T @ B, C @ turn
    return A[:stay, :stay], B[:stay], np.vstack([C[:, :stay], A[stay:, :stay]]), np.vstack([D, B[stay:]])


def _without_cancelled(zeros: Complex, poles: Complex, rate: float) -> Complex:
    """Zeros by size without those, one for one, that lie upon poles; `rate` counts as the size of smaller poles."""
    left = list(zeros[np.lexsort((zeros.imag, zeros.real, np.abs(zeros)))])
    for pole in poles:
        away = [abs(zero - pole) for zero in left]
        if away and min(away) <= CANCELS * max(abs(pole), rate):
            left.pop(int(np.argmin(away)))
    return np.array(left, dtype=complex)
