"""Loops that are more than springs and dampers on their rotors, in undamped modes, Eqs. (T23.58)-(T23.60)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexapod.bases.eigen import finite
from flexapod.typing import Array
from flexapod.words import text

__all__ = ["ModalLoops", "growth", "unstable_words"]

Complex = NDArray[np.complex128]
GROWS = 1e-9  # real part over size of an eigenvalue: less is rounding


@dataclass(frozen=True, kw_only=True)
class ModalLoops:
    """L loops in r undamped modes of unit stiffness, in which each is a spring and a damper on its rotor.

    ``rotor``, ``measured``, ``damped`` (r, L): travel of the rotors, what is measured and what has the measured rate,
    by the modes; ``stiffness`` [N/m], ``damping`` [N s/m], ``integral`` [N/(m s)], ``lag`` [s] (L,).
    """

    rotor: Array
    measured: Array
    damped: Array
    stiffness: Array
    damping: Array
    integral: Array
    lag: Array

    def dynamic(self, s: NDArray[np.complexfloating]) -> Complex:
        """What they add to the dynamic stiffness (f, r, r) at s (f,) [1/s], Eq. (T23.58)."""
        s = s[:, None, None]
        k, c, g, lag = (x[:, None] for x in (self.stiffness, self.damping, self.integral, self.lag))
        asked = (k + g / s) * self.measured.T + s * c * self.damped.T
        return np.asarray(self.rotor @ (asked / (1 + s * lag) - (k + s * c) * self.rotor.T), dtype=np.complex128)

    def eigen(self, omega: Array, D: Array) -> tuple[Complex, Complex]:
        """Eigenvalues [1/s], and their shapes (r, any), of modes with damping (r, r), Eq. (T23.59)."""
        finite(D)
        r, count = self.rotor.shape
        z, y = slice(0, r), slice(r, 2 * r)
        force, total = slice(2 * r, 2 * r + count), slice(2 * r + count, 2 * (r + count))
        slowness, unit, sums = np.diag(omega.min() / omega), np.sqrt(self.stiffness), self.integral > 0
        A, E = np.zeros((2, 2 * (r + count), 2 * (r + count)))
        rate, b, seen = omega.min(), self.rotor * unit, self.measured * unit  # times are in 1 over the first frequency
        A[z, z], A[z, force] = np.eye(r) - b @ b.T, -b
        E[z, z] = rate * (D - self.rotor * self.damping @ self.rotor.T)
        E[z, y], E[y, z], A[y, y] = slowness, -slowness, np.eye(r)
        A[force, z], A[force, force], A[force, total] = seen.T, np.eye(count), -np.diag(sums * 1.0)
        E[force, z] = rate * (self.damping / unit * self.damped).T
        E[force, force] = rate * np.diag(self.lag)
        A[total, z] = (self.integral / unit * self.measured).T / rate
        A[total, total], E[total, total] = np.diag(~sums * 1.0), np.diag(sums * 1.0)
        finite(A, E)
        values, shapes = np.linalg.eig(-np.linalg.solve(A, E))
        slow = np.abs(values) > np.finfo(float).eps
        return rate / values[slow], shapes[z, slow]


def growth(values: Complex) -> float:
    """Rate at which the fastest of them grows [1/s]; 0 where all decay."""
    grows = values.real > GROWS * np.abs(values)
    return float(values.real[grows].max(initial=0.0))


def unstable_words(rate: float, where: str = "") -> list[str]:
    """That loops are unstable, whose deviations grow at a rate [1/s] at a place in words; nothing at 0."""
    if not rate:
        return []
    return [
        f"the loops of the drives are unstable{where}: deviations grow by a factor of 2.7 in {text(1 / rate, 's')}; "
        'smaller gains, a motor of more bandwidth, or damping by the rotor\'s rate (encoder.rate = "rotor") may help'
    ]
