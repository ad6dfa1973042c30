"""Named lateral bases, and load-dependent shapes of the ``tip-load`` basis, Eq. (T1.16).

Each basis is one line; all pass the same contract test. Shapes depend on the load where a body turns at the tip
or the beam turns.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.polynomial import Legendre

from flexapod.common.arrays import Array
from flexapod.mechanics.shapes.beam_functions import clamped_free, clamped_tip_mass, gauss_unit
from flexapod.mechanics.shapes.lateral import LateralBasis, integrate
from flexapod.mechanics.shapes.piecewise import PolynomialShape, hermite_shapes, segment_shapes, tip_load_shapes

DEGREE = 45  # resolves the layer at the root of a beam with hub radius 5 L that turns at g = 50 to rounding


def load_shapes(
    count: int, *, speed: float = 0.0, hub_ratio: float = 0.0, mass_ratio: float = 0.0, moment: bool = False
) -> list[PolynomialShape]:
    """Static shape under a tip force (with ``moment`` also under a tip moment), then those under their inertia.

    Every further shape is the static one under the inertia load of an earlier one (load-dependent Ritz vectors, Wilson,
    Yuan & Dickens 1982). They resolve the layer that tension makes at the root. What they span is returned in shapes
    orthogonal in mass and stiffness, of norm int phi^2 dzeta = 1, positive curvature at the clamp, stiffest last.

    Parameters
    ----------
    count : int
    speed : float
        Speed of rotation g = theta_dot sqrt(rhoA L^4 / EI), dimensionless: its tension stiffens the beam.
    hub_ratio, mass_ratio : float
        R_h / L and m / (rhoA L), in the tension.
    moment : bool
        Whether the tip body has rotary inertia and so takes a moment.
    """
    from scipy.linalg import eigh, solve  # slow to import, and the default basis of robots needs neither

    polynomials = [Legendre.basis(j, domain=[0, 1]).integ(2, lbnd=0) for j in range(DEGREE - 1)]  # clamped at 0
    zeta, weight = gauss_unit()
    value, slope, curvature = (np.array([p.deriv(n)(zeta) if n else p(zeta) for p in polynomials]) for n in range(3))
    tension = speed**2 * (hub_ratio * (1 - zeta) + 0.5 * (1 - zeta**2) + mass_ratio * (1 + hub_ratio))
    stiffness = (curvature * weight) @ curvature.T + (slope * weight * tension) @ slope.T
    mass = (value * weight) @ value.T
    loads = [np.array([p(1.0) for p in polynomials])]
    if moment:
        loads.append(np.array([p.deriv(1)(1.0) for p in polynomials]))
    shapes: list[Array] = []
    while len(shapes) < count:
        shapes.append(_orthogonal(solve(stiffness, loads.pop(0), assume_a="pos"), shapes, stiffness))
        loads.append(mass @ shapes[-1])
    span = np.array(shapes).reshape(count, len(polynomials)).T
    vectors = span @ eigh(span.T @ stiffness @ span, span.T @ mass @ span)[1] if count else span
    found = [Legendre(row, domain=[0, 1]) for row in vectors.T @ _coefficients(polynomials)]
    return [PolynomialShape(series=shape * np.sign(shape.deriv(2)(0.0))) for shape in found]


def _orthogonal(shape: Array, others: list[Array], stiffness: Array) -> Array:
    """Part of `shape` orthogonal to `others`, of unit energy; twice, as once leaves rounding behind."""
    for _ in range(2):
        for other in others:
            shape = shape - other * (other @ stiffness @ shape)
    return shape / np.sqrt(shape @ stiffness @ shape)


def _coefficients(polynomials: list[Legendre]) -> Array:
    width = len(polynomials[-1].coef)
    return np.array([[*p.coef, *[0.0] * (width - len(p.coef))] for p in polynomials])


@lru_cache(maxsize=64)
def lateral_basis(
    name: str,
    count: int,
    tip_mass_ratio: float = 0.0,
    tip_inertia_ratio: float = 0.0,
    speed: float = 0.0,
    hub_ratio: float = 0.0,
    moment: bool = False,
) -> LateralBasis:
    """Lateral basis ``name`` with ``count`` shapes.

    Parameters
    ----------
    name : {"clamped-free", "tip-load", "tip-mass", "segments", "hermite"}
    count : int
        Shapes per plane, 0 to 12 (``hermite`` 24); of ``segments`` one per segment, of ``hermite`` two per element.
    tip_mass_ratio, tip_inertia_ratio : float
        m/(rhoA s) and J/(rhoA s^3) of the tip body, dimensionless, in the ``tip-mass`` eigenfunctions; ``tip-load``
        asks whether J is positive (the tip takes a moment) and, where the beam turns, for the tension by m.
    speed, hub_ratio : float
        theta_dot sqrt(rhoA s^4 / EI) and R_h/s of a beam in steady rotation, in ``tip-load`` shapes only.

    moment : bool
        The tip takes a moment from a joint: ``tip-load`` then spans the static shape under a tip moment too.

    Raises
    ------
    ValueError
        Unknown name or an odd number of ``hermite`` shapes (the study file is checked before).
    """
    if name == "clamped-free":
        return integrate(name, clamped_free(count))
    if name == "tip-load" and (speed or tip_inertia_ratio):
        turning = load_shapes(
            count, speed=speed, hub_ratio=hub_ratio, mass_ratio=tip_mass_ratio, moment=tip_inertia_ratio > 0
        )
        return integrate(name, turning)
    if name == "tip-load":
        return integrate(name, tip_load_shapes(count, moment=moment))
    if name == "tip-mass":
        return integrate(name, clamped_tip_mass(count, tip_mass_ratio, tip_inertia_ratio))
    if name == "segments":
        return integrate(name, segment_shapes(count), pieces=2 * count)
    if name == "hermite":
        return integrate(name, hermite_shapes(count), pieces=count // 2)
    raise ValueError(f"unknown basis {name!r}: choose clamped-free, tip-load, tip-mass, segments or hermite")
