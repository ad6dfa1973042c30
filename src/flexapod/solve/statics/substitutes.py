"""What stands for held pivots, chosen once, at home, so that motions keep their meaning over poses, Eq. (T7.28)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.ranking import EQUALS, alike, first_largest
from flexapod.solve.batch import RestStates, matrices_at_rest
from flexapod.solve.statics.elimination import LegBases, closed, leg_bases
from flexapod.solve.statics.reduction import border_rows, flat_columns
from flexapod.solve.system import Index, System

__all__ = ["with_substitutes"]

YIELDS = 0.01  # what a shape must move a held pivot by, for what the payload does, to stand for it
DEPENDENT = 1e-9  # share of a row that others leave of it: less is rounding


def with_substitutes(system: System, home: RestStates) -> System:
    """The same system with what stands for its held pivots, as its one state at home suggests it.

    First the shapes of each leg for its own pivots; for the rows of legs that cannot give way other shapes, then steps
    of the payload. Among equals the first: legs that are alike choose alike.
    """
    n, found = system.n, np.full(system.held.shape, -1, dtype=np.intp)
    bases = leg_bases(system, matrices_at_rest(system, home, np.zeros(system.load_size)))
    for b in bases:
        by = _shapes(b)
        if by is not None:
            found[b.legs[:, None], b.border] = b.legs[:, None] * n + by
    chosen = replace(system, substitutes=found)
    left = closed(chosen, bases)
    legs, pivots = (np.concatenate(x) for x in zip(*map(_rows, left), strict=True))
    if legs.size:
        columns = flat_columns(system, left)
        found[legs, pivots] = np.append(columns, -1)[_of_all(border_rows(left)[0], columns.size - system.border.size)]
    return replace(system, substitutes=found)


def _rows(b: LegBases) -> tuple[Index, Index]:
    """Leg and held pivot of each row that a group keeps."""
    return np.repeat(b.legs, b.border.size), np.tile(b.border, b.legs.size)


def _shapes(b: LegBases) -> Index | None:
    """Coordinates (g, h) of legs that stand for their held pivots; None where a leg has none that moves one enough."""
    left, Y = b.N[0][:, b.border], b.Y[0][:, b.border]
    if left.shape[-1] < left.shape[-2]:
        return None
    size = np.maximum(np.abs(left).max(axis=-1, initial=0.0), np.abs(Y).max(axis=-1, initial=0.0))
    chosen, each = np.zeros(left.shape[:-1], dtype=np.intp), np.arange(len(left))
    for k in range(left.shape[-2]):
        column = alike(np.abs(left[:, k]), axis=-1, same=EQUALS).argmax(axis=-1)
        pivot = left[each, k, column]
        if not (np.abs(pivot) > YIELDS * size[:, k]).all():
            return None
        chosen[:, k] = b.rest[each, column]
        left[:, k + 1 :] -= (left[each, k + 1 :, column] / pivot[:, None])[..., None] * left[:, k, None]
    return chosen


def _of_all(G: Array, shapes: int) -> Index:
    """Column of each row (rows, r) of the border, the first ``shapes`` of them of legs; -1 of rows that depend."""
    size = np.linalg.norm(G, axis=1, keepdims=True)
    left, found = G / np.where(size > 0, size, 1.0), np.full(len(G), -1, dtype=np.intp)  # one that nothing moves: zero
    for width, least in ((shapes, YIELDS), (G.shape[1], DEPENDENT)):
        while width and np.abs(left[:, :width]).max() > least:
            row, column = divmod(first_largest(np.abs(left[:, :width]).ravel(), EQUALS), width)
            found[row] = column
            left -= np.outer(left[:, column] / left[row, column], left[row])
            left[row] = 0.0
    return found
