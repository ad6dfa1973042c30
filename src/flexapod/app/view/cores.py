"""How many simulations run at once, whoever asked for them: as many as there are cores; the others wait in order."""

from __future__ import annotations

import threading
from collections.abc import Callable

from flexapod.study.sweep.executors import local_cores

__all__ = ["Cores"]

TOLD = 0.3  # time after which somebody who waits is told so [s]


class Cores:
    """Places for simulations, shared by all sessions of a server.

    Parameters
    ----------
    count : int, optional
        How many; default: the cores that this process may use.
    """

    def __init__(self, count: int | None = None) -> None:
        self._free = count or local_cores()
        self._changed = threading.Condition()
        self._queue: list[object] = []

    def take(self, cancelled: Callable[[], bool], waits: Callable[[], None]) -> bool:
        """Wait for a place; False where it was cancelled meanwhile. Who has one gives it back.

        Parameters
        ----------
        cancelled : callable
            Whether the place is not wanted any more; `wake` makes those who wait look again.
        waits : callable
            Called once if it takes a while.
        """
        me = object()
        with self._changed:
            self._queue.append(me)

        def ready() -> bool:
            return cancelled() or (self._free > 0 and self._queue[0] is me)

        try:
            with self._changed:
                at_once = self._changed.wait_for(ready, TOLD)
            if not at_once:
                waits()
            with self._changed:
                self._changed.wait_for(ready)
                if cancelled():
                    return False
                self._free -= 1
                return True
        finally:
            with self._changed:
                self._queue.remove(me)
                self._changed.notify_all()

    def give_back(self) -> None:
        """Leave a place that was taken."""
        with self._changed:
            self._free += 1
            self._changed.notify_all()

    def wake(self) -> None:
        """Those who wait look whether they are cancelled."""
        with self._changed:
            self._changed.notify_all()
