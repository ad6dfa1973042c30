"""Rows of an error budget along a motion, Eqs. (T17.13)-(T17.15)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flexapod import kinematics
from flexapod.analysis.error_budget.rows import Moved, at_rest, moved, rows, without_rounding
from flexapod.analysis.error_budget.rules import Budget
from flexapod.analysis.pose_errors.error_sources import ErrorRow
from flexapod.analysis.pose_errors.sensitivity import sensitivity
from flexapod.analysis.results.causes import cause_names
from flexapod.analysis.results.elongations import in_gap
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.analysis.results.time_history import Progress, Record
from flexapod.analysis.simulation import simulated
from flexapod.common.arrays import Array
from flexapod.kinematics.leg_geometry import COORDINATES
from flexapod.model import Robot, Study
from flexapod.solve.system import Index, System

SAME = 1e-6  # static deviations that differ by less are alike
MOST = 400  # intervals at whose ends poses are looked at at rest


class AlongMotion(NamedTuple):
    """A budget, the instant [s] of the largest static deviation, of the largest dynamic one by component (6,)."""

    budget: Budget
    time: float
    peaks: Array
    remarks: list[str]


def along_motion(study: Study, progress: Progress | None = None) -> AlongMotion:
    """Rows at rest at the pose of the largest static deviation, and of what is dynamic on the way.

    Raises
    ------
    InputError, ComputationError
        As `simulate`; a pose on the way has no equilibrium.
    """
    found = simulated(study, progress)
    if found.record.interrupted:
        raise KeyboardInterrupt
    if found.record.failure is not None:
        raise found.record.failure
    t = found.record.time
    path = found.path.at(t)
    whole = _without_play(study.robot, found.march.system, path, found.record)
    still = _static(study, path)
    size = np.linalg.norm(still.whole[:, :3], axis=1)
    worst = int(np.argmax(size >= (1 - SAME) * size.max()))  # the first of those alike, as at a motion's end
    pose = path.poses.part(slice(worst, worst + 1))
    table, deviation, missing = rows(study, kinematics.Poses.at_rest(pose.position, pose.rotation))
    dynamic = Moved(whole.whole - still.whole, whole.by_leg - still.by_leg)  # (T17.13)
    at: Index = np.abs(dynamic.whole).argmax(axis=0)
    more, sums = _dynamic_rows(study, dynamic, at)
    budget = Budget(rows=[*table, *more], whole={"systematic": deviation, **sums})
    return AlongMotion(budget, float(t[worst]), t[at], [*found.warnings(), *missing])


def _without_play(robot: Robot, system: System, path: RigidPath, record: Record) -> Moved:
    """The tool at the instants of a simulation but for the play that is a gap in it, which has rows of its own."""
    found, played = moved(robot, system, path, record), in_gap(system, record.q)
    if played.any():
        shift = played[..., None] * sensitivity(robot, path.poses).coordinate[:, :, COORDINATES.index("l")]
        found.by_leg[:, cause_names(robot).index("drive")] -= shift
        found = found._replace(whole=found.whole - shift.sum(axis=1))  # (T17.16)
    return found


def _static(study: Study, path: RigidPath) -> Moved:
    """The tool at rest at the poses of a path, a cubic spline between at most `MOST` + 1 of them."""
    t = path.time
    some = np.unique(np.linspace(0, len(t) - 1, min(len(t), MOST + 1)).round().astype(int))
    found = at_rest(study, path.poses.part(some), t[some])
    if len(some) == len(t):
        return found
    from scipy.interpolate import make_interp_spline

    flat = np.concatenate([found.whole, found.by_leg.reshape(len(some), -1)], axis=1)
    whole, by_leg = np.split(make_interp_spline(t[some], flat, k=3)(t), [6], axis=1)
    return Moved(whole, by_leg.reshape(len(t), *found.by_leg.shape[1:]))


def _dynamic_rows(study: Study, dynamic: Moved, at: Index) -> tuple[list[ErrorRow], dict[str, Array]]:
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
        for row in without_rounding([ErrorRow(n, kind, "", x, how[kind]) for n, x in zip(names, values, strict=True)])
    ]
    return found, {"dynamic_peak": dynamic.whole[at, each], "dynamic_rms": size}
