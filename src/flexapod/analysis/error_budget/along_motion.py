"""Rows of an error budget along a motion, Eqs. (T17.13)-(T17.15)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flexapod.analysis.error_budget.rows import (
    ToolDeviation,
    budget_rows,
    significant_rows,
    static_deviation,
    tool_deviation,
)
from flexapod.analysis.error_budget.rules import Budget
from flexapod.analysis.pose_errors.error_sources import ErrorRow
from flexapod.analysis.pose_errors.sensitivity import sensitivity
from flexapod.analysis.results.causes import cause_names
from flexapod.analysis.results.elongations import gap_elongations
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.analysis.results.time_history import Progress, Record
from flexapod.analysis.simulation import simulate_path
from flexapod.common.arrays import Array, Index
from flexapod.kinematics.leg_geometry import COORDINATES
from flexapod.model import Study
from flexapod.solve.modal.elastic_robot import ElasticRobot
from flexapod.solve.system import System

SAME = 1e-6  # static deviations that differ by less are alike
MOST = 400  # intervals at whose ends poses are looked at at rest


class AlongMotion(NamedTuple):
    """A budget, the instant [s] of the largest static deviation, of the largest dynamic one by component (6,)."""

    budget: Budget
    time: float
    peaks: Array
    remarks: list[str]


def along_motion(path: RigidPath, elastic: ElasticRobot, progress: Progress | None = None) -> AlongMotion:
    """Rows at rest at the pose of the largest static deviation, and of what is dynamic on the way.

    Raises
    ------
    InputError, ComputationError
        As `simulate`; a pose on the way has no equilibrium.
    """
    study, found = path.study, simulate_path(path, elastic, progress)
    if found.record.interrupted:
        raise KeyboardInterrupt
    if found.record.failure is not None:
        raise found.record.failure
    t = found.record.time
    path = found.recorded_path
    whole = _without_play(elastic.moving, path, found.record)
    still = _static(elastic, path)
    size = np.linalg.norm(still.whole[:, :3], axis=1)
    worst = int(np.argmax(size >= (1 - SAME) * size.max()))  # the first of those alike, as at a motion's end
    locked = elastic.lock(path.resting(slice(worst, worst + 1)))
    table, deviation, missing = budget_rows(study, locked)
    dynamic = ToolDeviation(whole.whole - still.whole, whole.by_leg - still.by_leg)  # (T17.13)
    peaks: Index = np.abs(dynamic.whole).argmax(axis=0)
    more, sums = _dynamic_rows(study, dynamic, peaks)
    budget = Budget(rows=[*table, *more], whole={"systematic": deviation, **sums})
    return AlongMotion(budget, float(t[worst]), t[peaks], [*found.warnings(), *missing])


def _without_play(system: System, path: RigidPath, record: Record) -> ToolDeviation:
    """The tool at the instants of a simulation, without the play that is a gap there and has rows of its own."""
    found, played = tool_deviation(system, path, record), gap_elongations(system, record.q)
    if played.any():
        shift = played[..., None] * sensitivity(path).coordinate[:, :, COORDINATES.index("l")]
        found.by_leg[:, cause_names(path.robot).index("drive")] -= shift
        found = found._replace(whole=found.whole - shift.sum(axis=1))  # (T17.16)
    return found


def _static(elastic: ElasticRobot, path: RigidPath) -> ToolDeviation:
    """The tool at rest at the poses of a path, a cubic spline between at most `MOST` + 1 of them."""
    t = path.time
    some = np.unique(np.linspace(0, len(t) - 1, min(len(t), MOST + 1)).round().astype(int))
    found = static_deviation(elastic, path, some)
    if len(some) == len(t):
        return found
    from scipy.interpolate import make_interp_spline

    flat = np.concatenate([found.whole, found.by_leg.reshape(len(some), -1)], axis=1)
    whole, by_leg = np.split(make_interp_spline(t[some], flat, k=3)(t), [6], axis=1)
    return ToolDeviation(whole, by_leg.reshape(len(t), *found.by_leg.shape[1:]))


def _dynamic_rows(study: Study, dynamic: ToolDeviation, at: Index) -> tuple[list[ErrorRow], dict[str, Array]]:
    """Rows at the instants of the whole's peak, and shares of its rms, Eqs. (T17.14)-(T17.15)."""
    each = np.arange(6)
    peak = dynamic.by_leg[at, :, :, each]  # (6, causes, legs)
    size = np.sqrt((dynamic.whole**2).mean(axis=0))
    rms = np.einsum("tclx,tx->clx", dynamic.by_leg, dynamic.whole) / len(dynamic.whole)
    rms = np.divide(rms, size, out=np.zeros_like(rms), where=size > 0)
    parts = {"dynamic_peak": np.moveaxis(peak, 0, -1), "dynamic_rms": rms}
    how = {
        "dynamic_peak": "simulation less static equilibrium, at the instant of the whole's largest size",
        "dynamic_rms": "simulation less static equilibrium: mean product with the whole, over its rms",
    }
    names = cause_names(study.robot)
    found = [
        row
        for kind, values in parts.items()
        for row in significant_rows([ErrorRow(n, kind, "", x, how[kind]) for n, x in zip(names, values, strict=True)])
    ]
    return found, {"dynamic_peak": dynamic.whole[at, each], "dynamic_rms": size}
