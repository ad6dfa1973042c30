"""A sweep from its files to its Dataset."""

from __future__ import annotations

import logging
import math
import multiprocessing
import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from flexapod.analysis.checks.resource_limits import check_memory, check_room
from flexapod.analysis.results.arguments import read_subject
from flexapod.analysis.results.time_history import Report
from flexapod.common.errors import ComputationError, InputError
from flexapod.common.version import this_version
from flexapod.design.sweeps.executors import batch_results, check_place, executor, local_cores
from flexapod.design.sweeps.outputs import OutputSelection, select_outputs, store_layout
from flexapod.design.sweeps.plan import read_plan
from flexapod.design.sweeps.refusals import check_header, no_store, read_only_store
from flexapod.design.sweeps.result import as_dataset, store_file
from flexapod.design.sweeps.samples import Points, Resolved
from flexapod.design.sweeps.store import COMPUTED, StoreLayout, SweepStore, store_lock
from flexapod.design.sweeps.worker import BatchResult, PointResult, Writer
from flexapod.design.sweeps.zarr_folder import is_sweep, save_zarr
from flexapod.model import ActuatorStudy, Study
from flexapod.solve.robot_system import robot_system
from flexapod.solve.time.actuator_march import prepare_actuator
from flexapod.solve.time.native import loops

if TYPE_CHECKING:
    from xarray import Dataset

READING = 0.05  # share of the bar for reading the points
KERNELS = 8  # compiled before the sweep begins; of more, each has few points, and workers compile side by side
_log = logging.getLogger("flexapod")


class SweepStopped(KeyboardInterrupt):
    """The user stopped a sweep; `dataset` holds what was computed, the rest of its points are pending."""

    def __init__(self, dataset: Dataset) -> None:
        self.dataset = dataset
        done = int((dataset.status != "pending").sum())
        super().__init__(f"stopped after {done} of {dataset.sizes['point']} points")


def sweep(
    study: Study | ActuatorStudy | str | Path,
    sweep: str | Path | Mapping[str, Any],
    *,
    store: str | Path | None = None,
    scheduler: str | None = None,
    workers: int | None = None,
    retry_failed: bool = False,
    progress: Report | None = None,
) -> Dataset:
    """Many variants of a study: grids, lists, Latin hypercubes, random tolerances; see docs/sweep.md.

    Parameters
    ----------
    study : Study, ActuatorStudy or path
    sweep : path or mapping
        A sweep file, or a dictionary with the same content.
    store : path, optional
        SQLite file of the results, such as ``sweep.sqlite``; one that exists is continued. ``sweep.zarr``: the same
        file, and at the end its content as a Zarr folder. None: results are kept in memory only.
    scheduler : str, optional
        Address of a running Dask scheduler.
    workers : int, optional
        Local processes; default: one a core; 0: this one. Workers import the script that calls this: there it stands
        under ``if __name__ == "__main__":``.
    retry_failed : bool
        Compute points again that failed before.
    progress : callable, optional
        Called with words and the share of the whole that is done.

    Returns
    -------
    xarray.Dataset
        Dimension `point`; coordinates: the keys that vary, SI; `status`, `message`, `remarks`, and what is kept (NaN at
        failed points). `flexapod.design.sweeps.unstacked` gives it a dimension for each key.

    Raises
    ------
    InputError
        A key or value that no study has, a store of something else, a scheduler that is not there.
    ComputationError
        The store is in use or cannot be written, or workers are lost; what was stored stays valid.
    SweepStopped
        By Ctrl-C.

    Examples
    --------
    >>> variants = {"vary": [{"key": "leg.piston.diameter", "values": ["27 mm", "38.2 mm"]}]}
    >>> data = fx.sweep(fx.preset("paper-robot"), variants, workers=0)
    >>> thin, thick = data.com_deviation_peak.values
    >>> print(f"twice the area, {thick / thin:.2f} of the deviation")
    twice the area, 0.50 of the deviation
    """
    _refuse_import_by_worker()
    check_place(scheduler, workers)
    path, folder = (None, None) if store is None else _place(store)
    tell, points = progress or (lambda words, share: None), Points(_nominal(study), read_plan(sweep))
    resolved = points.resolve(lambda share: tell("reading the points", READING * share))
    keep = _select_outputs(points, resolved)
    _check_room(points, resolved, keep, path, 1 if scheduler else local_cores() if workers is None else workers)
    with _opened(path, store_layout(points, keep, resolved)) as opened:
        stopped = _Job(points, resolved, keep, opened).run(scheduler, workers, retry_failed=retry_failed, tell=tell)
        data = as_dataset(opened)
    if folder:
        save_zarr(data, folder)
    if stopped:
        raise SweepStopped(data)
    return data


def _nominal(study: object) -> Study | ActuatorStudy:
    """The study that others vary from."""
    nominal = read_subject(study)
    if not isinstance(nominal, Study | ActuatorStudy):
        raise InputError(
            "is not a study", key="study", value=type(study).__name__, allowed="the result of flexapod.load"
        )
    return nominal


def _place(store: object) -> tuple[Path, Path | None]:
    """File of the store, which needs a name, and the Zarr folder where one is wanted."""
    path = Path(store) if isinstance(store, str | os.PathLike) else Path()
    if not path.name or path.name == "..":
        raise InputError("names no file", key="store", value=str(store), allowed='such as "sweep.sqlite"')
    file, wanted = store_file(path), path.suffix == ".zarr"
    folder = path.with_suffix(".zarr") if file.suffix == ".sqlite" else path
    if is_sweep(folder) and not file.is_file():
        raise read_only_store(folder)
    if wanted and folder.exists() and not is_sweep(folder):
        raise no_store(folder)
    return file, folder if wanted else None


def _refuse_import_by_worker() -> None:
    """A worker imports the script that asked for it; there a sweep must not begin again."""
    if getattr(multiprocessing.current_process(), "_inheriting", False):
        raise ComputationError(
            "a sweep with workers is called where its workers import it",
            next_step='Put the call under `if __name__ == "__main__":`, or give workers=0',
        )


def _select_outputs(points: Points, resolved: Resolved) -> OutputSelection:
    try:
        return select_outputs(points.plan.keep, points.nominal, resolved)
    except InputError as error:
        raise error.with_location(file=points.plan.file) from None


def _check_room(points: Points, resolved: Resolved, keep: OutputSelection, path: Path | None, workers: int) -> None:
    """Refuse more results at a time than the memory holds, more records than the store can."""
    try:
        check_memory(points.study(resolved.largest), max(1, min(workers, len(points))))
    except InputError as error:
        raise error.with_location(file=points.nominal.path) from None
    check_room(
        sum(8.0 * math.prod(array.shape) for array in keep.arrays.values()),
        None if path is None else path.parent,
        file=points.plan.file,
        key="keep",
        next_step="Keep fewer records, or give [keep] a longer record_step",
    )


@contextmanager
def _opened(path: Path | None, wanted: StoreLayout) -> Iterator[SweepStore]:
    """The store, of these points and of nobody else, with every row as it was written."""
    with store_lock(path), SweepStore.open_or_create(path, wanted) as found:
        check_header(path, found.layout.header, wanted.header)
        if lost := found.drop_damaged_rows():
            _log.warning("Results of %d points in %s are lost (was the power off?): computed again", lost, path)
        yield found


@dataclass(frozen=True)
class _Job:
    """Points to compute, and where their results go."""

    points: Points
    resolved: Resolved
    kept: OutputSelection
    store: SweepStore

    def run(
        self, scheduler: str | None, workers: int | None, *, retry_failed: bool, tell: Callable[[str, float], None]
    ) -> bool:
        """Compute the remaining points; return whether the user stopped it. Results that came are always stored."""
        left = np.ones(len(self.resolved.first), dtype=bool)
        left[[row.point for row in self.store.points() if row.state == COMPUTED or not retry_failed]] = False
        todo = np.unique(self.resolved.first[left]).tolist()
        with suppress(KeyboardInterrupt):
            self._compute(todo, scheduler, workers, tell)
            return False
        return True

    def _compute(
        self, todo: list[int], scheduler: str | None, workers: int | None, tell: Callable[[str, float], None]
    ) -> None:
        writer = Writer(self.store, self.kept, self.resolved.first)
        with ExitStack() as ends:
            ends.callback(writer.flush)
            writer.add(self._refused(todo))
            todo = [point for point in todo if point not in self.resolved.refused]
            self.points.forget_others(todo)
            if not todo:
                return
            tell("preparing", READING)
            self._compile()
            clock = _Clock(len(todo), tell)
            work = ends.enter_context(executor(this_version(), scheduler, workers))
            for done in batch_results(work, self.kept, todo, self.points.pickled_study):
                writer.add(done)
                clock.count(len(done.points))

    def _refused(self, todo: list[int]) -> BatchResult:
        """Failed results of the points whose study is refused."""
        wanted = set(todo)
        found = {point: message for point, message in self.resolved.refused.items() if point in wanted}
        failed = tuple(PointResult(values={}, failure=message) for message in found.values())
        return BatchResult(points=tuple(found), results=failed, seconds=0.0)

    def _compile(self) -> None:
        """Compile kernels here, once, so that no two workers do it at the same time; of many kinds, the first ones."""
        for point in islice(self.resolved.settings.values(), KERNELS):
            study = self.points.study(point)
            if isinstance(study, Study):
                kernel = robot_system(study.robot, study.simulation, 0.0).kernel
                if kernel.library is not None:
                    loops(kernel)
            else:
                prepare_actuator(study)


class _Clock:
    """Progress as text: points done, rate, remaining time."""

    def __init__(self, whole: int, tell: Callable[[str, float], None]) -> None:
        self._whole, self._tell, self._done, self._begin = whole, tell, 0, perf_counter()
        tell(f"0 of {whole} points", READING)

    def count(self, points: int) -> None:
        """Report a number of further points as done."""
        self._done += points
        rate = self._done / max(perf_counter() - self._begin, 1e-9)
        left = (self._whole - self._done) / rate
        words = f"{self._done} of {self._whole} points, {rate:.3g}/s, {_duration(left)} left"
        self._tell(words, READING + (1 - READING) * self._done / self._whole)


def _duration(seconds: float) -> str:
    if seconds < 100:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 6000 else f"{seconds / 3600:.1f} h"
