"""Polynomial shapes of the ``tip-load`` basis: the static shape under a tip force and modes with the tip held."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import Legendre

from flexapod.common.arrays import Array
from flexapod.mechanics.shapes.beam_functions import gauss_unit
from flexapod.mechanics.shapes.eigen import eigh


@dataclass(frozen=True, kw_only=True)
class PolynomialShape:
    """Shape phi(zeta) as a Legendre series on [0, 1]."""

    series: Legendre

    def __call__(self, zeta: Array, derivative: int = 0) -> Array:
        """Value (or ``derivative``-th derivative in zeta) at ``zeta`` (any shape), dimensionless."""
        return np.asarray(self._derivatives[derivative](np.asarray(zeta, dtype=float)))

    @cached_property
    def _derivatives(self) -> list[Legendre]:
        return [self.series, *(self.series.deriv(k) for k in (1, 2, 3))]


def tip_load_shapes(count: int, *, moment: bool = False) -> list[PolynomialShape]:
    """Static tip-load shape (3 zeta^2 - zeta^3)/2 first, then ``count - 1`` modes with the tip held, Eq. (T1.5).

    The held modes are the Ritz eigenfunctions of the clamped-pinned beam in the polynomials of degree count + 2 without
    tip moment; where the tip takes a ``moment``, in all of degree count + 1, Eq. (T1.18). Together they span every such
    polynomial, which converges exponentially for pinned and rotating beams, and the shapes stay well conditioned (their
    mass block is the identity, the stiffness matrix is diagonal).
    """
    static = Legendre(
        np.polynomial.Polynomial([0.0, 0.0, 1.5, -0.5]).convert(kind=Legendre, domain=[0, 1]).coef, [0, 1]
    )
    return [PolynomialShape(series=static), *_held_modes(count, moment)][:count]


def _held_modes(count: int, moment: bool) -> list[PolynomialShape]:
    if count < 2:
        return []
    legendre = [Legendre.basis(j, domain=[0, 1]) for j in range(count + 2 if moment else count + 3)]
    ends = [[p(0.0), p.deriv(1)(0.0), p(1.0), p.deriv(2)(1.0)] for p in legendre]
    conditions = np.array(ends).T[: 3 if moment else 4]  # clamp at 0, held and (without moment) no curvature at 1
    rows = np.linalg.svd(conditions / np.linalg.norm(conditions, axis=1, keepdims=True))[2]
    space = rows[len(conditions) :].T  # what satisfies all conditions
    zeta, weight = gauss_unit()
    value = space.T @ np.array([p(zeta) for p in legendre])
    curvature = space.T @ np.array([p.deriv(2)(zeta) if p.degree() > 1 else 0.0 * zeta for p in legendre])
    vectors = eigh((curvature * weight) @ curvature.T, (value * weight) @ value.T)[1]
    coefficients = (space @ vectors).T
    shapes = [Legendre(c, domain=[0, 1]) for c in coefficients]
    return [PolynomialShape(series=p * np.sign(p.deriv(2)(0.0))) for p in shapes]
