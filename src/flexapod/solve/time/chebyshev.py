"""Commands and loads as Chebyshev series of time, which the compiled integration evaluates at instants of its own."""

from collections.abc import Sequence

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.piecewise_chebyshev import Pieces
from flexapod.solve.time.command_tables import Law
from flexapod.solve.time.time_events import NEAR

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
        def groups(t: Array) -> tuple[Array, Array]:
            table, load = law(t)
            return table, load[..., None]

        self._pieces = Pieces(groups, np.array(edges), least=SMALL, shortest=finest, halvings=2, scale=_by_kind)

    def covering_pieces(self, first: float, last: float) -> tuple[Array, Array]:
        """Edges (n + 1,) and series (n, NODES, width) of the pieces that cover an interval; none before it again.

        An end of the interval within `NEAR` of an edge is that edge: beyond it nothing is taken.
        """
        near = min(NEAR, (last - first) / 2)
        edges, pieces = self._pieces.cover(first + near, last - near)
        return edges, np.array([np.concatenate(series, axis=1) for series in pieces])


def _by_kind(values: Array) -> Array:
    """Largest size of each kind, along the last axis, of all flattened columns."""
    most = np.abs(values).max(axis=tuple(range(values.ndim - 1)), initial=0.0)
    return np.broadcast_to(most, values.shape[1:]).ravel()
