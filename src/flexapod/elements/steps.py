"""Shapes of a stepped beam: its deflections under the loads that give a uniform one those of a basis, (T1.19)-(T1.21).

Plain arithmetic, for numbers and for symbols alike. Places x = 1 - zeta = xi / s run from the tip to the mouth, pieces
between cuts likewise; values at a place are columns, a row for each shape.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.polynomial import Chebyshev

from flexapod.bases import LateralBasis
from flexapod.typing import Array

__all__ = ["Piece", "Sheared", "Uniform", "held", "pieces", "sheared"]


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
class Piece:
    """Between two cuts, from `start` to `end`: M = m0 + m1 d + load g'', d = x - start, in `give` the curvature.

    The deflection is give load g + p0 + p1 d + p2 d^2 + p3 d^3.
    """

    uniform: Uniform
    start: Any
    end: Any
    load: Any
    give: Any
    m0: Any
    m1: Any
    p0: Any
    p1: Any

    @property
    def cubic(self) -> tuple[Any, Any, Any, Any]:
        """p0 to p3."""
        return self.p0, self.p1, self.give * self.m0 / 2, self.give * self.m1 / 6

    def moment(self, x: Any) -> Any:
        """Bending moment M = v'' / give of every shape."""
        return self.m0 + self.m1 * (x - self.start) + self.load * self.uniform.at(x, 2)

    def shear(self, x: Any) -> Any:
        """dM/dx."""
        return self.m1 + self.load * self.uniform.at(x, 3)

    def value(self, x: Any, derivative: int = 0) -> Any:
        """Deflection of every shape, or its first derivative by x."""
        d, (p0, p1, p2, p3) = x - self.start, self.cubic
        bent = self.give * self.load * self.uniform.at(x, derivative)
        return bent + (p1 + d * (2 * p2 + 3 * p3 * d) if derivative else p0 + d * (p1 + d * (p2 + p3 * d)))


def pieces(uniform: Uniform, places: Sequence[Any], loads: Sequence[Any], gives: Sequence[Any]) -> list[Piece]:
    """Pieces from tip to mouth.

    Parameters
    ----------
    uniform : Uniform
    places : sequence
        Ends of the pieces: 0, the cuts, 1.
    loads, gives : sequence
        Mass per length and 1 / EI of each, relative to any values of them.
    """
    found: list[dict[str, Any]] = []
    M, S = uniform.at(0.0, 2), uniform.at(0.0, 3)
    for start, end, load, give in zip(places[:-1], places[1:], loads, gives, strict=True):
        m0, m1 = M - load * uniform.at(start, 2), S - load * uniform.at(start, 3)  # (T1.20)
        M = m0 + m1 * (end - start) + load * uniform.at(end, 2)
        S = m1 + load * uniform.at(end, 3)
        found.append({"start": start, "end": end, "load": load, "give": give, "m0": m0, "m1": m1})
    value = slope = 0 * M
    done: list[Piece] = []
    for piece in reversed(found):  # the mouth holds place and slope
        loose = Piece(uniform=uniform, **piece, p0=0.0, p1=0.0)
        d = piece["end"] - piece["start"]
        p1 = slope - loose.value(piece["end"], 1)
        p0 = value - loose.value(piece["end"]) - p1 * d
        done.append(Piece(uniform=uniform, **piece, p0=p0, p1=p1))
        value, slope = done[-1].value(piece["start"]), done[-1].value(piece["start"], 1)
    return done[::-1]


@dataclass(frozen=True, kw_only=True)
class Sheared:
    """Deflection by shear between two cuts, of what has the forces of a `Piece`: soft (M - m0) + q0, Eq. (T1.23)."""

    piece: Piece
    soft: Any
    q0: Any

    def value(self, x: Any) -> Any:
        """Deflection of every shape."""
        return self.soft * (self.piece.moment(x) - self.piece.m0) + self.q0

    def slope(self, x: Any) -> Any:
        """Its derivative by x."""
        return self.soft * self.piece.shear(x)


def sheared(bent: Sequence[Piece], softs: Sequence[Any]) -> list[Sheared]:
    """Shear of pieces from tip to mouth; `softs`: 1 / (kappa G A) of each, relative to any value."""
    done: list[Sheared] = []
    value: Any = 0.0
    for piece, soft in zip(reversed(bent), reversed(softs), strict=True):
        loose = Sheared(piece=piece, soft=soft, q0=0.0)
        done.append(Sheared(piece=piece, soft=soft, q0=value - loose.value(piece.end)))
        value = done[-1].value(piece.start)
    return done[::-1]


def held(tip: Any) -> Any:
    """Column E: of v - E v_1 the first is 1 at the tip and all others 0, Eq. (T1.22); from the values at the tip."""
    return (tip - np.eye(tip.shape[0], 1)) / tip[0]
