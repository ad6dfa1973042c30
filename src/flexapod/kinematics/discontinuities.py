"""Instants at which commands and loads are not smooth; steps of the time integration end there, Eq. (T6.17)."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from flexapod.common.arrays import Array
from flexapod.kinematics.laws import S_CURVE_FRACTIONS, TRAPEZOID_FRACTIONS
from flexapod.model import (
    ActuatorStudy,
    AxisMotion,
    CombinedMotion,
    CsvLaw,
    CsvMotion,
    CsvWrench,
    ForceDrive,
    LoadLaw,
    Motion,
    MotionLaw,
    ProfileLaw,
    StepLaw,
    StepWrench,
    Study,
    WaypointMotion,
)
from flexapod.model import Wrench as WrenchLaw

_PHASES = {"trapezoid": TRAPEZOID_FRACTIONS, "s-curve": S_CURVE_FRACTIONS}
STRAIGHT = 1e-9  # a row is not a corner where a table's slope changes by less of its largest one: rounding of text


@dataclass(frozen=True, kw_only=True)
class Breaks:
    """Instants after t = 0 [s]: `jumps` of a commanded rate or acceleration, of a force or torque; `corners` of forces.

    A corner is a jump in the rate of a force or torque, which itself is continuous there.
    """

    jumps: tuple[float, ...] = ()
    corners: tuple[float, ...] = ()

    def __or__(self, other: Breaks) -> Breaks:
        """Union of both, each instant once, ascending."""
        jumps = {*self.jumps, *other.jumps}
        corners = {*self.corners, *other.corners} - jumps
        return Breaks(jumps=tuple(sorted(jumps)), corners=tuple(sorted(corners)))


def robot_breaks(study: Study, far: float | None = None) -> Breaks:
    """Breaks of a robot's commanded motion, of its load and of the force tables of its drives.

    Rows of a table with neighbours nearer than `far` [s] on both sides are samples of a curve and not corners; None:
    nearer than an output step.
    """
    far = study.simulation.stored_step if far is None else far
    found = motion_breaks(study.motion) | _load(study.load.wrench, far)
    for drive in {id(leg.drive): leg.drive for leg in study.robot.legs}.values():
        values = drive.force if isinstance(drive, ForceDrive) else getattr(drive, "torque", None)
        if values is not None and drive.time is not None:  # type: ignore[union-attr]
            found |= _table(drive.time, values, far)  # type: ignore[union-attr]
    moved = study.robot.base_motion
    if moved is not None and moved.of == "acceleration":
        ends = Breaks(jumps=(float(moved.time[-1]),)) if moved.values[-1].any() else Breaks()
        found |= _table(moved.time, moved.values, far) | ends
    return found


def actuator_breaks(study: ActuatorStudy, far: float | None = None) -> Breaks:
    """Breaks of the prescribed motion of an actuator and of its loads; `far` as above."""
    far, motion, load = study.simulation.stored_step if far is None else far, study.motion, study.load
    found = Breaks()
    for law in motion.laws:
        found |= _scalar(law)
    for given in (load.torque, load.force, load.elevation_torque, load.wrench):
        found |= _load(given, far)
    return found


def motion_breaks(motion: Motion) -> Breaks:
    """Jumps in rate or acceleration of a platform's path."""
    if isinstance(motion, AxisMotion | CombinedMotion):
        return _profile(motion.profile, 0.0, motion.duration)
    found = Breaks()
    if isinstance(motion, WaypointMotion):
        for first, last in zip(motion.times[:-1].tolist(), motion.times[1:].tolist(), strict=True):
            found |= _profile(motion.profile, first, last)
    return found


def _scalar(law: MotionLaw | None) -> Breaks:
    return _profile(law.law, 0.0, law.duration) if isinstance(law, ProfileLaw) else Breaks()


def _profile(profile: str, first: float, last: float) -> Breaks:
    """Jumps in the rate of `linear` and in the acceleration of `trapezoid`; the other profiles have none."""
    ends = _phases(profile, first, last) if profile in ("linear", "trapezoid") else []
    return Breaks(jumps=tuple(t for t in ends if t > 0))


def _phases(profile: str, first: float, last: float) -> list[float]:
    """Ends of the phases of a profile."""
    return [first, *(first + (last - first) * np.cumsum(_PHASES.get(profile, ())[:-1])).tolist(), last]


def path_knots(motion: Motion, duration: float) -> Array:
    """Instants from 0 to `duration` [s] between which a commanded path is one smooth function, ends included."""
    if isinstance(motion, CsvMotion):
        inner = motion.time.tolist()
    elif isinstance(motion, WaypointMotion):
        times = motion.times.tolist()
        inner = [t for span in itertools.pairwise(times) for t in _phases(motion.profile, *span)]
    else:
        inner = _phases(motion.profile, 0.0, motion.duration)
    return np.array([0.0, *sorted({t for t in inner if 0 < t < duration}), duration])


def _load(law: WrenchLaw | LoadLaw | None, far: float) -> Breaks:
    """Breaks of a wrench, a torque or a force."""
    if isinstance(law, StepLaw | StepWrench):
        return Breaks(jumps=(law.time,) if law.time > 0 else ())
    if isinstance(law, CsvWrench):
        return _table(law.time, law.wrench, far)
    if isinstance(law, CsvLaw):
        return _table(law.time, law.value, far)
    if isinstance(law, ProfileLaw) and law.law == "linear":
        return Breaks(corners=(law.duration,))
    return Breaks()


def _table(time: Array, values: Array, far: float) -> Breaks:
    """Breaks of a table (n,), (n,) or (n, m): two rows at one instant are a jump, a change of slope is a corner.

    Rows with neighbours nearer than `far` [s] on both sides are samples of a curve and not corners.
    """
    columns = values.reshape(len(time), -1)
    gap, rise = np.diff(time), np.diff(columns, axis=0)
    twice = gap == 0
    slope = np.where(twice[:, None], 0.0, rise / np.where(twice, 1.0, gap)[:, None])
    change = np.abs(np.diff(slope, axis=0, append=0.0)).max(axis=1)  # of the rows after the first; constant at the end
    bends = change > STRAIGHT * np.abs(slope).max(initial=0.0)
    alone = np.maximum(gap, np.append(gap[1:], np.inf)) >= far * (1 - 1e-6)
    jumps = time[1:][twice & (time[1:] > 0)]
    corners = time[1:][bends & alone & (time[1:] > 0)]
    return Breaks(jumps=tuple(jumps.tolist())) | Breaks(corners=tuple(corners.tolist()))
