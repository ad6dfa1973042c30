"""Work of a sweep: studies in, stored quantities out, and the writer that takes results to the store.

Workers run `compute_packed`, which knows neither store nor Dask. The writer runs in the process of the sweep:
it stores the result of a point for all points with an equal study.
"""

from __future__ import annotations

import pickle
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

import numpy as np

from flexapod.analysis.actuator import simulate_actuator
from flexapod.analysis.checks.checks import check_path
from flexapod.analysis.checks.plausibility import robot_warnings
from flexapod.analysis.results.lazy_arrays import LazyArrays
from flexapod.analysis.results.leg_results import damped_angles
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.analysis.results.robot_results import rigid_force_results, robot_results
from flexapod.analysis.results.time_history import collect
from flexapod.analysis.scalars import ROBOT_SCALARS, RobotRun
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError, FlexapodError
from flexapod.common.version import this_version
from flexapod.design.sweeps.outputs import ACTUATOR_SCALARS, OutputSelection
from flexapod.design.sweeps.store import COMPUTED, FAILED, FLOAT, StoredPoint, SweepStore
from flexapod.model import ActuatorStudy, Study
from flexapod.solve.time.robot_march import prepare


class OtherVersion(ComputationError):
    """A worker runs another flexapod than the sweep."""


@dataclass(frozen=True, kw_only=True)
class PointResult:
    """Result of a point: stored quantities by name, or why there are none; remarks, a line each."""

    values: dict[str, Array]
    failure: str = ""
    remarks: str = ""


@dataclass(frozen=True, kw_only=True)
class BatchResult:
    """Results of points, in order, and the seconds that they took together."""

    points: tuple[int, ...]
    results: tuple[PointResult, ...]
    seconds: float


def compute_batch(
    version: str, kept: OutputSelection, points: Sequence[int], studies: Sequence[Study | ActuatorStudy]
) -> BatchResult:
    """Simulate the studies of points one after the other; what fails is a result like others.

    Raises
    ------
    OtherVersion
        This process runs another flexapod than the one that asks.
    """
    refuse_other(version)
    begin = perf_counter()
    results = tuple(compute_point(kept, study) for study in studies)
    return BatchResult(points=tuple(points), results=results, seconds=perf_counter() - begin)


def compute_packed(
    compute: Callable[..., BatchResult],
    version: str,
    kept: OutputSelection,
    points: Sequence[int],
    packed: Sequence[bytes],
) -> BatchResult:
    """Compute a batch of pickled studies; Dask passes bytes on without looking into them."""
    refuse_other(version)  # before classes are read that may have changed
    return compute(version, kept, points, [pickle.loads(study) for study in packed])


def refuse_other(version: str) -> None:
    """Refuse to compute for another version of flexapod, or other sources of it, than this process has."""
    if version != this_version():
        raise OtherVersion(
            f"a worker runs flexapod {this_version()}, the sweep {version}",
            next_step="Give all workers the same version",
        )


def compute_point(kept: OutputSelection, study: Study | ActuatorStudy) -> PointResult:
    """Simulate a study and keep of it what is asked for."""
    try:
        result = _robot(kept, study) if isinstance(study, Study) else _actuator(kept, study)
    except FlexapodError as error:
        return PointResult(values={}, failure=str(error))
    except Exception as error:  # one point must not end a sweep of thousands
        return PointResult(values={}, failure=f"unexpected {type(error).__name__}: {error} (a fault of flexapod)")
    endless = [name for name, value in result.values.items() if not np.isfinite(value).all()]
    for name in endless:
        if name not in kept.absent or np.isinf(result.values[name]).any():
            return PointResult(values={}, failure=f"{name} is not finite")
    return _remarked(result, kept, endless) if endless else result


def _remarked(result: PointResult, kept: OutputSelection, absent: Sequence[str]) -> PointResult:
    """The result with the reasons why some of its values are none."""
    words = [f"{name} has no value: {kept.absent[name]}" for name in absent]
    return replace(result, remarks="\n".join(filter(None, [result.remarks, *words])))


def _robot(kept: OutputSelection, study: Study) -> PointResult:
    path = RigidPath(study)
    remarks = [*study.warnings, *check_path(study, path)]
    march = prepare(study, path=path.series)
    record = collect(march.chunks, damped_angles(march.system), study.duration, None)
    _refuse_partial(record.failure, record.interrupted, float(record.time[-1]))
    run = RobotRun(study, march.system, record, march.counters, path.at(record.time))
    values: dict[str, Array] = {name: np.asarray(ROBOT_SCALARS[name].value(run)) for name in kept.scalars}
    if kept.records:
        whole = LazyArrays(robot_results(run.system, run.path, record) | rigid_force_results(run.path))
        values |= {name: whole[name][:: kept.every] for name in kept.records}
    remarks += robot_warnings(study.robot, march.system, record)
    return PointResult(values=values, remarks="\n".join(dict.fromkeys(remarks)))


def _actuator(kept: OutputSelection, study: ActuatorStudy) -> PointResult:
    data = simulate_actuator(study)
    if data.attrs["partial"]:
        _refuse_partial(data.attrs["failure"], False, float(data.time[-1]))
    values = {name: np.asarray(ACTUATOR_SCALARS[name].value(data)) for name in kept.scalars}
    values |= {name: data[name].values[:: kept.every] for name in kept.records}
    return PointResult(values=values, remarks=str(data.attrs["warnings"]))


def _refuse_partial(failure: Any, interrupted: bool, reached: float) -> None:
    """A simulation that stopped early is a failed point: its peaks are those of another time."""
    if interrupted:
        raise KeyboardInterrupt
    if failure is not None:
        raise ComputationError(f"the simulation stopped at t = {reached:.6g} s: {failure}")


OFTEN = 2.0  # seconds between two looks at the disk at least
SELDOM = 30.0  # at most, on however slow a disk
SHARE = 0.02  # of the time that writing may take
MOST_BYTES = 32 << 20  # of results that wait


class Writer:
    """Buffer of results that writes them when it is time; `flush` writes the rest.

    Parameters
    ----------
    store : SweepStore
    kept : OutputSelection
    alike : ndarray, shape (N,)
        The first point with an equal study, for every point.
    """

    def __init__(self, store: SweepStore, kept: OutputSelection, alike: Array) -> None:
        self._store, self._kept = store, kept
        order = np.argsort(alike, kind="stable")
        self._order, self._firsts = order, alike[order]
        self._waiting: list[StoredPoint] = []
        self._bytes, self._last, self._cost = 0, perf_counter(), 0.0

    def add(self, done: BatchResult) -> None:
        """Take the results of a batch."""
        for point, result in zip(done.points, done.results, strict=True):
            low, high = np.searchsorted(self._firsts, point, "left"), np.searchsorted(self._firsts, point, "right")
            row = self._row(point, result)
            self._waiting += (row._replace(point=copy) for copy in self._order[low:high].tolist())
            self._bytes += len(row.scalars) + sum(map(len, row.records))  # of rows that are alike once
        wait = max(OFTEN, min(SELDOM, self._cost / SHARE))
        if self._bytes > MOST_BYTES or perf_counter() - self._last > wait:
            self.flush()

    def flush(self) -> None:
        """Write the results that wait.

        Raises
        ------
        ComputationError
            The store cannot be written.
        """
        if not self._waiting:
            return
        begin = perf_counter()
        self._store.write(self._waiting)
        self._waiting = []
        self._bytes, self._last = 0, perf_counter()
        self._cost = self._last - begin

    def _row(self, point: int, result: PointResult) -> StoredPoint:
        if result.failure:
            return StoredPoint(point, FAILED, result.failure, b"", (b"",) * len(self._kept.records))
        scalars = b"".join(self._blob(name, result) for name in self._kept.scalars)
        records = tuple(self._blob(name, result) for name in self._kept.records)
        return StoredPoint(point, COMPUTED, result.remarks, scalars, records)

    def _blob(self, name: str, result: PointResult) -> bytes:
        return np.broadcast_to(result.values[name], self._kept.arrays[name].shape[1:]).astype(FLOAT).tobytes()
