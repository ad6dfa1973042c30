"""A simulation in a thread of its own; as many at once as there are cores, whoever asked for them.

Results of all visitors together: how much they may take, and whose goes where there is no more room.
"""

from __future__ import annotations

import threading
import time
import weakref
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

from flexapod import model
from flexapod.analysis.checks.resource_limits import available_memory
from flexapod.app.browser.background import Threads
from flexapod.design.sweeps.executors import local_cores

if TYPE_CHECKING:
    from xarray import Dataset

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
    """Places for simulations, shared by all sessions of a server: `count`, else the cores that this process may use.

    Who has computed least comes first, so that short simulations pass long ones; long ones take turns.
    """

    def __init__(self, count: int | None = None) -> None:
        self._free = count or local_cores()
        self._changed = threading.Condition()
        self._queue: list[Turn] = []

    def take(self, turn: Turn, cancelled: Callable[[], bool], waits: Callable[[], None]) -> bool:
        """Wait for a place for `turn`; False where it was `cancelled` meanwhile. Who has one gives it back.

        `wake` makes those who wait look again whether they are cancelled; `waits` is called once if it takes a while.
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


REPORTS = 0.1  # least time between two reports of progress [s]


class Watcher(Protocol):
    """Who is told how a simulation goes, in the simulation's thread."""

    def waits(self, run: Run) -> None:
        """No core has been free for a while."""

    def begins(self, run: Run) -> None:
        """It has a core."""

    def progress(self, run: Run, share: float) -> None:
        """How much is done (0 to 1), at most ten times a second."""

    def ended(self, run: Run, found: Dataset | BaseException) -> None:
        """Once, at the end: the result or what ended it; not where it was cancelled before it began."""


class Run:
    """One simulation for a session, on the `cores` of the server; `watcher` is told how it goes."""

    study: model.Study | model.ActuatorStudy

    def __init__(
        self, study: model.Study | model.ActuatorStudy, threads: Threads, cores: Cores, watcher: Watcher
    ) -> None:
        self.study, self._threads, self._cores, self._watcher = study, threads, cores, watcher
        self._cancelled = threading.Event()
        self._turn, self._has_place = Turn(), False
        self._reported = 0.0

    def start(self) -> None:
        """Begin, or wait for a free core."""
        self._threads.start("simulation", self._run)

    def cancel(self) -> None:
        """Ask it to stop: at once where it waits, else at the next chunk of steps."""
        self._cancelled.set()
        self._cores.wake()

    @property
    def cancelled(self) -> bool:
        """Whether it was asked to stop."""
        return self._cancelled.is_set()

    def _run(self) -> None:
        if not self._cores.take(self._turn, self._cancelled.is_set, lambda: self._watcher.waits(self)):
            return
        self._has_place = True
        try:
            self._watcher.begins(self)
            found = self._computed()
        finally:
            self._give_back()
        self._watcher.ended(self, found)

    def _give_back(self) -> None:
        if self._has_place:
            self._has_place = False
            self._cores.give_back(self._turn)

    def _let_others_compute(self) -> None:
        """Between two chunks of steps: give the place to who has computed less, and wait for the next one."""
        if self._cores.is_wanted(self._turn):
            self._give_back()
            self._has_place = self._cores.take(self._turn, self._cancelled.is_set, _nothing)

    def _computed(self) -> Dataset | BaseException:
        from flexapod import analysis as study

        try:
            return study.run(self.study, progress=self._progress).load()  # the page shows all of it
        except BaseException as error:
            return error

    def _progress(self, reached: float, duration: float) -> None:
        self._let_others_compute()
        if self.cancelled:
            raise KeyboardInterrupt  # a simulation keeps what it has and ends as after Ctrl-C
        if time.monotonic() - self._reported > REPORTS:
            self._reported = time.monotonic()
            self._watcher.progress(self, min(1.0, reached / duration) if duration > 0 else 1.0)


def _nothing() -> None:
    """Who has shown progress does not say that it waits: its bar stands."""


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
