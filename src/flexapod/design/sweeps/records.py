"""Records of a store on disk that are read when they are used, those of the points alone that are asked for."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from xarray import Variable
from xarray.backends import BackendArray
from xarray.core import indexing

from flexapod.design.sweeps.store import SweepStore


def lazy_record(
    path: Path, name: str, dims: tuple[str, ...], shape: tuple[int, ...], attributes: Mapping[str, Any]
) -> Variable:
    """Lazy variable of a record of all points, held in memory once it was read whole."""
    array: Any = indexing.LazilyIndexedArray(_Record(path, name, shape))
    kept = indexing.MemoryCachedArray(indexing.CopyOnWriteArray(array))
    return Variable(dims, kept, dict(attributes), fastpath=True)


class _Record(BackendArray):
    """Place of a record (N, ...) in a store, which can be pickled and read by any thread."""

    dtype = np.dtype(np.float64)

    def __init__(self, path: Path, name: str, shape: tuple[int, ...]) -> None:
        self._path, self._name, self.shape = path.absolute(), name, shape

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.BASIC, self._read)

    def _read(self, key: tuple[Any, ...]) -> Any:
        """Values under integers and slices."""
        at = range(self.shape[0])[key[0]]
        points = at if isinstance(at, range) else range(at, at + 1)
        with SweepStore.open(self._path) as store:
            values = store.record(self._name, points, self.shape[1:])
        return values[(slice(None) if points is at else 0, *key[1:])]
