"""What a store says to be computed is checked when a sweep goes on with it: what cannot be read is computed again."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from flexapod.surveys.sweeps.store import COMPUTED, PENDING, TEXTS, SweepStore, Values


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
