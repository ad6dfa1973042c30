"""How many simulations run at once, whoever asked for them: as many as there are cores, and who computes when."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field

from flexapod.surveys.sweeps.executors import local_cores

__all__ = ["Cores", "Turn"]

TOLD = 0.3  # time after which somebody who waits is told so [s]
SLICE = 1.0  # time for which somebody computes before others may have the place [s]
LONG = 10.0  # from here on all are alike: the longest wait of a long simulation, behind short ones that never end [s]


@dataclass(eq=False)
class Turn:
    """What one simulation has had of the cores so far [s], and since when it has waited or computed."""

    used: float = 0.0
    since: float = field(default_factory=time.monotonic)

    def rank(self, now: float) -> float:
        """The lowest is first: who has computed little, or has waited for long."""
        return min(self.used, LONG) - (now - self.since)


class Cores:
    """Places for simulations, shared by all sessions of a server.

    Who has computed least comes first, so that short simulations pass long ones; long ones take turns.

    Parameters
    ----------
    count : int, optional
        How many; default: the cores that this process may use.
    """

    def __init__(self, count: int | None = None) -> None:
        self._free = count or local_cores()
        self._changed = threading.Condition()
        self._queue: list[Turn] = []

    def take(self, turn: Turn, cancelled: Callable[[], bool], waits: Callable[[], None]) -> bool:
        """Wait for a place; False where it was cancelled meanwhile. Who has one gives it back.

        Parameters
        ----------
        turn : Turn
            Of the simulation that is to begin.
        cancelled : callable
            Whether the place is not wanted any more; `wake` makes those who wait look again.
        waits : callable
            Called once if it takes a while.
        """
        with self._changed:
            turn.since = time.monotonic()
            self._queue.append(turn)

        def ready() -> bool:
            return cancelled() or (self._free > 0 and self._first() is turn)

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
                turn.since = time.monotonic()
                return True
        finally:
            with self._changed:
                self._queue.remove(turn)
                self._changed.notify_all()

    def give_back(self, turn: Turn) -> None:
        """Leave a place that was taken."""
        with self._changed:
            turn.used += time.monotonic() - turn.since
            self._free += 1
            self._changed.notify_all()

    def is_wanted(self, turn: Turn) -> bool:
        """Whether somebody who has a place should let another one, who waits, compute first."""
        with self._changed:
            now = time.monotonic()
            spent = now - turn.since
            if spent < SLICE or self._free > 0 or not self._queue:
                return False
            return self._first().rank(now) < min(turn.used + spent, LONG)

    def wake(self) -> None:
        """Those who wait look whether they are cancelled."""
        with self._changed:
            self._changed.notify_all()

    def _first(self) -> Turn:
        now = time.monotonic()
        return min(self._queue, key=lambda turn: turn.rank(now))
