"""Threads of one session: what goes wrong in one of them is told to the person whose session it is."""

from __future__ import annotations

import threading
from collections.abc import Callable

__all__ = ["Threads"]


class Threads:
    """Starts the threads of a session; an exception ends the thread that raised it, and nothing else.

    Parameters
    ----------
    fault : callable
        Called with the exception, in the thread that raised it.
    """

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
