"""The quantity that is compared: deviation of the payload's centre of mass, an actuator's deflection; its error."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array
from flexapod.model import ActuatorStudy, Study, override, preset
from flexapod.solve.shapes import actuator_shapes
from flexapod.solve.time.actuator_march import prepare_actuator
from flexapod.solve.time.recording import Counters
from flexapod.solve.time.robot_march import prepare

__all__ = ["GRID", "Curve", "Marched", "error", "marched", "reference", "rigid_centre", "roll", "undamped"]

GRID = 5e-5  # s, of reference curves: every step that is measured is a multiple of it


@dataclass(frozen=True)
class Curve:
    """Deviation (T, 3) [m], world axes, or deflection (T, 1) of an actuator's tip, at instants (T,) [s]."""

    time: Array
    deviation: Array


@dataclass(frozen=True, kw_only=True)
class Marched:
    """A run of the time integration alone: its curve, its counters, its seconds of wall and of process time."""

    curve: Curve
    counters: Counters
    wall: float
    process: float


def roll(**settings: object) -> Study:
    """The 2 s roll of `paper-robot`, three shapes a plane."""
    return override(preset("paper-robot"), **settings)  # type: ignore[arg-type]


def undamped(study: Study) -> Study:
    """The same without damping: Exudyn's cables have no counterpart of damping ratios."""
    legs = tuple(leg.replace(damping=0.0) for leg in study.robot.legs)
    return study.replace(robot=study.robot.replace(legs=legs))


def rigid_centre(study: Study, t: Array) -> Array:
    """Centre of mass of the payload with rigid legs at instants (T,), (T, 3) [m]."""
    path = kinematics.poses(study.robot, study.motion, t)
    return path.position + np.einsum("tij,j->ti", path.rotation, study.robot.payload.com)


def deflection(study: ActuatorStudy, amplitudes: Array) -> Array:
    """Deflection of the tip of a planar actuator of amplitudes (T, k), (T, 1) [m]."""
    return (amplitudes @ actuator_shapes(study.actuator, study.simulation).beam.a.tip)[:, None]


def marched(study: Study | ActuatorStudy) -> Marched:
    """Integrate a study; the start (equilibrium, kernel) is prepared before the clocks run."""
    run = prepare(study) if isinstance(study, Study) else prepare_actuator(study)
    times, found = [], []
    wall, process = time.perf_counter(), time.process_time()
    for chunk in run.chunks:
        times.append(chunk.recording.time)
        found.append(
            chunk.recording.pose[:, :3].copy() if isinstance(study, Study) else chunk.recording.q[:, 0, 2:].copy()
        )
    wall, process = time.perf_counter() - wall, time.process_time() - process
    t = np.concatenate(times)
    values = np.concatenate(found)
    values = values - rigid_centre(study, t) if isinstance(study, Study) else deflection(study, values)
    curve = Curve(t, values)
    return Marched(curve=curve, counters=run.counters, wall=wall, process=process)


def reference(study: Study) -> Curve:
    """Converged solution on the grid: half of it as step and a fourth, extrapolated at second order."""
    coarse, fine = (marched(override(study, step=GRID / k, output_step=GRID)).curve for k in (2, 4))
    return Curve(fine.time, fine.deviation + (fine.deviation - coarse.deviation) / 3)


def error(curve: Curve, true: Curve) -> float:
    """Largest distance of two deviations over the largest deviation; every instant of `curve` is one of `true`.

    Raises
    ------
    ValueError
        An instant lies between those of `true`.
    """
    at = np.rint(curve.time / (true.time[1] - true.time[0])).astype(int)
    if np.abs(true.time[at] - curve.time).max() > 1e-9:
        raise ValueError("an instant of the curve lies between those of the reference")
    apart = np.linalg.norm(curve.deviation - true.deviation[at], axis=1)
    return float(apart.max() / np.linalg.norm(true.deviation, axis=1).max())
