"""Results of all visitors together: how much they may take, and whose goes where there is no more room."""

from __future__ import annotations

import threading
import weakref
from collections import OrderedDict
from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

from flexapod.analysis.checks.resource_limits import available_memory

if TYPE_CHECKING:
    from xarray import Dataset

MOST_RESULTS = 500e6
"""What results of all visitors may take together [bytes]: a robot's of 2 s, with an instant a millisecond, has 4 MB."""
SHARE = 0.25
"""Of the memory that is free when the server begins, where that is less."""


class Holder(Protocol):
    """Who has a result: a session."""

    def forget(self, data: Dataset) -> None:
        """Drop this result, wherever it is, if it is still there."""


class KeptResults:
    """The results of all sessions, the oldest first; `most` bytes, of which the newest may take all, or more alone.

    `released` is called when results have been dropped.
    """

    def __init__(self, most: float | None = None, released: Callable[[], None] = lambda: None) -> None:
        self.most: float = min(MOST_RESULTS, SHARE * available_memory()) if most is None else most
        self._released = released
        self._lock = threading.Lock()
        self._kept: OrderedDict[Holder, weakref.ref[Dataset]] = OrderedDict()

    @property
    def size(self) -> int:
        """What the results take that are still there [bytes]."""
        with self._lock:
            return self._size()

    def take(self, holder: Holder, data: Dataset) -> None:
        """Count a new result of somebody, and have the oldest of others dropped until all have room.

        Not while a lock of a session is held: others are told.
        """
        with self._lock:
            self._kept[holder] = weakref.ref(data)
            self._kept.move_to_end(holder)
        while (oldest := self._oldest()) is not None:
            other, found = oldest
            other.forget(found)
            del oldest, found
            self._released()

    def drop(self, holder: Holder) -> None:
        """Count the result of somebody no more."""
        with self._lock:
            self._kept.pop(holder, None)

    def _oldest(self) -> tuple[Holder, Dataset] | None:
        """The oldest result but the newest, which is counted no more; None where all have room."""
        with self._lock:
            while self._size() > self.most and len(self._kept) > 1:
                holder, kept = self._kept.popitem(last=False)
                if (data := kept()) is not None:
                    return holder, data
        return None

    def _size(self) -> int:
        return sum(data.nbytes for kept in self._kept.values() if (data := kept()) is not None)
