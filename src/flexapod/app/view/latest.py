"""Work in the background where only the newest request matters."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

from flexapod.app.view.threads import Threads

__all__ = ["Latest"]


class Latest:
    """Calls `work` in a thread for the newest request; requests that come meanwhile lead to one more call.

    Parameters
    ----------
    threads : Threads
        Of the session; they tell what the work raises.
    work : callable
        Without arguments.
    """

    def __init__(self, threads: Threads, work: Callable[[], None]) -> None:
        self._threads, self._work = threads, work
        self._lock, self._asked, self._running, self._due = threading.Lock(), False, False, 0.0

    def request(self, quiet: float = 0.0) -> None:
        """Ask for the work to be done with what holds from now on, after a time [s] without another request."""
        with self._lock:
            self._asked, self._due = True, time.monotonic() + quiet
            if self._running:
                return
            self._running = True
        self._threads.start("latest", self._run)

    def close(self) -> None:
        """Begin nothing any more."""
        with self._lock:
            self._asked, self._work = False, _nothing

    def _run(self) -> None:
        while (wait := self._wait()) is not None:
            if wait > 0:
                time.sleep(wait)
                continue
            with self._lock:
                self._asked, work = False, self._work
            self._threads.guarded(work)

    def _wait(self) -> float | None:
        """Time until the work may begin [s]; None, and the thread ends, where nothing is asked for."""
        with self._lock:
            self._running = self._asked
            return self._due - time.monotonic() if self._asked else None


def _nothing() -> None:
    """No work."""
