"""Piecewise polynomials of a costly function of time, between the instants at which it is not smooth."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.polynomial.chebyshev import chebder, chebvander
from numpy.typing import NDArray

from flexapod.common.arrays import Array, Mask

#: Of instants (T,): arrays (T, ...), each of numbers with a common scale.
Groups = Callable[[Array], Sequence[Array]]

NODES = 20  # of a polynomial
#: Last coefficients of a series over the largest value of their group. Those that are left out go on falling;
#: rounding makes some 1e-16.
ENOUGH = 1e-13
LAST = 3  # coefficients that say what is left out


class Nodes:
    """Instants of a piece at which a function is computed, and the series through its values there.

    Parameters
    ----------
    points : ndarray, shape (n,)
        Ascending, of a piece from -1 to 1.
    """

    def __init__(self, points: Array) -> None:
        self.count: int = len(points)
        self._points, self._to_series = points, np.linalg.inv(chebvander(points, self.count - 1))

    def instants(self, first: Array, last: Array) -> Array:
        """Instants (pieces, n) at which pieces from `first` to `last` (pieces,) are computed."""
        at = first[:, None] + (last - first)[:, None] * (self._points + 1) / 2
        return np.minimum(at, last[:, None])

    def series_of(self, values: Array, pieces: int) -> Array:
        """Coefficients (pieces, n, m) of values (pieces * n, ...) at their `instants`."""
        return self._to_series @ values.reshape(pieces, self.count, int(np.prod(values.shape[1:])))


INSIDE = Nodes(-np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES))
WITH_ENDS = Nodes(-np.cos(np.pi * np.arange(17) / 16))  # neighbours meet at an end


def rough_pieces(series: Array, scale: Array | float, enough: float = ENOUGH) -> Mask:
    """Test whether last coefficients of series (pieces, n, m) are not `enough` of the scale (m,), (pieces,)."""
    return ~(np.abs(series[:, -LAST:]) <= enough * scale).all(axis=(1, 2))


class Pieces:
    """A function as Chebyshev series, made where it is asked for often enough; elsewhere computed as it is.

    Parameters
    ----------
    compute : Groups
        The function.
    knots : ndarray, shape (n,)
        Ascending instants between which it is smooth, first and last included; at least two.
    nodes : Nodes
        Of each piece.
    enough : float
        What series leave out, of the largest value of each group; pieces are halved until then.
    least : float
        What counts as the largest value where all is smaller: then it is rounding.
    shortest : float
        Length of a piece that is not halved [s].
    """

    def __init__(
        self,
        compute: Groups,
        knots: Array,
        nodes: Nodes = INSIDE,
        *,
        enough: float = ENOUGH,
        least: float = 0.0,
        shortest: float = 0.0,
    ) -> None:
        self._compute, self._edges, self._nodes = compute, knots, nodes
        self._enough, self._least, self._shortest = enough, least, shortest
        self._series: list[list[Array] | None] = [None] * (len(knots) - 1)
        self._scales: list[float] = []
        self._shapes: list[tuple[int, ...]] = []

    def __call__(self, t: Array) -> Sequence[Array]:
        """The function at instants (T,), to `enough` of the largest value of each group."""
        while True:
            at = self._at(t)
            missing = self._missing(np.unique(at))
            if self._nodes.count * len(missing) > len(t):
                return self._compute(t)
            if not missing:
                return self._evaluate(t, at)[0]
            self._make(missing)

    def make_all(self) -> float:
        """Make every piece; what series leave out of the first group, over its largest value."""
        while missing := self._missing(range(len(self._series))):
            self._make(missing)
        left = max(float(np.abs(series[0][-LAST:]).max(initial=0.0)) for series in self._series if series)
        return left / self._scales[0] if self._scales[0] else 0.0

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
        found = self._compute(self._nodes.instants(first, last).ravel())
        self._shapes = [x.shape[1:] for x in found]
        self._scales = [
            max(known, float(np.abs(x).max(initial=0.0)))
            for known, x in zip(self._scales or [self._least] * len(found), found, strict=True)
        ]
        series = [self._nodes.series_of(x, len(missing)) for x in found]
        rough = np.zeros(len(missing), dtype=bool)
        for scale, x in zip(self._scales, series, strict=True):
            rough |= rough_pieces(x, scale, self._enough)
        rough &= last - first > self._shortest
        for i, k in reversed(list(enumerate(missing))):
            if rough[i]:
                self._edges = np.insert(self._edges, k + 1, (first[i] + last[i]) / 2)
                self._series.insert(k, None)
            else:
                self._series[k] = [x[i] for x in series]

    def _evaluate(self, t: Array, at: NDArray[np.intp], derivatives: int = 0) -> list[list[Array]]:
        """Groups at instants in pieces, and their derivatives."""
        found = [[np.empty((len(t), int(np.prod(shape)))) for shape in self._shapes] for _ in range(derivatives + 1)]
        for k in np.unique(at).tolist():
            here, series = at == k, self._series[k] or ()
            first, last = self._edges[k : k + 2]
            terms = chebvander((2 * t[here] - first - last) / (last - first), self._nodes.count - 1)
            for order, values in enumerate(found):
                for x, c in zip(values, series, strict=True):
                    x[here] = terms[:, : len(c) - order] @ chebder(c, order) * (2 / (last - first)) ** order
        return [[x.reshape(len(t), *s) for x, s in zip(values, self._shapes, strict=True)] for values in found]
