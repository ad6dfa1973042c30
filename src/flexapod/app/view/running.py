"""A simulation in a thread of its own, which waits for a free core, lets shorter ones pass and can be cancelled."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING, Protocol

from flexapod import model
from flexapod.app.view.cores import Cores, Turn
from flexapod.app.view.threads import Threads

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["Run", "Watcher"]

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
    """One simulation.

    Parameters
    ----------
    study : Study or ActuatorStudy
    threads : Threads
        Of the session that asks for it.
    cores : Cores
        Of the server.
    watcher : Watcher
    """

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
        from flexapod import study

        try:
            return study.run(self.study, progress=self._progress)
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
