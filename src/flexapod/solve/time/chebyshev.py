"""Commands and loads as Chebyshev series of time, which the compiled integration evaluates at instants of its own."""

import itertools
from collections import deque
from collections.abc import Sequence

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.piecewise_chebyshev import INSIDE, rough_pieces
from flexapod.solve.system import COLUMNS
from flexapod.solve.time.command_tables import Law
from flexapod.solve.time.time_events import NEAR

AHEAD = 8  # pieces that are made at once
SMALL = 1e-3  # the least value of a kind that is worth its digits, in SI units


class Series:
    """A law as polynomials between ascending instants; they are made as time goes on, and forgotten.

    Parameters
    ----------
    law : Law
        Tables and loads.
    edges : sequence of float
        Instants between which the law is smooth, first and last included.
    finest : float
        Shortest piece [s].
    """

    def __init__(self, law: Law, edges: Sequence[float], finest: float) -> None:
        self._law, self._finest = law, finest
        self._todo = deque(itertools.pairwise(edges))
        self._pieces: deque[tuple[float, float, Array]] = deque()

    def covering_pieces(self, first: float, last: float) -> tuple[Array, Array]:
        """Edges (n + 1,) and series (n, NODES, width) of the pieces that cover an interval; none before it again.

        An end of the interval within `NEAR` of an edge is that edge: beyond it nothing is taken.
        """
        near = min(NEAR, (last - first) / 2)
        while self._pieces and self._pieces[0][1] <= first + near:
            self._pieces.popleft()
        while self._todo and (not self._pieces or self._pieces[-1][1] < last - near):
            self._make()
        found = [piece for piece in self._pieces if piece[0] < last - near]
        return np.array([found[0][0], *(end for _, end, _ in found)]), np.array([x for _, _, x in found])

    def _make(self) -> None:
        """The next pieces; those that would be too rough are quartered instead, and what comes after them waits."""
        spans = [self._todo.popleft() for _ in range(min(AHEAD, len(self._todo)))]
        first, last = np.array(spans).T
        times = INSIDE.instants(first, last)
        table, load = self._law(times.ravel())
        values = np.concatenate([table.reshape(times.size, -1), load], axis=1)
        kinds = np.concatenate([np.tile(np.arange(COLUMNS), table[0].size // COLUMNS), np.full(load.shape[1], COLUMNS)])
        most = np.abs(values).max(axis=0, initial=0.0)
        scale = np.array([most[kinds == kind].max(initial=SMALL) for kind in range(COLUMNS + 1)])[kinds]
        series = INSIDE.series_of(values, len(spans))
        rough = rough_pieces(series, scale) & (last - first > self._finest)
        smooth = len(spans) if not rough.any() else int(np.argmax(rough))
        self._pieces.extend((*spans[k], series[k]) for k in range(smooth))
        waiting = [part for k in range(smooth, len(spans)) for part in _parts(*spans[k], rough[k])]
        self._todo.extendleft(reversed(waiting))


def _parts(first: float, last: float, rough: bool) -> list[tuple[float, float]]:
    """A span, or its quarters."""
    middle = (first + last) / 2
    edges = [first, (first + middle) / 2, middle, (middle + last) / 2, last] if rough else [first, last]
    return list(itertools.pairwise(edges))
