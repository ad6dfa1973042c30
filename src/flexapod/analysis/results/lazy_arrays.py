"""Arrays of results that are computed on request, each once."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from threading import RLock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexapod.common.arrays import Array
from flexapod.common.resources import one_thread

#: An array, or what makes it.
ArraySource = Array | Callable[[], NDArray[Any]]


class LazyArrays(Mapping[str, Array]):
    """Arrays by name, each computed when first requested; its source is released then, with all that it holds."""

    def __init__(self, values: Mapping[str, ArraySource]) -> None:
        self._values, self._lock = dict(values), RLock()

    def __getitem__(self, name: str) -> Array:
        """The array, made now if it has not been."""
        value = self._values[name]
        if not callable(value):
            return value
        with self._lock, one_thread():
            value = self._values[name]  # another thread may have made it meanwhile
            if callable(value):
                value = self._values[name] = np.asarray(value())
            return value

    def __iter__(self) -> Iterator[str]:
        """Names in their order."""
        return iter(self._values)

    def __len__(self) -> int:
        """Number of arrays."""
        return len(self._values)

    def peek(self, name: str) -> Array | None:
        """The array, or None before it was first requested."""
        value = self._values[name]
        return None if callable(value) else value
