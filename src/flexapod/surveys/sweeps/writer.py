"""From results of points to the store, with the points that are alike; what a store cannot read is done again."""

from __future__ import annotations

from collections.abc import Mapping
from time import perf_counter

import numpy as np

from flexapod.surveys.sweeps.batch import BatchResult, PointResult
from flexapod.surveys.sweeps.kept import Kept
from flexapod.surveys.sweeps.store import COMPUTED, FAILED, PENDING, TEXTS, SweepStore, Values
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


def mend(store: SweepStore) -> int:
    """Make points pending whose results cannot be read, or are not numbers where every computed point has some.

    Everything is read, a chunk at a time. Returns how many points became pending, or are since the store was opened.
    """
    before, complete = store.status.copy(), store.header["complete"].split()
    for name in (*store.header["kept"].split(), *TEXTS):
        absent = store.absent(name)
        for rows, file in store.chunks(name):
            status = store.status[rows]  # a view
            values = None if (absent[rows] & (status != PENDING)).any() else _read(store, name, rows)
            if values is None:
                file.unlink(missing_ok=True)  # it would be read before points are added to it
                status[:] = PENDING
            elif name in complete:
                status[incomplete(status, {name: values})] = PENDING
    changed = np.flatnonzero(store.status != before)
    if len(changed):
        store.write(changed, {}, store.status[changed], {})
    return len(changed) + store.lost


def incomplete(status: Values, values: Mapping[str, Values]) -> Values:
    """Which points are said to be computed while a value of theirs is not a number, (N,)."""
    lost = np.zeros(len(status), dtype=bool)
    for array in values.values():
        lost |= np.isnan(array.reshape(len(array), -1)).any(axis=1)
    return lost & (status == COMPUTED)


def _read(store: SweepStore, name: str, rows: slice) -> Values | None:
    try:
        return store.read(name, rows)
    except Exception:  # whatever the decoder of a spoilt chunk says
        return None
