"""Poles of a state space, their frequencies and damping ratios, (T21.4)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flexapod.common.arrays import Array

__all__ = ["INTEGRATES", "SWINGS", "damping_of", "middle_rate", "poles_of", "swings_of"]

Complex = NDArray[np.complex128]

INTEGRATES = 1e-7  # of the largest pole: a double pole at 0 splits that far
SWINGS = 1e-6  # imaginary part over the size of a pole that oscillates


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


def middle_rate(poles: Complex) -> float:
    """A rate amid those of the poles [1/s], so that numbers of the equations are of one size."""
    size = np.abs(poles)
    size = size[size > INTEGRATES * size.max(initial=0.0)]
    return float(np.exp(np.log(size).mean())) if size.size else 1.0
