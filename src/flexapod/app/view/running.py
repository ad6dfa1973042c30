"""A simulation in a thread of its own, which can be cancelled."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from flexapod import model

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["Run"]

REPORTS = 0.1  # least time between two reports of progress [s]


class Run:
    """One simulation.

    Parameters
    ----------
    study : Study or ActuatorStudy
    on_progress : callable
        Called with the run and the share of it that is done (0 to 1), at most ten times a second.
    on_end : callable
        Called once with the run and its result or the exception that ended it, also when it was cancelled; in the
        run's thread.
    """

    def __init__(
        self,
        study: model.Study | model.ActuatorStudy,
        on_progress: Callable[[Run, float], None],
        on_end: Callable[[Run, Dataset | BaseException], None],
    ) -> None:
        self.study, self._on_progress, self._on_end = study, on_progress, on_end
        self._cancelled = threading.Event()
        self._reported = 0.0
        self._thread = threading.Thread(target=self._run, name="flexapod-simulation", daemon=True)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def cancel(self) -> None:
        """Ask it to stop; it ends at the next chunk of steps."""
        self._cancelled.set()

    @property
    def cancelled(self) -> bool:
        """Whether it was asked to stop."""
        return self._cancelled.is_set()

    def _run(self) -> None:
        from flexapod import study

        try:
            found: Dataset | BaseException = study.run(self.study, progress=self._progress)
        except BaseException as error:
            found = error
        self._on_end(self, found)

    def _progress(self, reached: float, duration: float) -> None:
        if self.cancelled:
            raise KeyboardInterrupt  # a simulation keeps what it has and ends as after Ctrl-C
        if time.monotonic() - self._reported > REPORTS:
            self._reported = time.monotonic()
            self._on_progress(self, min(1.0, reached / duration) if duration > 0 else 1.0)
