"""Other programs, stopped with all that they have started; work shared with copies of this process."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

__all__ = ["call", "started"]

T = TypeVar("T")
R = TypeVar("R")


def call(
    command: Sequence[str], folder: Path, time_limit: float, environment: Mapping[str, str] | None = None
) -> tuple[str, int | None]:
    """Run a program in a folder of its own; what it said, and its exit code, or None if it was stopped.

    Parameters
    ----------
    command : sequence of str
    folder : Path
        Where it runs, and where a file takes up what it says.
    time_limit : float
        Seconds after which it is stopped.
    environment : mapping, optional
        Variables to be set.

    Raises
    ------
    OSError
        It cannot be started.
    """
    spoken = folder / "spoken.txt"
    with spoken.open("wb") as file:
        # A session of its own, so that whatever it starts can be stopped with it.
        process = subprocess.Popen(
            command, cwd=folder, env=os.environ | dict(environment or {}), stdin=subprocess.DEVNULL,
            stdout=file, stderr=subprocess.STDOUT, start_new_session=True,
        )  # fmt: skip
        try:
            code: int | None = process.wait(timeout=time_limit)
        except subprocess.TimeoutExpired:
            code = None
        finally:
            if process.poll() is None:
                _stop(process)
    return spoken.read_text(encoding="utf-8", errors="replace"), code


def _stop(process: subprocess.Popen[bytes]) -> None:
    if sys.platform == "win32":
        process.kill()
    else:
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def started(make: Callable[[T], R], given: Sequence[T], processes: int) -> Callable[[], list[R]]:
    """Begin with `make` of each of `given`, in copies of this process, each taking what comes next.

    What is returned, once called, takes part, and returns all of it in its order.

    Parameters
    ----------
    make : callable
        What it returns goes from process to process. What it raises in a copy is raised when this process tries again.
    given : sequence
    processes : int
        This one included; only one works where the system cannot copy processes. Not for processes with other threads
        at work: their locks would stay closed in the copies.
    """
    from multiprocessing import get_all_start_methods, get_context

    copies = min(processes, len(given)) - 1
    if copies < 1 or "fork" not in get_all_start_methods():
        return lambda: [make(what) for what in given]
    context = get_context("fork")
    taken, pipes = context.Value("i", 0), [context.Pipe(duplex=False) for _ in range(copies)]

    def work() -> dict[int, R]:
        done: dict[int, R] = {}
        while True:
            with taken.get_lock():
                i, taken.value = taken.value, taken.value + 1
            if i >= len(given):
                return done
            done[i] = make(given[i])

    def told(pipe: Connection) -> None:
        with suppress(BaseException):  # the pipe ends without a word
            pipe.send(work())
        os._exit(0)  # nothing that this process has open is closed twice

    for _, send in pipes:
        context.Process(target=told, args=(send,), daemon=True).start()
        send.close()

    def joined() -> list[R]:
        done = work()
        for receive, _ in pipes:
            with suppress(EOFError):
                done |= receive.recv()
        return [done[i] if i in done else make(what) for i, what in enumerate(given)]

    return joined
