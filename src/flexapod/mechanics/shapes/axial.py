"""Axial shapes over the whole piston, eta in [0, 1] from its driven end to its tip, Eqs. (T1.10)-(T1.12)."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import Chebyshev, Polynomial

from flexapod.common.arrays import Array
from flexapod.mechanics.shapes.lateral import MOMENTS, proportional_damping


@dataclass(frozen=True, kw_only=True, eq=False)
class AxialBasis:
    """Static shape psi_0 = eta, then psi_n = sin(n pi eta).

    Attributes
    ----------
    mass, stiffness, damping : (m, m) arrays
        int psi psi^T, int psi' psi'^T (diagonal), equal-ratio damping of the fixed-free modes, Eqs. (T1.11), (T5.2).
    first, moment : (m,) arrays
        int psi and int eta psi.
    series : (m, MOMENTS) array
        psi_n as a polynomial in the distance from the tip over the piston's length, x = xi/Lp = 1 - eta, Eq. (T1.12).
    """

    mass: Array
    stiffness: Array
    damping: Array
    first: Array
    moment: Array
    series: Array

    @property
    def count(self) -> int:
        """Number of axial shapes m."""
        return len(self.first)

    @property
    def from_inside(self) -> Array:
        """Coefficients as `series`, in eta from the driven end: sin(n pi eta) is odd about either end."""
        return np.concatenate(
            [np.eye(1, MOMENTS, 1), *(-((-1.0) ** n) * self.series[n : n + 1] for n in range(1, self.count))]
        )[: self.count]

    def values(self, eta: Array) -> Array:
        """Shapes at ``eta`` of shape (n,): (m, n)."""
        rows = [np.asarray(eta, dtype=float)] + [np.sin(n * np.pi * np.asarray(eta)) for n in range(1, self.count)]
        return np.array(rows[: self.count]).reshape(self.count, np.size(eta))


@lru_cache(maxsize=16)
def axial_basis(count: int) -> AxialBasis:
    """``count`` axial shapes; 0 makes the piston rigid along its axis."""
    n = np.arange(1, count)
    sign = (-1.0) ** n
    mass = np.diag(np.concatenate([[1 / 3], np.full(n.size, 0.5)]))
    mass[0, 1:] = mass[1:, 0] = -sign / (n * np.pi)
    stiffness = np.diag(np.concatenate([[1.0], 0.5 * (n * np.pi) ** 2]))
    mass, stiffness = mass[:count, :count], stiffness[:count, :count]
    return AxialBasis(
        mass=mass,
        stiffness=stiffness,
        damping=proportional_damping(mass, stiffness),
        first=np.concatenate([[0.5], (1 - sign) / (n * np.pi)])[:count],
        moment=np.concatenate([[1 / 3], -sign / (n * np.pi)])[:count],
        series=np.array([_series(j) for j in range(count)]).reshape(count, MOMENTS),
    )


def _series(n: int) -> Array:
    """Coefficients of psi_n in x = 1 - eta: 1 - x, or sin(n pi (1 - x)) by odd Chebyshev interpolation to 1e-13."""
    coefficients = np.zeros(MOMENTS)
    if n == 0:
        coefficients[:2] = 1.0, -1.0
        return coefficients
    fit = Chebyshev.interpolate(lambda x: -((-1.0) ** n) * np.sin(n * np.pi * x), MOMENTS - 1, domain=[-1, 1])
    odd = np.where(np.arange(MOMENTS) % 2, np.asarray(fit.coef, dtype=float), 0.0)
    odd[np.abs(odd) < 1e-14] = 0.0
    power = Chebyshev(odd).convert(kind=Polynomial).coef
    coefficients[: power.size] = power
    return coefficients
