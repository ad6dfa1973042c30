"""Piecewise polynomials of a costly function of time, between the instants at which it is not smooth."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.polynomial.chebyshev import chebvander
from numpy.typing import NDArray

from flexapod.common.arrays import Array

#: Of instants (T,): arrays (T, ...), each of numbers with a common scale.
Groups = Callable[[Array], Sequence[Array]]

NODES = 20  # of a polynomial
#: Last coefficients of a series over the largest value of their group. Those that are left out go on falling;
#: rounding makes some 1e-16.
ENOUGH = 1e-13
_NODES = -np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
_TO_SERIES = np.linalg.inv(chebvander(_NODES, NODES - 1))


def instants(first: Array, last: Array) -> Array:
    """Instants (pieces, NODES) at which pieces from `first` to `last` (pieces,) are computed."""
    return first[:, None] + (last - first)[:, None] * (_NODES + 1) / 2


def series_of(values: Array, pieces: int) -> Array:
    """Coefficients (pieces, NODES, n) of values (pieces * NODES, ...) at their `instants`."""
    return _TO_SERIES @ values.reshape(pieces, NODES, int(np.prod(values.shape[1:])))


class Pieces:
    """A function as Chebyshev series, made where it is asked for often enough; elsewhere computed as it is.

    Parameters
    ----------
    compute : Groups
        The function.
    knots : ndarray, shape (n,)
        Ascending instants between which it is smooth, first and last included; at least two.
    """

    def __init__(self, compute: Groups, knots: Array) -> None:
        self._compute, self._edges = compute, knots
        self._series: list[list[Array] | None] = [None] * (len(knots) - 1)
        self._scales: list[float] = []
        self._shapes: list[tuple[int, ...]] = []

    def __call__(self, t: Array) -> Sequence[Array]:
        """The function at instants (T,), to `ENOUGH` of the largest value of each group."""
        while True:
            at = np.clip(np.searchsorted(self._edges, t, side="right") - 1, 0, len(self._series) - 1)
            missing = [k for k in np.unique(at).tolist() if self._series[k] is None]
            if NODES * len(missing) > len(t):
                return self._compute(t)
            if not missing:
                return self._evaluate(t, at)
            self._make(missing)

    def _make(self, missing: list[int]) -> None:
        """Series of pieces; those that would be too rough are halved instead."""
        first, last = self._edges[missing], self._edges[[k + 1 for k in missing]]
        found = self._compute(instants(first, last).ravel())
        self._shapes = [x.shape[1:] for x in found]
        self._scales = [
            max(known, float(np.abs(x).max(initial=0.0)))
            for known, x in zip(self._scales or [0.0] * len(found), found, strict=True)
        ]
        series = [series_of(x, len(missing)) for x in found]
        rough = np.zeros(len(missing), dtype=bool)
        for scale, x in zip(self._scales, series, strict=True):
            rough |= ~(np.abs(x[:, -3:]).max(axis=(1, 2), initial=0.0) <= ENOUGH * scale)
        for i, k in reversed(list(enumerate(missing))):
            if rough[i]:
                self._edges = np.insert(self._edges, k + 1, (first[i] + last[i]) / 2)
                self._series.insert(k, None)
            else:
                self._series[k] = [x[i] for x in series]

    def _evaluate(self, t: Array, at: NDArray[np.intp]) -> list[Array]:
        values = [np.empty((len(t), int(np.prod(shape)))) for shape in self._shapes]
        for k in np.unique(at).tolist():
            here, series = at == k, self._series[k]
            first, last = self._edges[k : k + 2]
            terms = chebvander((2 * t[here] - first - last) / (last - first), NODES - 1)
            for x, coefficients in zip(values, series or (), strict=True):
                x[here] = terms @ coefficients
        return [x.reshape(len(t), *shape) for x, shape in zip(values, self._shapes, strict=True)]
