"""Executors of batches: this process, or workers of Dask, local or of a running cluster.

Points are cut into batches by measured times; those whose worker dies are computed once more, one at a time.
"""

from __future__ import annotations

import logging
import math
import os
import queue
import signal
import threading
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from multiprocessing import resource_tracker
from typing import TYPE_CHECKING, Any

from flexapod.common.errors import ComputationError, InputError
from flexapod.design.sweeps import worker as batch
from flexapod.design.sweeps.outputs import OutputSelection
from flexapod.design.sweeps.worker import BatchResult, OtherVersion, PointResult

if TYPE_CHECKING:
    from distributed import Client, Future

CONNECT = 10.0  # seconds to reach a scheduler
PATIENCE = 60.0  # seconds without any worker until the sweep gives up
LOOK = 1.0  # seconds between looks at the cluster
_ENDINGS = (signal.SIGINT, signal.SIGTERM)
LOST = "Nothing that was stored is lost: run the same command again to continue"
#: A connection remembers its last thousand messages: studies of many points, hundreds of megabytes.
FORGETFUL = {"distributed.admin.low-level-log-length": 10}
#: Of local workers: what Dask measures of itself takes some per cent of a core; who kills two processes is guilty.
QUIET: dict[str, str | bool | int] = {
    "distributed.admin.system-monitor.interval": "5s",
    "distributed.admin.tick.interval": "500ms",
    "distributed.scheduler.active-memory-manager.start": False,
    "distributed.scheduler.allowed-failures": 1,
    "distributed.scheduler.work-stealing": False,
    "distributed.worker.memory.monitor-interval": "1s",
    "distributed.worker.profile.enabled": False,
}


class WorkerDied(Exception):
    """Workers ended while they computed these points."""

    def __init__(self, points: tuple[int, ...]) -> None:
        self.points = points
        super().__init__(str(points))


class InProcess:
    """One batch after the other in this process, without Dask."""

    threads = 1

    def __init__(self, version: str) -> None:
        self._version = version
        self._waiting: list[tuple[OutputSelection, Sequence[int], Sequence[bytes]]] = []

    def submit(self, kept: OutputSelection, points: Sequence[int], packed: Sequence[bytes]) -> None:
        """Hand over a batch, points and their pickled studies; it is computed when its result is asked for."""
        self._waiting.append((kept, points, packed))

    def result(self) -> BatchResult:
        """Compute the oldest batch."""
        return batch.compute_packed(batch.compute_batch, self._version, *self._waiting.pop(0))


class DaskExecutor:
    """Batches as tasks of a Dask cluster.

    Parameters
    ----------
    client : distributed.Client
    version : str
        The flexapod that workers must run.
    """

    def __init__(self, client: Client, version: str) -> None:
        self._client, self._version = client, version
        self._done: queue.SimpleQueue[Future] = queue.SimpleQueue()
        self._points: dict[object, tuple[int, ...]] = {}
        self._seen = time.monotonic()  # when there was a worker last
        self._threads, self._looked = 0, -math.inf  # how many there were, and when

    @property
    def threads(self) -> int:
        """Threads of all workers that are there; asked of the scheduler once in a while."""
        if time.monotonic() - self._looked < LOOK:
            return self._threads
        try:
            self._threads = sum(self._client.nthreads().values())  # pyright: ignore[reportAttributeAccessIssue]
        except (OSError, TimeoutError):
            self._threads = 0
        self._looked = time.monotonic()
        if self._threads:
            self._seen = self._looked
        return self._threads

    def submit(self, kept: OutputSelection, points: Sequence[int], packed: Sequence[bytes]) -> None:
        """Hand over a batch: numbers of points, and their pickled studies."""
        try:
            future = self._client.submit(
                batch.compute_packed, batch.compute_batch, self._version, kept, tuple(points), packed, pure=False
            )
        except Exception as error:
            raise _lost(error) from None
        self._points[future.key] = tuple(points)
        future.add_done_callback(self._done.put)

    def result(self) -> BatchResult:
        """Wait for any batch.

        Raises
        ------
        WorkerDied
            Its workers ended, more than once.
        ComputationError
            Scheduler or workers are lost, or run another version.
        """
        from distributed import KilledWorker

        future = self._next()
        points = self._points.pop(future.key)
        try:
            return future.result(timeout=PATIENCE)
        except KilledWorker:
            raise WorkerDied(points) from None
        except OtherVersion:
            raise
        except Exception as error:
            raise _lost(error) from None

    def _next(self) -> Future:
        while True:
            with suppress(queue.Empty):
                return self._done.get(timeout=LOOK)
            if not self.threads and time.monotonic() - self._seen > PATIENCE:
                raise ComputationError(f"there has been no worker for {PATIENCE:g} s", next_step=LOST)
            if self._client.status in ("closed", "closing"):
                raise _lost(ConnectionError("the connection to the scheduler is closed"))


Executor = InProcess | DaskExecutor  # batches go in, results come out in any order


def _lost(error: BaseException) -> ComputationError:
    """Error for the user from a failed task, which is never the fault of a point."""
    from concurrent.futures import CancelledError as Cancelled

    if isinstance(error, Cancelled | OSError | TimeoutError) or "ancelled" in type(error).__name__:
        return ComputationError("the connection to the scheduler was lost", next_step=LOST)
    words = str(error).strip().split("\n")[0][:300]
    return ComputationError(
        f"a worker could not run a task ({type(error).__name__}: {words})",
        next_step=f"Workers need the same flexapod and Python packages. {LOST}",
    )


def local_cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def check_place(scheduler: object, workers: object) -> None:
    """Refuse a place that cannot be, before anything is read.

    Raises
    ------
    InputError
        Both are given, or what is given is neither a number of processes nor an address.
    """
    if scheduler is not None and not isinstance(scheduler, str):
        raise InputError("is not an address", key="scheduler", value=scheduler, allowed="such as tcp://10.0.0.1:8786")
    if workers is None:
        return
    if isinstance(workers, bool) or not isinstance(workers, int):
        raise InputError("is not a whole number", key="workers", value=workers, allowed="0 (this process) or more")
    if workers < 0:
        raise InputError("is out of range", key="workers", value=workers, allowed="0 (this process) or more")
    if scheduler is not None:
        raise InputError(
            "is given together with a scheduler, whose cluster has workers of its own", key="workers", value=workers
        )


@contextmanager
def executor(version: str, scheduler: str | None, workers: int | None) -> Iterator[Executor]:
    """Executor: `workers` local processes of one thread (default: one a core; 0: this process), or a cluster.

    Raises
    ------
    InputError
        Both are given, or there is no scheduler at that address.
    ComputationError
        Local workers do not start.
    """
    check_place(scheduler, workers)
    if workers == 0:
        yield InProcess(version)
        return
    with _silent(), _client(scheduler, workers or local_cores()) as client:
        yield DaskExecutor(client, version)


@contextmanager
def _client(scheduler: str | None, workers: int) -> Iterator[Client]:
    from dask import config
    from distributed import Client, LocalCluster

    if scheduler is not None:
        try:
            with config.set(FORGETFUL):
                client = Client(scheduler, timeout=CONNECT, set_as_default=False)
        except (OSError, ValueError) as error:
            words = str(error).strip().split("\n")[0]
            raise InputError(
                f"cannot be reached ({words})",
                key="scheduler",
                value=scheduler,
                allowed="such as tcp://10.0.0.1:8786",
                next_step="`dask scheduler` prints its address",
            ) from None
        with client:
            yield client
        return
    with config.set(FORGETFUL | QUIET):
        with ExitStack() as ends:
            with _undisturbed():
                try:
                    cluster = LocalCluster(
                        n_workers=workers, threads_per_worker=1, processes=True, host="127.0.0.1",
                        dashboard_address="127.0.0.1:0", silence_logs=logging.CRITICAL,
                    )  # fmt: skip
                except (RuntimeError, OSError) as error:
                    raise ComputationError(
                        f"local workers do not start: {error}", next_step="--workers 0 computes in this process"
                    ) from None
                ends.enter_context(cluster)
                client = ends.enter_context(Client(cluster, set_as_default=False))
                client.register_plugin(_heedless())
            yield client


@contextmanager
def _undisturbed() -> Iterator[None]:
    """Signals wait until workers have started: half started they, and Dask, end with many words.

    Processes that start here do not see Ctrl-C, which a terminal sends to all of its processes.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    waiting: list[int] = []
    before = {number: signal.signal(number, lambda n, _: waiting.append(n)) for number in _ENDINGS}
    mask = None
    if hasattr(signal, "pthread_sigmask"):
        resource_tracker.ensure_running()  # it unblocks signals when it starts
        mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        if mask is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        for number, handler in before.items():
            signal.signal(number, handler)
    if waiting:
        signal.raise_signal(waiting[0])


def _heedless() -> Any:
    """A plugin that lets Ctrl-C, which a terminal sends to all processes, end the sweep and not its workers first."""
    from distributed import WorkerPlugin

    class Heedless(WorkerPlugin):
        def setup(self, worker: object) -> None:
            with suppress(ValueError):
                signal.signal(signal.SIGINT, signal.SIG_IGN)

    return Heedless()


@contextmanager
def _silent() -> Iterator[None]:
    """Silence Dask while workers die and come back; the sweep reports it itself."""
    import distributed  # noqa: F401  (it sets the levels of its loggers when it is imported)

    loggers = [logging.getLogger(name) for name in ("distributed", "distributed.client", "distributed.nanny")]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", module="distributed")
            yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)


TASK = 3.0  # seconds of work that a task should be: it costs Dask some milliseconds
LEAST = 0.25  # seconds of work of the last tasks: so long a thread may wait for the others
AHEAD = 2  # batches at a time for every thread, so that none waits for the next
MOST = 500  # points of a task
DEADLY = "the process that computed this point died, and did so again when it computed nothing else"


def batch_results(
    executor: Executor, kept: OutputSelection, todo: list[int], packed: Callable[[int], bytes]
) -> Iterator[BatchResult]:
    """Results of the points `todo`, batch by batch, in the order in which they are done; `packed`: a point's study.

    Batches are as large as measured times suggest, and become smaller towards the end, so that no worker is idle long.
    Points whose worker died together are computed once more at the end, one at a time with nothing else under way: a
    point that ends its worker again is a failed one, and the others lose nothing but time.
    """
    batches = _Batches(todo)
    suspects: list[int] = []
    running = 0
    while running or batches.left:
        while batches.left and running < max(1, AHEAD * executor.threads):
            points = batches.take(executor.threads)
            executor.submit(kept, points, [packed(point) for point in points])
            running += 1
        running -= 1
        try:
            done = executor.result()
        except WorkerDied as death:
            suspects += death.points
            continue
        batches.learn(done)
        yield done
    for point in sorted(suspects):
        executor.submit(kept, [point], [packed(point)])
        try:
            yield executor.result()
        except WorkerDied:
            failed = PointResult(values={}, failure=DEADLY)
            yield BatchResult(points=(point,), results=(failed,), seconds=0.0)


class _Batches:
    """Remaining points, cut into batches by what a point has cost so far."""

    def __init__(self, todo: list[int]) -> None:
        self._todo, self._at = todo, 0
        self._points, self._seconds = 0, 0.0

    @property
    def left(self) -> int:
        """Points not handed out yet."""
        return len(self._todo) - self._at

    def take(self, threads: int) -> list[int]:
        """The next batch: single points until the first has come back."""
        rate = self._points / max(self._seconds, 1e-9)
        share = -(-self.left // (AHEAD * max(threads, 1)))
        size = min(int(TASK * rate), max(share, int(LEAST * rate)), MOST) if self._points else 1
        size = max(1, min(size, self.left))
        found = self._todo[self._at : self._at + size]
        self._at += size
        return found

    def learn(self, done: BatchResult) -> None:
        """Note what a batch has cost; old batches count less and less."""
        self._points = self._points / 2 + len(done.points)
        self._seconds = self._seconds / 2 + done.seconds
