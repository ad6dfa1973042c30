"""Kinked shape that a force in the middle of a beam adds to a basis: its curvature has a kink there.

The force acts at u = eta. Its deflection, less what the shapes hold of it, is tau(u) - share^T phi(u) with the
truncated cubic tau = (u - eta)_+^3 / 6; over (eta (1 - eta))^2 it is the further shape sigma, Eq. (T25.19).
Integrals over the beam are polynomials of eta, Eq. (T25.20), found from their values at Chebyshev points.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.polynomial import Polynomial, chebyshev

from flexapod.common.arrays import Array
from flexapod.mechanics.shapes import LateralBasis
from flexapod.mechanics.shapes.beam_functions import gauss_unit

Powers = list[float]  # coefficients of a polynomial of 2 eta - 1, ascending

LEAST = 1e-3  # the kink stays this far from either end, as a share of the beam: there its shape is among the others
_WITHIN = 0.6  # of 2 eta - 1: where integrals are found; nearer to the ends digits cancel
_LOST = 1e-12  # what rounding leaves of coefficients that are not there


def polynomials(basis: LateralBasis) -> list[Polynomial]:
    """Shapes of a basis of polynomials in powers of u."""
    found = [shape.series.convert(kind=Polynomial) for shape in basis.shapes]  # type: ignore[attr-defined]
    return [Polynomial(np.where(np.abs(p.coef) < 1e-12 * np.abs(p.coef).max(), 0.0, p.coef)) for p in found]


@lru_cache(maxsize=16)
def kink(basis: LateralBasis) -> dict[str, list[Powers]]:
    """Kinked shape of a polynomial basis, orthogonal in bending energy, with the tip's static shapes.

    Returns
    -------
    dict of lists of polynomials of 2 eta - 1
        ``share``: of each shape in the deflection under a unit force (EI = length = 1); ``seat``: sigma at the force;
        ``stiffness``: int sigma''^2 times eta (1 - eta). ``first``, ``moment``: int sigma, int u sigma; ``own``: int
        sigma phi for each shape, and last int sigma^2; of the rate of sigma by eta ``slid_first``, ``slid_moment``,
        ``slid`` (with phi, last with sigma) and ``slid_slid``. ``turn_...``: of slopes. ``slope_first``,
        ``slope_moment``: ``turn_own`` by the weights 1 - u and (1 - u^2) / 2, as of a basis.
    """
    sizes = {name: len(row) for name, row in _integrals(basis, 0.5).items()}
    degree = 2 * basis.count + 2  # above those of all
    points = np.asarray(chebyshev.chebpts1(degree + 1))
    values = [np.concatenate([*_integrals(basis, (1 + _WITHIN * x) / 2).values()]) for x in points.tolist()]
    series = np.linalg.solve(chebyshev.chebvander(points, degree), np.array(values))
    rows = iter(series.T)
    return {name: [_powers(next(rows)) for _ in range(size)] for name, size in sizes.items()}


def _powers(series: Array) -> Powers:
    found = chebyshev.cheb2poly(np.where(np.abs(series) < _LOST, 0.0, series))
    return [float(c) for c in np.trim_zeros(found / _WITHIN ** np.arange(found.size), "b")]


def _integrals(basis: LateralBasis, eta: float) -> dict[str, Array]:
    """Values at one eta, by Gauss points on either side of it."""
    x, w = gauss_unit(24)
    u, w = np.concatenate([eta * x, eta + (1 - eta) * x]), np.concatenate([eta * w, (1 - eta) * w])
    K, at = np.diag(basis.stiffness), np.array([eta])
    slope = basis.values(at, 1)[:, 0]
    share = (basis.values(at)[:, 0] - basis.tip + (1 - eta) * basis.tip_slope) / K
    rate, past = (slope - basis.tip_slope) / K, np.maximum(u - eta, 0.0)
    scale = (eta * (1 - eta)) ** -2
    growth = -2 * (1 - 2 * eta) / (eta * (1 - eta))  # of the scale
    soft = (1 - eta) ** 3 / 3 - K @ share**2
    found = {"share": share, "seat": [scale * soft], "stiffness": [scale**2 * soft * eta * (1 - eta)]}
    for name, order, cubic, slid in (("", 0, past**3 / 6, -(past**2) / 2), ("turn_", 1, past**2 / 2, -past)):
        shapes = basis.values(u, order)
        sigma = scale * (cubic - share @ shapes)
        sigma_slid = scale * (slid - rate @ shapes) + growth * sigma
        rows = np.vstack([shapes, sigma])
        found |= {
            f"{name}first": [w @ sigma],
            f"{name}moment": [w @ (u * sigma)],
            f"{name}slid_first": [w @ sigma_slid],
            f"{name}slid_moment": [w @ (u * sigma_slid)],
            f"{name}own": rows @ (w * sigma),
            f"{name}slid": rows @ (w * sigma_slid),
            f"{name}slid_slid": [w @ sigma_slid**2 * (eta * (1 - eta)) ** order],  # of slopes with a layer at the ends
        }
    return {name: np.asarray(row) for name, row in found.items()} | {
        "slope_first": rows @ (w * (1 - u) * sigma),
        "slope_moment": rows @ (w * (1 - u**2) / 2 * sigma),
    }
