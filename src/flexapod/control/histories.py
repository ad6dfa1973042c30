"""Answers of a linear system over time to steps and impulses, exact at the instants, (T21.17)."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.units import quantity
from flexapod.control.discretization import held
from flexapod.control.poles import damping_of

if TYPE_CHECKING:
    from flexapod.control.state_space import StateSpace

__all__ = ["histories", "instants"]

DECAYS = 5.0  # time constants of the slowest motion
MOST = 100.0  # of its periods, where it hardly decays
PERIOD = 40  # instants in a period of the fastest oscillation that lasts
LONGEST = 1e7  # steps that a computer's memory takes
COUNT = 2000  # instants at most, where none are given


def instants(system: StateSpace, duration: float | None, step: float | None) -> Array:
    """Instants [s] from 0 on: as long as the slowest motion needs, as fine as the fastest oscillation, or as given."""
    if system.sample is not None:
        step = system.sample
    s, frequency, _ = damping_of(system.poles(), system.sample)
    moving = (frequency > 1e-9 * frequency.max(initial=0.0)) & np.isfinite(frequency)
    if duration is None:
        decay = np.maximum(np.abs(s.real[moving]), 1e-300)
        duration = float(np.minimum(MOST / frequency[moving], DECAYS / decay).max(initial=0.0)) or 1.0
    duration = quantity(duration, "time", key="duration")
    if not duration > 0:
        raise InputError("is not a time", key="duration", value=duration, allowed="above 0 s")
    if step is None:
        swings = moving & (s.imag > 0)
        fine = duration / COUNT
        step = max(fine, 1 / (PERIOD * frequency[swings].max())) if swings.any() else fine
    step = quantity(step, "time", key="step")
    if not 0 < step <= duration:
        raise InputError("is not a time", key="step", value=step, allowed=f"above 0 s, at most {duration:g} s")
    if duration > LONGEST * step:
        raise InputError("has too many steps", key="duration", value=duration, allowed=f"{LONGEST:.0e} steps at most")
    return np.asarray(step * np.arange(int(np.floor(duration / step * (1 + 1e-12))) + 1), dtype=float)


def histories(system: StateSpace, time: Array, *, impulse: bool) -> Array:
    """Outputs (outputs, inputs, time) after a unit step of each input at 0, or its impulse without feed-through."""
    n, m = system.B.shape
    found = np.empty((len(system.outputs), m, len(time)))
    rings = impulse and system.sample is None  # from where the impulse has thrown it
    moves = system if system.sample is not None else held(replace(system.select(), D_rate=None), time[1] - time[0])
    x = np.array(system.B) if rings else np.zeros((n, m))
    for i in range(len(time)):
        u = float(not impulse or (i == 0 and not rings)) * np.eye(m)
        found[:, :, i] = system.C @ x + system.D @ u
        x = moves.A @ x + moves.B @ u
    return found
