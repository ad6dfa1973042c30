"""Work in the background where only the newest request matters."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

__all__ = ["Latest"]


class Latest:
    """Calls `work` in a thread for the newest request; requests that come meanwhile lead to one more call.

    Parameters
    ----------
    work : callable
        Without arguments; it must take care of its own errors.
    quiet : float
        Time without a request before the work begins [s].
    """

    def __init__(self, work: Callable[[], None], quiet: float = 0.0) -> None:
        self._work, self._quiet = work, quiet
        self._lock, self._asked, self._running, self._last = threading.Lock(), False, False, 0.0

    def request(self) -> None:
        """Ask for the work to be done with what holds from now on."""
        with self._lock:
            self._asked, self._last = True, time.monotonic()
            if self._running:
                return
            self._running = True
        threading.Thread(target=self._run, name="flexapod-latest", daemon=True).start()

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
                self._asked = False
            self._work()

    def _wait(self) -> float | None:
        """Time until the work may begin [s]; None, and the thread ends, where nothing is asked for."""
        with self._lock:
            self._running = self._asked
            return self._last + self._quiet - time.monotonic() if self._asked else None


def _nothing() -> None:
    """No work."""
