"""Laws of the study file at instants: rotation and extension of an actuator, torques, forces and wrenches."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from flexapod.common.arrays import Array
from flexapod.kinematics.laws import Law, constant_rate, rest_to_rest, spin_up, spline, spline_law
from flexapod.model import (
    ActuatorLoad,
    ConstantLaw,
    ConstantWrench,
    CsvLaw,
    CsvWrench,
    Load,
    LoadLaw,
    MotionLaw,
    ProfileLaw,
    RateLaw,
    SineLaw,
    SineWrench,
    SpinUpLaw,
    StepLaw,
)


def motion_law(law: MotionLaw, t: ArrayLike) -> Law:
    """Position, rate and acceleration of a scalar motion from 0, each shape (T,).

    Parameters
    ----------
    law : flexapod.model.MotionLaw
        A table is interpolated by `laws.spline` (quintic, at rest at both ends).
    t : array_like, shape (T,)
        Instants [s].
    """
    t = np.asarray(t, dtype=float)
    if isinstance(law, RateLaw):
        return constant_rate(t, rate=law.rate)
    if isinstance(law, SpinUpLaw):
        return spin_up(t, rate=law.rate, duration=law.duration)
    if isinstance(law, CsvLaw):
        return spline_law(t, spline(law.time, law.value), first=float(law.time[0]), last=float(law.time[-1]))
    return rest_to_rest(t, profile=law.law, amplitude=law.amplitude, duration=law.duration)


def _sine(t: Array, frequency: float, phase: float) -> Array:
    return np.sin(2 * np.pi * frequency * t + phase)


def load_law(law: LoadLaw, t: ArrayLike) -> Array:
    """Torque [N m] or force [N] at instants `t` (T,); a table is interpolated linearly and held at its ends."""
    t = np.asarray(t, dtype=float)
    if isinstance(law, ConstantLaw):
        return np.full_like(t, law.value)
    if isinstance(law, SineLaw):
        return law.amplitude * _sine(t, law.frequency, law.phase)
    if isinstance(law, StepLaw):
        return np.where(t >= law.time, law.amplitude, 0.0)
    if isinstance(law, ProfileLaw):
        return rest_to_rest(t, profile=law.law, amplitude=law.amplitude, duration=law.duration).position
    return np.interp(t, law.time, law.value)


def wrench(load: Load | ActuatorLoad, t: ArrayLike) -> Array:
    """Force [N] and moment [N m] at the tool, world axes, shape (T, 6); a table is interpolated linearly.

    Parameters
    ----------
    load : flexapod.model.Load or ActuatorLoad
    t : array_like, shape (T,)
        Instants [s].
    """
    t, law = np.atleast_1d(np.asarray(t, dtype=float)), load.wrench
    if law is None:
        return np.zeros((len(t), 6))
    if isinstance(law, ConstantWrench):
        return np.tile(law.value, (len(t), 1))
    if isinstance(law, CsvWrench):
        return np.stack([np.interp(t, law.time, column) for column in law.wrench.T], axis=1)
    scale = _sine(t, law.frequency, law.phase) if isinstance(law, SineWrench) else (t >= law.time).astype(float)
    return scale[:, None] * law.amplitude
