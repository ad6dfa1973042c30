"""Shapes of a stepped beam: its deflections under the loads that give a uniform one those of a basis, (T1.19)-(T1.21).

Plain arithmetic, for numbers and for symbols alike. Places x = 1 - zeta = xi / s run from the tip to the mouth, pieces
between cuts likewise; values at a place are columns, a row for each shape. Pieces are known at Gauss points: integrals
from point to point are sums, exact for polynomials and of tapers as good as the points (T1.24).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.polynomial import Chebyshev, Legendre

from flexapod.common.arrays import Array
from flexapod.mechanics.shapes import LateralBasis
from flexapod.mechanics.shapes.beam_functions import gauss_unit


@dataclass(frozen=True, kw_only=True)
class Uniform:
    """Shapes of a uniform beam over x, and their derivatives, as Chebyshev series on [0, 1]."""

    basis: LateralBasis

    @cached_property
    def series(self) -> tuple[Array, ...]:
        """Coefficients of the shapes and of their first three derivatives, (4) of (k, any)."""
        found = [
            Chebyshev.interpolate(lambda x, phi=phi: phi(1.0 - x), phi.series.degree(), domain=[0, 1])  # type: ignore[attr-defined]
            for phi in self.basis.shapes
        ]
        return tuple(_rows([p.deriv(n) if n else p for p in found]) for n in range(4))

    def at(self, x: Any, derivative: int) -> Any:
        """Derivative of every shape by x."""
        series, u = self.series[derivative], 2 * x - 1
        terms = [1.0, u]
        while len(terms) < series.shape[1]:
            terms.append(2 * u * terms[-1] - terms[-2])
        return sum(series[:, n : n + 1] * terms[n] for n in range(series.shape[1]))


def _rows(series: Sequence[Chebyshev]) -> Array:
    width = max(p.coef.size for p in series)
    return np.array([np.pad(p.coef, (0, width - p.coef.size)) for p in series], dtype=float)


@dataclass(frozen=True, kw_only=True)
class StepNodes:
    """Gauss points on [0, 1] and integrals of what is known there; `beyond[n]`: weights of that from point n to 1."""

    t: Array
    w: Array
    beyond: Array
    legendre: Array

    def integral(self, f: Sequence[Any]) -> Any:
        """Integral from 0 to 1 of values at the nodes."""
        return sum(w * y for w, y in zip(self.w.tolist(), f, strict=True))

    def rest(self, f: Sequence[Any]) -> list[Any]:
        """Integrals from each point to 1."""
        return [sum(w * y for w, y in zip(row, f, strict=True)) for row in self.beyond.tolist()]

    def parabola(self, long: Any, f: Sequence[Any], value: Any, slope: Any) -> list[Any]:
        """Values at the points, and at 0, of what has a second derivative f on a length; value and slope at its end."""
        twice = np.vstack([self.beyond @ self.beyond, self.w @ self.beyond]).tolist()
        return [
            value - long * ((1 - t) * slope - long * sum(b * y for b, y in zip(row, f, strict=True)))
            for t, row in zip([*self.t.tolist(), 0.0], twice, strict=True)
        ]

    def interpolate(self, f: Sequence[Any], t: Any) -> Any:
        """Value at any place of the polynomial through the points."""
        terms = [1.0 + 0 * t, 2 * t - 1]
        for n in range(2, self.t.size):
            terms.append(((2 * n - 1) * (2 * t - 1) * terms[-1] - (n - 1) * terms[-2]) / n)
        rows = [sum(w * y for w, y in zip(row, f, strict=True)) for row in self.legendre.tolist()]
        return sum(c * x for c, x in zip(rows, terms, strict=False))


@cache
def nodes(count: int) -> StepNodes:
    """Nodes and weights of ``count`` Gauss points on [0, 1]."""
    t, w = gauss_unit(count)
    legendre = np.array([(2 * n + 1) * Legendre.basis(n)(2 * t - 1) * w for n in range(count)])
    rest = np.array([Legendre.basis(n).integ(lbnd=1.0)(2 * t - 1) / -2 for n in range(count)])
    return StepNodes(t=t, w=w, beyond=rest.T @ legendre, legendre=legendre)


def law(coefficients: Sequence[Any], offset: Any) -> Any:
    """Value on a section at a distance from its end at the tip; powers of this ascending."""
    total = coefficients[-1]
    for c in coefficients[-2::-1]:
        total = total * offset + c
    return total


@dataclass(frozen=True, kw_only=True)
class Piece:
    """Piece between two cuts, from `start` to `end`: columns at its nodes, at the places `x`, and at its start.

    `values`: deflections; `slopes`, `bends`: their derivatives by x; `shears`: dM/dx; of what shears `bends` are none.
    """

    nodes: StepNodes
    start: Any
    end: Any
    x: list[Any]
    values: list[Any]
    slopes: list[Any]
    bends: list[Any]
    shears: list[Any]
    value_start: Any
    slope_start: Any

    def value(self, x: Any, derivative: int = 0) -> Any:
        """Deflection of every shape at numbers x, or a derivative by x."""
        long = self.end - self.start
        t = (x - self.start) / np.where(long > 0, long, 1.0)
        return self.nodes.interpolate((self.values, self.slopes, self.bends)[derivative], t)


def pieces(
    uniform: Uniform, at: StepNodes, places: Sequence[Any], loads: Sequence[Any], gives: Sequence[Sequence[Any]]
) -> list[Piece]:
    """Pieces from tip to mouth.

    Parameters
    ----------
    uniform : Uniform
    at : StepNodes
        Of every piece.
    places : sequence
        Ends of the pieces: 0, the cuts, 1.
    loads : sequence
        Mass per length of each, relative to any value of it.
    gives : sequence
        1 / EI of each at its nodes, likewise.
    """
    bends, shears = [], []
    M, S = uniform.at(0.0, 2), uniform.at(0.0, 3)
    for start, end, load, give in zip(places[:-1], places[1:], loads, gives, strict=True):
        m0, m1 = M - load * uniform.at(start, 2), S - load * uniform.at(start, 3)  # (T1.20)
        x = _places(at, start, end)
        bends.append([c * (m0 + m1 * (u - start) + load * uniform.at(u, 2)) for u, c in zip(x, give, strict=True)])
        shears.append([m1 + load * uniform.at(u, 3) for u in x])
        M = m0 + m1 * (end - start) + load * uniform.at(end, 2)
        S = m1 + load * uniform.at(end, 3)
    return pieces_of(at, places, shears, bends)


def shear_pieces(bent: Sequence[Piece], softs: Sequence[Sequence[Any]]) -> list[Piece]:
    """Shear of what has the forces of pieces from tip to mouth, Eq. (T1.23).

    ``softs``: 1 / (kappa G A) of each at its nodes, relative to any value.
    """
    places = [*(piece.start for piece in bent), bent[-1].end]
    slopes = [[c * y for c, y in zip(soft, one.shears, strict=True)] for one, soft in zip(bent, softs, strict=True)]
    return pieces_of(bent[0].nodes, places, [one.shears for one in bent], None, slopes)


def _places(at: StepNodes, start: Any, end: Any) -> list[Any]:
    return [start + (end - start) * t for t in at.t.tolist()]


def piece_nodes(at: StepNodes, places: Sequence[Any]) -> list[list[Any]]:
    """Places of the nodes of every piece between ends."""
    return [_places(at, start, end) for start, end in pairwise(places)]


def pieces_of(
    at: StepNodes, places: Sequence[Any], shears: list[Any], bends: list[Any] | None, slopes: list[Any] | None = None
) -> list[Piece]:
    """Pieces of given curvatures, or slopes: the mouth holds place and slope."""
    value = slope = 0.0 * shears[0][0]
    done: list[Piece] = []
    for j in reversed(range(len(shears))):
        start, end = places[j], places[j + 1]
        long = end - start
        bend = [0.0 * y for y in shears[j]] if bends is None else bends[j]
        turned = [slope - long * y for y in at.rest(bend)] if slopes is None else slopes[j]
        slope = slope - long * at.integral(bend)
        values = [value - long * y for y in at.rest(turned)]
        value = value - long * at.integral(turned)
        one = Piece(
            nodes=at,
            start=start,
            end=end,
            x=_places(at, start, end),
            values=values,
            slopes=turned,
            bends=bend,
            shears=shears[j],
            value_start=value,
            slope_start=slope,
        )
        done.append(one)
    return done[::-1]


def tip_elimination(tip: Any) -> Any:
    """Column E: of v - E v_1 the first is 1 at the tip and all others 0, Eq. (T1.22); from the values at the tip."""
    return (tip - np.eye(tip.shape[0], 1)) / tip[0]
