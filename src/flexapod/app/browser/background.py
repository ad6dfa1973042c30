"""Work of one session in the background: what goes wrong is told to its person; of requests only the newest counts."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable


class Threads:
    """Threads of a session: an exception ends the thread that raised it, no other, and is given to `fault` there."""

    def __init__(self, fault: Callable[[BaseException], None]) -> None:
        self._fault = fault

    def start(self, name: str, work: Callable[[], None]) -> None:
        """Do some work in a thread of its own, ``flexapod-name``; it does not keep the program alive."""
        threading.Thread(target=self.guarded, args=(work,), name=f"flexapod-{name}", daemon=True).start()

    def guarded(self, work: Callable[[], None]) -> None:
        """Do some work here; what it raises is told."""
        try:
            work()
        except Exception as error:
            self._fault(error)


class Latest:
    """Calls `work` in a thread for the newest request; requests that come meanwhile lead to one more call.

    What the work raises is told by the `threads` of the session.
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
