"""Which points go to a worker together, and what happens to those whose worker dies."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from flexapod.design.sweeps.executors import Executor, WorkerDied
from flexapod.design.sweeps.outputs import Kept
from flexapod.design.sweeps.worker import BatchResult, PointResult

TASK = 3.0  # seconds of work that a task should be: it costs Dask some milliseconds
LEAST = 0.25  # seconds of work of the last tasks: so long a thread may wait for the others
AHEAD = 2  # batches at a time for every thread, so that none waits for the next
MOST = 500  # points of a task
DEADLY = "the process that computed this point died, and did so again when it computed nothing else"


def results(executor: Executor, kept: Kept, todo: list[int], packed: Callable[[int], bytes]) -> Iterator[BatchResult]:
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
    """What is left to do, cut into batches by what a point has cost so far."""

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
