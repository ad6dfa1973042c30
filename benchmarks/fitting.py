"""How a cost grows: exponents and polynomials by least squares, with their uncertainty."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from flexapod.common.arrays import Array

__all__ = ["Polynomial", "Power", "fitted_polynomial", "fitted_power"]


@dataclass(frozen=True, kw_only=True)
class Power:
    """cost = factor x^exponent, with the exponent's standard error."""

    exponent: float
    uncertainty: float
    factor: float

    def text(self) -> str:
        """Exponent and standard error."""
        return f"{self.exponent:.2f} ± {self.uncertainty:.2f}"


@dataclass(frozen=True, kw_only=True)
class Polynomial:
    """cost = sum of coefficients x^i, with standard errors, both lowest first."""

    coefficients: Array
    uncertainty: Array

    def __call__(self, x: float) -> float:
        """Cost at x."""
        return float(np.polynomial.polynomial.polyval(x, self.coefficients))

    def share(self, power: int, x: float) -> float:
        """Share of one term in the cost at x."""
        return float(self.coefficients[power] * x**power / self(x))


def fitted_power(x: ArrayLike, cost: ArrayLike) -> Power:
    """Straight line through the logarithms.

    Raises
    ------
    ValueError
        Fewer than three points: there is no uncertainty.
    """
    line, errors = _least_squares(np.log(np.asarray(x, float)), np.log(np.asarray(cost, float)), 1)
    return Power(exponent=float(line[1]), uncertainty=float(errors[1]), factor=float(np.exp(line[0])))


def fitted_polynomial(x: ArrayLike, cost: ArrayLike, degree: int) -> Polynomial:
    """Polynomial of a degree with relative weights (an error of a tenth of the cost weighs alike everywhere).

    Raises
    ------
    ValueError
        No more points than coefficients.
    """
    cost = np.asarray(cost, float)
    coefficients, errors = _least_squares(np.asarray(x, float), cost, degree, 1 / cost)
    return Polynomial(coefficients=coefficients, uncertainty=errors)


def _least_squares(x: Array, y: Array, degree: int, weights: Array | None = None) -> tuple[Array, Array]:
    """Coefficients and standard errors, lowest power first."""
    if len(x) <= degree + 1:
        raise ValueError(f"{len(x)} points cannot tell the uncertainty of {degree + 1} coefficients")
    w = np.ones(len(x)) if weights is None else weights
    A = w[:, None] * np.vander(x, degree + 1, increasing=True)
    coefficients, *_ = np.linalg.lstsq(A, w * y, rcond=None)
    residual = A @ coefficients - w * y
    variance = residual @ residual / (len(x) - degree - 1)
    errors: Array = np.sqrt(variance * np.diag(np.linalg.inv(A.T @ A)))
    return np.asarray(coefficients, float), errors
