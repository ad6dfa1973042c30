"""Piecewise polynomials of a costly function of time, between the instants at which it is not smooth."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.polynomial.chebyshev import chebder, chebvander
from numpy.typing import NDArray

from flexapod.common.arrays import Array

#: Of instants (T,): arrays (T, ...), each of numbers with a common scale.
Groups = Callable[[Array], Sequence[Array]]

NODES = 20  # of a polynomial
#: Last coefficients of a series over the largest value of their group. Those that are left out go on falling;
#: rounding makes some 1e-16.
ENOUGH = 1e-13
LAST = 3  # coefficients that say what is left out
NOTHING = 1e-9  # of all pieces together: nearer knots are one, apart by rounding, and so short a piece is not halved
AHEAD = 8  # pieces that are made at once where time goes on
INSIDE = -np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
WITH_ENDS = -np.cos(np.pi * np.arange(17) / 16)  # neighbours meet at an end


def largest(values: Array) -> float:
    """Largest size of values."""
    return float(np.abs(values).max(initial=0.0))


def _apart(knots: Array) -> Array:
    """Knots without those that only rounding parts from the one before; both ends stay."""
    found = knots[np.concatenate([[True], np.diff(knots) > NOTHING * (knots[-1] - knots[0])])]
    found[-1] = knots[-1]
    return found


class Pieces:
    """A function as Chebyshev series, made where it is asked for often enough; elsewhere computed as it is.

    Parameters
    ----------
    compute : Groups
        The function.
    knots : ndarray, shape (n,)
        Ascending instants between which it is smooth, first and last included; at least two.
    nodes : ndarray, shape (m,)
        Where it is computed in each piece, which goes from -1 to 1.
    enough : float
        What series leave out, of the largest value of each group; pieces are halved until then.
    least : float
        What counts as the largest value where all is smaller: then it is rounding.
    shortest : float
        Length of a piece that is not halved [s].
    halvings : int
        How many times a piece is halved at once.
    scale : callable
        Of a group (T, ...): its largest value, or that of each of its flattened columns.
    """

    def __init__(
        self,
        compute: Groups,
        knots: Array,
        nodes: Array = INSIDE,
        *,
        enough: float = ENOUGH,
        least: float = 0.0,
        shortest: float = 0.0,
        halvings: int = 1,
        scale: Callable[[Array], Array | float] = largest,
    ) -> None:
        self._compute, self._edges, self._nodes = compute, _apart(knots), nodes
        self._to_series = np.linalg.inv(chebvander(nodes, len(nodes) - 1))
        self._enough, self._least, self._shortest, self._halvings = enough, least, shortest, halvings
        self._scale = scale
        self._series: list[list[Array] | None] = [None] * (len(self._edges) - 1)
        self._scales: list[Array | float] = []
        self._shapes: list[tuple[int, ...]] = []

    def __call__(self, t: Array) -> Sequence[Array]:
        """The function at instants (T,), to `enough` of the largest value of each group."""
        while True:
            at = self._at(t)
            missing = self._missing(np.unique(at))
            if len(self._nodes) * len(missing) > len(t):
                return self._compute(t)
            if not missing:
                return self._evaluate(t, at)[0]
            self._make(missing)

    def cover(self, first: float, last: float) -> tuple[Array, list[list[Array]]]:
        """Edges (n + 1,) and series of the pieces that cover an interval; none before it again."""
        before = max(int(np.searchsorted(self._edges, first, side="right")) - 1, 0)
        self._edges, self._series = self._edges[before:], self._series[before:]
        while True:
            count = min(int(np.searchsorted(self._edges, last)), len(self._series))
            if not (missing := self._missing(range(count))):
                return self._edges[: count + 1], [series for series in self._series[:count] if series]
            self._scales.clear()  # pieces are judged beside those that are made at once, and wait behind a rough one
            self._make(self._missing(range(missing[0], min(missing[0] + AHEAD, len(self._series)))))
            made = self._series.index(None) if None in self._series else len(self._series)
            self._series[made:] = [None] * (len(self._series) - made)

    def make_all(self) -> float:
        """Make every piece; what series leave out of the first group, over its largest value."""
        while missing := self._missing(range(len(self._series))):
            self._make(missing)
        left, most = max(largest(x[0][-LAST:]) for x in self._series if x), largest(np.asarray(self._scales[0]))
        return left / most if most else 0.0

    def with_derivatives(self, t: Array) -> list[Array]:
        """First group of series that are all made, at instants (T,), and two derivatives; at rest outside the knots."""
        inside = np.clip(t, self._edges[0], self._edges[-1])
        found = [values[0] for values in self._evaluate(inside, self._at(inside), derivatives=2)]
        for rates in found[1:]:
            rates[t != inside] = 0.0
        return found

    def _at(self, t: Array) -> NDArray[np.intp]:
        return np.clip(np.searchsorted(self._edges, t, side="right") - 1, 0, len(self._series) - 1)

    def _missing(self, pieces: Sequence[int] | NDArray[np.intp]) -> list[int]:
        return [int(k) for k in pieces if self._series[k] is None]

    def _make(self, missing: list[int]) -> None:
        """Series of pieces; those that would be too rough are halved instead."""
        first, last = self._edges[missing], self._edges[[k + 1 for k in missing]]
        times = np.minimum(first[:, None] + (last - first)[:, None] * (self._nodes + 1) / 2, last[:, None])
        found = self._compute(times.ravel())
        self._shapes = [x.shape[1:] for x in found]
        known = self._scales or [self._least] * len(found)
        self._scales = [np.fmax(before, self._scale(x)) for before, x in zip(known, found, strict=True)]
        series = [self._to_series @ x.reshape(*times.shape, int(np.prod(x.shape[1:]))) for x in found]
        rough = np.zeros(len(missing), dtype=bool)
        for scale, x in zip(self._scales, series, strict=True):
            rough |= ~(np.abs(x[:, -LAST:]) <= self._enough * scale).all(axis=(1, 2))
        rough &= last - first > max(self._shortest, NOTHING * (self._edges[-1] - self._edges[0]))
        for i, k in reversed(list(enumerate(missing))):
            if rough[i]:
                cut = self._edges[k : k + 2]
                for _ in range(self._halvings):
                    cut = np.insert(cut, np.arange(1, len(cut)), (cut[:-1] + cut[1:]) / 2)
                self._edges = np.insert(self._edges, k + 1, cut[1:-1])
                self._series[k + 1 : k + 1] = [None] * (len(cut) - 2)
            else:
                self._series[k] = [x[i] for x in series]

    def _evaluate(self, t: Array, at: NDArray[np.intp], derivatives: int = 0) -> list[list[Array]]:
        """Groups at instants in pieces, and their derivatives."""
        found = [[np.empty((len(t), int(np.prod(shape)))) for shape in self._shapes] for _ in range(derivatives + 1)]
        for k in np.unique(at).tolist():
            here, series = at == k, self._series[k] or ()
            first, last = self._edges[k : k + 2]
            terms = chebvander((2 * t[here] - first - last) / (last - first), len(self._nodes) - 1)
            for order, values in enumerate(found):
                for x, c in zip(values, series, strict=True):
                    x[here] = terms[:, : len(c) - order] @ chebder(c, order) * (2 / (last - first)) ** order
        return [[x.reshape(len(t), *s) for x, s in zip(values, self._shapes, strict=True)] for values in found]
