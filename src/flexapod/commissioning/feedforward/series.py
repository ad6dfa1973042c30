"""A function of time that takes long to compute, as Chebyshev series between its knots, Eq. (T22.3)."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.chebyshev import chebder, chebval, chebvander

from flexapod.common.arrays import Array
from flexapod.kinematics import Law

__all__ = ["CorrectionSeries", "series_of"]

NODES = 17  # of a piece, ends included: neighbours meet there
LAST = 3  # coefficients that say what is left out
FINEST = 1 / 64  # of the whole time: the shortest piece
_NODES = -np.cos(np.pi * np.arange(NODES) / (NODES - 1))
_TO_SERIES = np.linalg.inv(chebvander(_NODES, NODES - 1))


@dataclass(frozen=True, kw_only=True)
class CorrectionSeries:
    """Of m functions: ``edges`` (n + 1,) [s], ``coefficients`` (n, NODES, m); ``tail``: the last over the largest."""

    edges: Array
    coefficients: Array
    tail: float

    def __call__(self, t: Array) -> Law:
        """Values at instants (T,) with two derivatives, (T, m); at rest outside the edges."""
        x = np.clip(t, self.edges[0], self.edges[-1])
        at = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, len(self.coefficients) - 1)
        found = np.zeros((3, len(t), self.coefficients.shape[2]))
        for k in np.unique(at):
            here, (first, last) = at == k, self.edges[k : k + 2]
            local, c = (2 * x[here] - first - last) / (last - first), self.coefficients[k]
            for order in range(3):
                found[order, here] = chebval(local, chebder(c, order)).T * (2 / (last - first)) ** order
        found[1:, (t < self.edges[0]) | (t > self.edges[-1])] = 0.0
        return Law(*found)


def series_of(compute: Callable[[Array], Array], knots: Array, enough: float, least: float = 0.0) -> CorrectionSeries:
    """Series of a function between knots (n,) [s]; pieces are halved until what is left out is `enough` of the largest.

    Parameters
    ----------
    compute : callable
        Of instants (T,): values (T, m) of one scale.
    least : float
        What counts as the largest where all is smaller: then it is rounding.
    """
    waiting, done = list(itertools.pairwise(knots)), []
    largest, shortest = least, FINEST * (knots[-1] - knots[0])
    while waiting:
        spans = np.array(waiting)
        times = spans[:, :1] + (spans[:, 1:] - spans[:, :1]) * (_NODES + 1) / 2
        times[:, -1] = spans[:, 1]
        values = compute(times.ravel()).reshape(len(spans), NODES, -1)
        largest = max(largest, float(np.abs(values).max(initial=0.0)))
        found = _TO_SERIES @ values
        last = np.abs(found[:, -LAST:]).max(axis=(1, 2), initial=0.0)
        rough = (last > enough * largest) & (spans[:, 1] - spans[:, 0] > shortest)
        done += [(*spans[k], found[k], last[k]) for k in np.flatnonzero(~rough)]
        middle = spans.mean(axis=1)
        waiting = [half for k in np.flatnonzero(rough) for half in ((spans[k, 0], middle[k]), (middle[k], spans[k, 1]))]
    done.sort(key=lambda piece: piece[0])
    tail = max(piece[3] for piece in done) / largest if largest else 0.0
    edges = np.array([done[0][0], *(piece[1] for piece in done)])
    return CorrectionSeries(edges=edges, coefficients=np.array([piece[2] for piece in done]), tail=float(tail))
