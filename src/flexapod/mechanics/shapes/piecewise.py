"""Polynomial and piecewise shapes on the free length, clamped at the mouth, Eqs. (T1.13)-(T1.15).

Hermite cubics are beam elements of equal length, Eq. (T1.15); piecewise-linear shapes are rigid segments with
hinge springs, Eqs. (T1.13)-(T1.14). Polynomials of the ``tip-load`` basis are the static shape under a tip
force and modes with the tip held.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import Legendre, Polynomial

from flexapod.common.arrays import Array
from flexapod.mechanics.shapes.beam_functions import eigh, gauss_unit

#: Displacement, and slope times element length, of an element's right and left node in u in [0, 1].
RISING = (Polynomial([0.0, 0.0, 3.0, -2.0]), Polynomial([0.0, 0.0, -1.0, 1.0]))
FALLING = (Polynomial([1.0, 0.0, -3.0, 2.0]), Polynomial([0.0, 1.0, -2.0, 1.0]))


@dataclass(frozen=True, kw_only=True)
class HermiteShape:
    """Displacement (``order`` 0) or slope times element length (1) of one at ``node`` of ``elements``, Eq. (T1.15)."""

    node: int
    elements: int
    order: int

    def __call__(self, zeta: Array, derivative: int = 0) -> Array:
        """Value (or ``derivative``-th derivative in zeta) at ``zeta`` (any shape), dimensionless."""
        u = np.asarray(zeta, dtype=float) * self.elements
        element = np.clip(np.floor(u), 0, self.elements - 1)
        left, right = (
            np.where(element == self.node + shift, part[self.order].deriv(derivative)(u - element), 0.0)
            for shift, part in ((-1, RISING), (0, FALLING))
        )
        return self.elements**derivative * (left + right)


def hermite_shapes(count: int) -> list[HermiteShape]:
    """Two shapes for each of ``count / 2`` elements: displacement and slope of their outer nodes; the tip is free.

    Raises
    ------
    ValueError
        Odd count (the study file is checked before).
    """
    if count % 2:
        raise ValueError(f"{count} shapes are not a whole number of beam elements: each has two")
    elements = count // 2
    return [HermiteShape(node=i, elements=elements, order=d) for i in range(1, elements + 1) for d in (0, 1)]


@dataclass(frozen=True, kw_only=True)
class SegmentShape:
    """One at node ``node`` and zero at the others: ``count`` hinges at (j - 1/2)/count, and the tip, Eq. (T1.13)."""

    node: int
    count: int

    @cached_property
    def _knots(self) -> Array:
        hinges = (np.arange(self.count) + 0.5) / self.count
        return np.concatenate([[0.0], hinges, [1.0]])

    @cached_property
    def _values(self) -> Array:
        return np.eye(self.count + 2)[self.node + 2]  # the first hinge and the clamp stay at zero

    @cached_property
    def _slopes(self) -> Array:
        return np.diff(self._values) / np.diff(self._knots)

    def __call__(self, zeta: Array, derivative: int = 0) -> Array:
        """Value, slope or curvature at ``zeta`` (any shape), dimensionless; no higher derivatives.

        The curvature is the turn of a hinge spread over the segment of length 1/count around it, Eq. (T1.14): its
        square integrates to the hinges' energy, and times EI it is the moment of their springs.
        """
        z = np.asarray(zeta, dtype=float)
        if derivative == 0:
            return np.interp(z, self._knots, self._values)
        if derivative == 1:
            return self._slopes[np.clip(np.searchsorted(self._knots, z, side="right") - 1, 0, self.count)]
        if derivative == 2:
            return self.count * np.diff(self._slopes)[np.clip((z * self.count).astype(int), 0, self.count - 1)]
        return np.zeros_like(z)


def segment_shapes(count: int) -> list[SegmentShape]:
    """The ``count`` shapes of ``count`` equal segments between the hinges, half a one at the mouth and at the tip."""
    return [SegmentShape(node=j, count=count) for j in range(count)]


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
