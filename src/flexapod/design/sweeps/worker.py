"""The work of a sweep: studies in, kept quantities out. This is what workers run; it knows neither store nor Dask."""

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
from flexapod.analysis.results.lazy_arrays import Asked
from flexapod.analysis.results.leg_results import damped_angles
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.analysis.results.robot_results import rigid_force_results, robot_results
from flexapod.analysis.results.time_history import collect
from flexapod.analysis.scalars import ROBOT_SCALARS, RobotRun
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError, FlexapodError
from flexapod.common.version import this_version
from flexapod.design.sweeps.outputs import ACTUATOR_SCALARS, Kept
from flexapod.model import ActuatorStudy, Study
from flexapod.solve.time.robot_march import prepare


class OtherVersion(ComputationError):
    """A worker runs another flexapod than the sweep."""


@dataclass(frozen=True, kw_only=True)
class PointResult:
    """Kept quantities by name, or why there are none; remarks on a result, a line each."""

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
    version: str, kept: Kept, points: Sequence[int], studies: Sequence[Study | ActuatorStudy]
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
    compute: Callable[..., BatchResult], version: str, kept: Kept, points: Sequence[int], packed: Sequence[bytes]
) -> BatchResult:
    """As `compute`, of pickled studies: Dask passes bytes on without looking into them."""
    refuse_other(version)  # before classes are read that may have changed
    return compute(version, kept, points, [pickle.loads(study) for study in packed])


def refuse_other(version: str) -> None:
    """Refuse to compute for another version of flexapod, or other sources of it, than this process has."""
    if version != this_version():
        raise OtherVersion(
            f"a worker runs flexapod {this_version()}, the sweep {version}",
            next_step="Give all workers the same version",
        )


def compute_point(kept: Kept, study: Study | ActuatorStudy) -> PointResult:
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


def _remarked(result: PointResult, kept: Kept, absent: Sequence[str]) -> PointResult:
    """The result with the reasons why some of its values are none."""
    words = [f"{name} has no value: {kept.absent[name]}" for name in absent]
    return replace(result, remarks="\n".join(filter(None, [result.remarks, *words])))


def _robot(kept: Kept, study: Study) -> PointResult:
    path = RigidPath(study)
    remarks = [*study.warnings, *check_path(study, path)]
    march = prepare(study)
    record = collect(march.chunks, damped_angles(march.system), study.duration, None)
    _refuse_partial(record.failure, record.interrupted, float(record.time[-1]))
    run = RobotRun(study, march.system, record, march.counters, path.at(record.time))
    values: dict[str, Array] = {name: np.asarray(ROBOT_SCALARS[name].value(run)) for name in kept.scalars}
    if kept.records:
        whole = Asked(robot_results(study, run.system, record, run.path) | rigid_force_results(run.path))
        values |= {name: whole[name][:: kept.every] for name in kept.records}
    remarks += robot_warnings(study.robot, march.system, record)
    return PointResult(values=values, remarks="\n".join(dict.fromkeys(remarks)))


def _actuator(kept: Kept, study: ActuatorStudy) -> PointResult:
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
