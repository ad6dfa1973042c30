"""Other programs, and copies of this process that share its work; none of them outlives it."""

from __future__ import annotations

import os
import select
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.process import BaseProcess

T = TypeVar("T")
R = TypeVar("R")
ENDINGS = [signal.Signals[name] for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
GENTLE = 10.0  # seconds that a copy has to put its files away before it is killed


def run_program(
    command: Sequence[str], folder: Path, time_limit: float, environment: Mapping[str, str] | None = None
) -> tuple[str, int | None]:
    """Run a program in a folder of its own; what it said, and its exit code, or None if it was stopped.

    It ends, with all that it has started, when this process does.

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
    return run_programs([command], folder, time_limit, environment)[0]


def run_programs(
    commands: Sequence[Sequence[str]], folder: Path, time_limit: float, environment: Mapping[str, str] | None = None
) -> list[tuple[str, int | None]]:
    """Run programs side by side; of each what `run_program` returns of one."""
    spoken = [folder / f"spoken{k}.txt" for k in range(len(commands))]
    end, codes, processes = time.monotonic() + time_limit, [], []
    with _guard() as group:
        try:
            for path, command in zip(spoken, commands, strict=True):
                with path.open("wb") as file:
                    processes.append(subprocess.Popen(
                        command, cwd=folder, env=os.environ | dict(environment or {}), stdin=subprocess.DEVNULL,
                        stdout=file, stderr=subprocess.STDOUT, process_group=group,
                    ))  # fmt: skip
            codes = [_waited(process, end - time.monotonic()) for process in processes]
        finally:
            for process in processes:
                if process.poll() is None:
                    _stop(process, group)
    said = (path.read_text(encoding="utf-8", errors="replace") for path in spoken)
    return list(zip(said, codes, strict=True))


def _waited(process: subprocess.Popen[bytes], seconds: float) -> int | None:
    end = time.monotonic() + seconds
    if sys.platform == "linux":  # elsewhere it is asked each 50 ms
        with suppress(OSError):  # a kernel before 5.3
            ended, watch = os.pidfd_open(process.pid), select.poll()
            try:
                watch.register(ended, select.POLLIN)
                watch.poll(1e3 * max(seconds, 0.0))
            finally:
                os.close(ended)
    with suppress(subprocess.TimeoutExpired):
        return process.wait(timeout=max(end - time.monotonic(), 0.0))
    return None


@contextmanager
def _guard() -> Iterator[int | None]:
    """A group of processes to start a program in; a shell, its leader, kills all of it once this process is gone."""
    if sys.platform == "win32":
        yield None
        return
    guard = subprocess.Popen(
        ["/bin/sh", "-c", "read -r _; kill -s KILL 0"],
        stdin=_lifeline()[0], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, process_group=0,
    )  # fmt: skip
    try:
        yield guard.pid
    finally:
        guard.kill()
        guard.wait()


def _stop(process: subprocess.Popen[bytes], group: int | None) -> None:
    if sys.platform == "win32" or group is None:
        process.kill()
    else:
        os.killpg(group, signal.SIGKILL)
    process.wait()


@cache
def _lifeline() -> tuple[int, int]:
    """Two ends of a pipe: to read from the first ends when this process does, which alone holds the second."""
    return os.pipe()


def _follow() -> None:
    """End a copy with the process that it was copied from, whatever this one is doing then."""
    read, write = _lifeline()
    os.close(write)
    _lifeline.cache_clear()

    def wait() -> None:
        os.read(read, 1)
        os._exit(1)

    threading.Thread(target=wait, daemon=True).start()


@contextmanager
def _later(signals: Iterable[int]) -> Iterator[None]:
    """Signals wait while a copy is made: one that comes right then ends neither half a start nor half a copy."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, signals)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def forked_map(make: Callable[[T], R], given: Sequence[T], processes: int) -> Iterator[Callable[[], list[R]]]:
    """Begin with `make` of each of `given`, in copies of this process, each taking what comes next.

    What the block is given, once called, takes part, and returns all of it in its order. Copies end with the block, or
    with this process if it is killed.

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

    count = min(processes, len(given)) - 1
    if count < 1 or "fork" not in get_all_start_methods():
        yield lambda: [make(what) for what in given]
        return
    context = get_context("fork")
    taken, pipes = context.Value("i", 0), [context.Pipe(duplex=False) for _ in range(count)]
    _lifeline()  # made here, so that copies have it

    def work() -> dict[int, R]:
        done: dict[int, R] = {}
        while True:
            with taken.get_lock():
                i, taken.value = taken.value, taken.value + 1
            if i >= len(given):
                return done
            done[i] = make(given[i])

    def send_results(pipe: Connection) -> None:
        with suppress(BaseException):  # the pipe ends without a word
            signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDINGS)  # only what happens here ends it
            _follow()
            pipe.send(work())
        os._exit(0)  # nothing that this process has open is closed twice

    def gather_results() -> list[R]:
        done = work()
        for receive, _ in pipes:
            with suppress(EOFError):
                done |= receive.recv()
        return [done[i] if i in done else make(what) for i, what in enumerate(given)]

    copies = [context.Process(target=send_results, args=(send,), daemon=True) for _, send in pipes]
    try:
        for copy, (_, send) in zip(copies, pipes, strict=True):
            with _later(ENDINGS):
                copy.start()
            send.close()
        yield gather_results
    finally:
        _end(copies)
        for end in (end for pipe in pipes for end in pipe):
            end.close()


def _end(copies: Sequence[BaseProcess]) -> None:
    """End copies that have been started, with time to put their files away."""
    for copy in (copy for copy in copies if copy.pid is not None):
        copy.terminate()
        copy.join(GENTLE)
        copy.kill()
        copy.join()
