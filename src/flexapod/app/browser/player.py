"""What moves a scene by itself: one thread at a time, whoever started it."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

from flexapod.app.browser.background import Threads
from flexapod.app.browser.scene import PageScene

FRAME = 1 / 25  # time between two steps [s]


class Player:
    """Steps at a fixed rate until it is stopped, the step says so, or something else takes the scene.

    The `driver` of the scene says who moves it. `step` is called with the time since the step before [s], under `lock`,
    and returns whether there is more to come; `told` with True at the start and False at the end.
    """

    def __init__(
        self,
        scene: PageScene,
        threads: Threads,
        lock: threading.RLock,
        step: Callable[[float], bool],
        told: Callable[[bool], None],
    ) -> None:
        self._scene, self._threads, self._lock, self._step, self._told = scene, threads, lock, step, told
        self._token: object = None  # of the run that is going on

    @property
    def playing(self) -> bool:
        """Whether the scene moves by this player."""
        return self._token is not None and self._scene.driver is self._token

    def start(self) -> None:
        """Begin to step; whoever else moves the scene stops."""
        with self._lock:
            if self.playing:
                return
            token = self._token = self._scene.driver = object()
            self._told(True)
            self._threads.start("play", lambda: self._run(token))

    def stop(self) -> None:
        """Step no more."""
        with self._lock:
            if self.playing:
                self._scene.driver = None
                self._token = None
                self._told(False)

    def close(self) -> None:
        """Stop and say nothing: what would be told is gone."""
        self._told = _nothing
        if self.playing:
            self._scene.driver = None

    def _run(self, token: object) -> None:
        before, more = time.perf_counter(), True
        try:
            while more and self._scene.driver is token:
                now = time.perf_counter()
                with self._lock, self._scene.lock:  # who takes the scene meanwhile has the last word
                    if self._scene.driver is token:
                        more = self._step(now - before)
                before = now
                time.sleep(max(0.0, FRAME - (time.perf_counter() - now)))
        finally:
            with self._lock:
                if self._scene.driver is token:
                    self._scene.driver = None
                if self._token is token:
                    self._token = None
                    self._told(False)


def _nothing(playing: bool) -> None:
    """Nobody is told."""
