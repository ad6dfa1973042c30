"""Results that are made when they are asked for, each once."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from threading import RLock
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexapod.common.arrays import Array
from flexapod.common.resources import one_thread

#: An array, or what makes it.
Made = Array | Callable[[], NDArray[Any]]


class Asked(Mapping[str, Array]):
    """Arrays by name, each made when it is first asked for; what makes it is dropped then, with all that it holds."""

    def __init__(self, values: Mapping[str, Made]) -> None:
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
        """How many arrays there are."""
        return len(self._values)

    def there(self, name: str) -> Array | None:
        """The array, unless nobody has asked for it yet."""
        value = self._values[name]
        return None if callable(value) else value
