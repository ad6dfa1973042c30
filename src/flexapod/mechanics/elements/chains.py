"""Shapes of a stepped beam whose loads are by deflections of earlier ones, Eqs. (T1.25)-(T1.27); as `steps`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np

from flexapod.mechanics.elements.steps import Piece, StepNodes, nodes, piece_nodes, pieces_of
from flexapod.mechanics.shapes import LateralBasis

_FROM = 5  # loads: a uniform mass, one that rises, those of three deflections; with fewer all go to frequencies
_KINK = 30.0  # of the thrust's load over that of a second degree, which takes its place where the beam is uniform

Rows = list[list[Any]]  # values of one shape: of each piece, at its nodes


def is_chain(basis: LateralBasis) -> bool:
    """Test whether a basis has enough shapes for loads by deflections of earlier ones."""
    return basis.count - 1 - _moment(basis) >= _FROM


def _moment(basis: LateralBasis) -> bool:
    """Test whether shapes of a basis take a moment at the tip, Eq. (T1.18)."""
    return any(abs(phi(np.ones(1), 2)[0]) > 1e-6 for phi in basis.shapes)


def chain(
    basis: LateralBasis, at: StepNodes, places: Sequence[Any], loads: Rows, gives: Rows, hub: Any
) -> list[Piece]:  # fmt: skip
    """Pieces from tip to mouth; arguments as `steps.pieces`, but the loads at the nodes.

    ``hub``: length of the leg inside of the mouth over that outside.
    """
    moment = _moment(basis)
    members = _orthogonal(at, places, gives, _members(basis.count, moment, at, places, loads, gives, hub))
    size = _sizes(basis.count, moment)
    moments, shears = (
        [[sum(size[:, n : n + 1] * one[j][i] for n, one in enumerate(rows)) for i in range(at.t.size)]
         for j in range(len(loads))]
        for rows in zip(*members, strict=True)
    )  # fmt: skip
    return pieces_of(at, places, shears, _each(lambda c, m: c * m, gives, moments))


def _members(
    count: int, moment: bool, at: StepNodes, places: Sequence[Any], loads: Rows, gives: Rows, hub: Any
) -> list[tuple[Rows, Rows]]:  # fmt: skip
    """Moments and shear forces under a tip force (a tip moment), and under the loads, that of a thrust last."""
    x = piece_nodes(at, places)
    ones = _each(lambda u: 1.0 + 0.0 * u, x)
    found = [(x, ones)]
    if moment:
        found.append((ones, _each(lambda u: 0.0 * u, x)))

    def bent(moments: Rows) -> tuple[Rows, Any]:
        return _deflected(at, places, _each(lambda c, m: c * m, gives, moments))

    def by_mass(of: Rows) -> Rows:
        """Moments where the load is the mass times this."""
        found.append(_carried(at, places, _each(lambda m, f: m * f, loads, of)))
        return found[-1][0]

    first = bent(x)
    under, rising = by_mass(ones), by_mass(x)
    by_mass(first[0])  # (T1.25)
    by_mass(bent(under)[0])
    more = count - 1 - len(found)
    if more:
        by_mass(bent(rising)[0])
    for degree in range(6, 5 + more):
        by_mass(_each(lambda u, n=degree: np.polynomial.Legendre.basis(n)(2 * u - 1), x))
    held = _pinned(x, hub, *bent(_pinned(x, hub, *first)))  # (T1.26)
    c0, m0 = gives[0][0], loads[0][0]
    load = _each(
        lambda c, m, w, u: _KINK * (c / c0 - m / m0) * w + m / m0 * (6 * u * (u - 1) + 1), gives, loads, held, x
    )
    return [*found, _carried(at, places, load)]  # (T1.27)


def _orthogonal(
    at: StepNodes, places: Sequence[Any], gives: Rows, members: list[tuple[Rows, Rows]]
) -> list[tuple[Rows, Rows]]:  # fmt: skip
    """Shapes made orthogonal in bending energy to those before them."""
    done: list[tuple[Rows, Rows, Rows, Any]] = []
    for moments, shears in members:
        for M, S, bends, energy in done:
            share = _energy(at, places, moments, bends) / energy
            moments, shears = (_each(lambda a, b, c=share: a - c * b, x, y) for x, y in ((moments, M), (shears, S)))
        bends = _each(lambda c, m: c * m, gives, moments)
        done.append((moments, shears, bends, _energy(at, places, moments, bends)))
    return [(moments, shears) for moments, shears, _, _ in done]


def _energy(at: StepNodes, places: Sequence[Any], moments: Rows, bends: Rows) -> Any:
    works = [at.integral(row) for row in _each(lambda a, b: a * b, moments, bends)]
    return sum((end - start) * work for (start, end), work in zip(pairwise(places), works, strict=True))


def _each(of: Callable[..., Any], *rows: Rows) -> Rows:
    return [[of(*values) for values in zip(*piece, strict=True)] for piece in zip(*rows, strict=True)]


def _carried(at: StepNodes, places: Sequence[Any], load: Rows) -> tuple[Rows, Rows]:
    """Moments and shear forces of a beam that bears a load and is free at the tip."""
    moments, shears, M, S = [], [], 0.0, 0.0
    for (start, end), f in zip(pairwise(places), load, strict=True):
        long = end - start
        S = S + long * at.integral(f)
        from_end = at.parabola(long, f, 0.0, S)
        M = M - from_end[-1]
        moments.append([M + y for y in from_end[:-1]])
        shears.append([S - long * y for y in at.rest(f)])
    return moments, shears


def _deflected(at: StepNodes, places: Sequence[Any], bends: Rows) -> tuple[Rows, Any]:
    """Deflections of the beam, and deflection of its tip."""
    rows: Rows = []
    value = slope = 0.0 * bends[0][0]
    for (start, end), bend in reversed(list(zip(pairwise(places), bends, strict=True))):
        long = end - start
        *row, value = at.parabola(long, bend, value, slope)
        rows.append(row)
        slope = slope - long * at.integral(bend)
    return rows[::-1], value


def _pinned(x: Rows, hub: Any, values: Rows, tip: Any) -> Rows:
    """Deflections of a leg that turns about its base joint until its tip is where it was, over that of the joint."""
    return _each(lambda u, v: (hub + 1 - u) / (hub + 1) - v / tip, x, values)


@cache
def _sizes(count: int, moment: bool) -> np.ndarray:
    """Factors of the shapes, on a diagonal: norm 1 in mass of a uniform beam; a tenth of the last."""
    at, places, one = nodes(count + 3), [0.0, 1.0], [[1.0] * (count + 3)]
    found = _orthogonal(at, places, one, _members(count, moment, at, places, one, one, 0.0))
    values = np.array([pieces_of(at, places, M, M)[0].values for M, _ in found])
    return np.diag(np.r_[np.ones(count - 1), 0.1] / np.sqrt(values**2 @ at.w))
