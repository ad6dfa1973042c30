"""From results of points to the store, with the points that are alike."""

from __future__ import annotations

from time import perf_counter

import numpy as np

from flexapod.common.arrays import Array
from flexapod.design.sweeps.outputs import Kept
from flexapod.design.sweeps.store import COMPUTED, FAILED, FLOAT, StoredPoint, SweepStore
from flexapod.design.sweeps.worker import BatchResult, PointResult

OFTEN = 2.0  # seconds between two looks at the disk at least
SELDOM = 30.0  # at most, on however slow a disk
SHARE = 0.02  # of the time that writing may take
MOST_BYTES = 32 << 20  # of results that wait


class Writer:
    """Collects results and writes them when it is time; `flush` writes what is left.

    Parameters
    ----------
    store : SweepStore
    kept : Kept
    alike : ndarray, shape (N,)
        The first point with an equal study, for every point.
    """

    def __init__(self, store: SweepStore, kept: Kept, alike: Array) -> None:
        self._store, self._kept = store, kept
        order = np.argsort(alike, kind="stable")
        self._order, self._firsts = order, alike[order]
        self._waiting: list[StoredPoint] = []
        self._bytes, self._last, self._cost = 0, perf_counter(), 0.0

    def add(self, done: BatchResult) -> None:
        """Take the results of a batch."""
        for point, result in zip(done.points, done.results, strict=True):
            low, high = np.searchsorted(self._firsts, point, "left"), np.searchsorted(self._firsts, point, "right")
            row = self._row(point, result)
            self._waiting += (row._replace(point=copy) for copy in self._order[low:high].tolist())
            self._bytes += len(row.scalars) + sum(map(len, row.records))  # of rows that are alike once
        wait = max(OFTEN, min(SELDOM, self._cost / SHARE))
        if self._bytes > MOST_BYTES or perf_counter() - self._last > wait:
            self.flush()

    def flush(self) -> None:
        """Write what waits.

        Raises
        ------
        ComputationError
            The store cannot be written.
        """
        if not self._waiting:
            return
        begin = perf_counter()
        self._store.write(self._waiting)
        self._waiting = []
        self._bytes, self._last = 0, perf_counter()
        self._cost = self._last - begin

    def _row(self, point: int, result: PointResult) -> StoredPoint:
        if result.failure:
            return StoredPoint(point, FAILED, result.failure, b"", (b"",) * len(self._kept.records))
        scalars = b"".join(self._blob(name, result) for name in self._kept.scalars)
        records = tuple(self._blob(name, result) for name in self._kept.records)
        return StoredPoint(point, COMPUTED, result.remarks, scalars, records)

    def _blob(self, name: str, result: PointResult) -> bytes:
        return np.broadcast_to(result.values[name], self._kept.arrays[name].shape[1:]).astype(FLOAT).tobytes()
