"""From results of points to the store: together, so that writing costs little, and with the points that are alike."""

from __future__ import annotations

from time import perf_counter

import numpy as np

from flexapod.surveys.sweeps.batch import BatchResult, PointResult
from flexapod.surveys.sweeps.kept import Kept
from flexapod.surveys.sweeps.store import COMPUTED, FAILED, SweepStore
from flexapod.typing import Array

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
        self._waiting: dict[int, PointResult] = {}
        self._bytes, self._last, self._cost = 0, perf_counter(), 0.0

    def add(self, done: BatchResult) -> None:
        """Take the results of a batch."""
        for point, result in zip(done.points, done.results, strict=True):
            low, high = np.searchsorted(self._firsts, point, "left"), np.searchsorted(self._firsts, point, "right")
            for copy in self._order[low:high].tolist():
                self._waiting[copy] = result
            self._bytes += int(high - low) * sum(array.nbytes for array in result.values.values())
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
        points = np.array(sorted(self._waiting))
        results = [self._waiting[point] for point in points.tolist()]
        self._store.write(
            points,
            {name: self._stacked(name, results) for name in self._kept.variables},
            np.array([FAILED if result.failure else COMPUTED for result in results], dtype=np.int8),
            {"message": [r.failure for r in results], "remarks": [r.remarks for r in results]},
        )
        self._waiting.clear()
        self._bytes, self._last = 0, perf_counter()
        self._cost = self._last - begin

    def _stacked(self, name: str, results: list[PointResult]) -> Array:
        """Values of the results, (n, ...); not a number where there are none."""
        made = np.full((len(results), *self._kept.shape(name)), np.nan)
        for row, result in enumerate(results):
            if not result.failure:
                made[row] = result.values[name]
        return made
