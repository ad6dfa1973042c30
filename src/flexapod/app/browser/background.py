"""Background work of one session, and the log of the page's server.

An error is reported to the person whose work raised it; of several requests only the newest counts. The log
stays short enough to be read, whatever clients send.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable

from websockets.exceptions import WebSocketException


class Threads:
    """Threads of a session: an exception ends the thread that raised it, no other, and is given to `fault` there."""

    def __init__(self, fault: Callable[[BaseException], None]) -> None:
        self._fault = fault

    def start(self, name: str, work: Callable[[], None]) -> None:
        """Do some work in a thread of its own, ``flexapod-name``; it does not keep the program alive."""
        threading.Thread(target=self.run, args=(work,), name=f"flexapod-{name}", daemon=True).start()

    def run(self, work: Callable[[], None]) -> None:
        """Do some work here; an exception is reported."""
        try:
            work()
        except Exception as error:
            self._fault(error)


class Debouncer:
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
            self._threads.run(work)

    def _wait(self) -> float | None:
        """Time until the work may begin [s]; None, and the thread ends, where nothing is asked for."""
        with self._lock:
            self._running = self._asked
            return self._due - time.monotonic() if self._asked else None


def _nothing() -> None:
    """No work."""


MOST_LINES = 60
"""Entries at once; after that, one a second."""
LONGEST = 8_000
"""Longest entry [characters]."""


class LogLimiter(logging.Filter):
    """Filter that limits the rate of log entries, cuts long ones, and states how many it left out."""

    def __init__(self) -> None:
        super().__init__()
        self._left, self._since, self._dropped = float(MOST_LINES), time.monotonic(), 0

    def filter(self, record: logging.LogRecord) -> bool:
        """Decide whether an entry is written, and cut a long one."""
        now = time.monotonic()
        self._left, self._since = min(MOST_LINES, self._left + now - self._since), now
        if self._left < 1:
            self._dropped += 1
            return False
        self._left -= 1
        text = record.getMessage()
        if len(text) > LONGEST:
            text = f"{text[: LONGEST // 2]}\n...\n{text[-LONGEST // 2 :]}"
        if self._dropped:
            text = f"({self._dropped} entries were left out.) {text}"
        record.msg, record.args, self._dropped = text, None, 0
        return True


def _unexpected(record: logging.LogRecord) -> bool:
    """Test whether an entry reports more than a client that left or broke the protocol."""
    error = record.exc_info[1] if record.exc_info else None
    return not isinstance(error, WebSocketException | OSError | EOFError)


LOG = logging.getLogger("flexapod.view")
"""The log of the server and its sessions."""
CONNECTIONS = LOG.getChild("connections")
"""The log of what lies below them."""

FEW = LogLimiter()
LOG.addFilter(FEW)
CONNECTIONS.setLevel(logging.WARNING)  # who comes and goes is not told
CONNECTIONS.addFilter(_unexpected)
CONNECTIONS.addFilter(FEW)
