"""Simulations of all sessions in threads of their own, as many at once as there are cores, and their results.

Results of all clients share one limit of memory; beyond it the oldest is dropped.
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
from flexapod.common.lazy_imports import LazyModule
from flexapod.design.sweeps.executors import local_cores

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod import analysis
else:
    analysis = LazyModule("flexapod.analysis")

TOLD = 0.3  # time after which somebody who waits is told so [s]
SLICE = 1.0  # time for which somebody computes before others may have the place [s]
LONG = 10.0  # from here on all are alike: the longest wait of a long simulation, behind short ones that never end [s]


@dataclass(eq=False)
class CoreUsage:
    """Time that one simulation has `used` of a core [s], and the instant `since` which it waits or computes."""

    used: float = 0.0
    since: float = field(default_factory=time.monotonic)

    def rank(self, now: float) -> float:
        """Rank in the queue, lowest first: simulations that computed little or waited for long."""
        return min(self.used, LONG) - (now - self.since)


class CorePool:
    """Places for simulations, shared by all sessions of a server: `count`, else the cores that this process may use.

    Who has computed least comes first, so that short simulations pass long ones; long ones take turns.
    """

    def __init__(self, count: int | None = None) -> None:
        self._free = count or local_cores()
        self._changed = threading.Condition()
        self._queue: list[CoreUsage] = []

    def acquire(self, turn: CoreUsage, cancelled: Callable[[], bool], waits: Callable[[], None]) -> bool:
        """Wait for a core for `turn`; False where it was `cancelled` meanwhile. The caller gives the core back.

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

    def release(self, turn: CoreUsage) -> None:
        """Leave a place that was taken."""
        with self._changed:
            turn.used += time.monotonic() - turn.since
            self._free += 1
            self._changed.notify_all()

    def should_yield(self, turn: CoreUsage) -> bool:
        """Test whether a simulation that has a core should let one that waits compute first."""
        with self._changed:
            now = time.monotonic()
            spent = now - turn.since
            if spent < SLICE or self._free > 0 or not self._queue:
                return False
            return self._first().rank(now) < min(turn.used + spent, LONG)

    def wake(self) -> None:
        """Make waiting simulations check whether they are cancelled."""
        with self._changed:
            self._changed.notify_all()

    def _first(self) -> CoreUsage:
        now = time.monotonic()
        return min(self._queue, key=lambda turn: turn.rank(now))


REPORTS = 0.1  # least time between two reports of progress [s]


class Watcher(Protocol):
    """Observer of a simulation, called in the simulation's thread."""

    def on_wait(self, run: Run) -> None:
        """Take notice that no core has been free for a while."""

    def on_begin(self, run: Run) -> None:
        """Take notice that the simulation has a core and begins."""

    def on_progress(self, run: Run, share: float) -> None:
        """Take notice of the share that is done (0 to 1), at most ten times a second."""

    def on_end(self, run: Run, found: Dataset | BaseException) -> None:
        """Take the result or the exception, once, at the end; not where the run was cancelled before it began."""


class Run:
    """One simulation for a session, on the `cores` of the server; `watcher` is told how it goes."""

    study: model.Study | model.ActuatorStudy

    def __init__(
        self, study: model.Study | model.ActuatorStudy, threads: Threads, cores: CorePool, watcher: Watcher
    ) -> None:
        self.study, self._threads, self._cores, self._watcher = study, threads, cores, watcher
        self._cancelled = threading.Event()
        self._turn, self._has_place = CoreUsage(), False
        self._reported = 0.0

    def start(self) -> None:
        """Begin, or wait for a free core."""
        self._threads.start("simulation", self._run)

    def cancel(self) -> None:
        """Ask the run to stop: at once where it waits, else at the next chunk of steps."""
        self._cancelled.set()
        self._cores.wake()

    @property
    def is_cancelled(self) -> bool:
        """True once the run was asked to stop."""
        return self._cancelled.is_set()

    def _run(self) -> None:
        if not self._cores.acquire(self._turn, self._cancelled.is_set, lambda: self._watcher.on_wait(self)):
            return
        self._has_place = True
        try:
            self._watcher.on_begin(self)
            found = self._computed()
        finally:
            self._give_back()
        self._watcher.on_end(self, found)

    def _give_back(self) -> None:
        if self._has_place:
            self._has_place = False
            self._cores.release(self._turn)

    def _let_others_compute(self) -> None:
        """Yield the core, between two chunks of steps, to a run that has computed less, and wait for the next."""
        if self._cores.should_yield(self._turn):
            self._give_back()
            self._has_place = self._cores.acquire(self._turn, self._cancelled.is_set, _nothing)

    def _computed(self) -> Dataset | BaseException:
        try:
            return analysis.run(self.study, progress=self._progress).load()  # the page shows all of it
        except BaseException as error:
            return error

    def _progress(self, reached: float, duration: float) -> None:
        self._let_others_compute()
        if self.is_cancelled:
            raise KeyboardInterrupt  # a simulation keeps what it has and ends as after Ctrl-C
        if time.monotonic() - self._reported > REPORTS:
            self._reported = time.monotonic()
            self._watcher.on_progress(self, min(1.0, reached / duration) if duration > 0 else 1.0)


def _nothing() -> None:
    """Report nothing: a run that has shown progress does not say that it waits, its bar stands."""


MOST_RESULTS = 500e6
"""What results of all visitors may take together [bytes]: a robot's of 2 s, with an instant a millisecond, has 4 MB."""
SHARE = 0.25
"""Of the memory that is free when the server begins, where that is less."""


class Holder(Protocol):
    """Owner of a result: a session."""

    def forget(self, data: Dataset) -> None:
        """Drop this result, wherever it is, if it is still there."""


class ResultMemory:
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
        """Memory of all results that still exist [bytes]."""
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
