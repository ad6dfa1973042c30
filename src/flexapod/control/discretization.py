"""Sampling of continuous systems, and step and impulse responses, exact at the instants, (T21.17)-(T21.19).

Inputs are held between samples; delays have any length.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import expm

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.units import DIMENSIONS, quantity, to_si
from flexapod.control.frequency_response import oscillating_poles
from flexapod.control.state_space import RATE

if TYPE_CHECKING:
    from flexapod.control.state_space import StateSpace

LATEST = 1000  # samples that are remembered: of a delay, each with its states; of a function, that may come again
NEARLY = 1e-9  # of a period: a delay so near to whole samples has them


def period_of(sample: float | str) -> float:
    """Time between samples [s] of a number [s] or a text with the unit of a time or a frequency."""
    try:
        period = to_si(sample, "time", key="sample")
    except InputError:
        try:
            rate = to_si(sample, "frequency", key="sample")
        except InputError as error:
            allowed = 'a time, as 2e-4 [s] or "0.2 ms", or a rate, as "5 kHz"'
            raise InputError(error.what, key="sample", value=sample, allowed=allowed) from None
        period = 1.0 / rate if rate else 0.0
    if not DIMENSIONS["time"].least <= period <= DIMENSIONS["time"].most:
        raise InputError("is not a time", key="sample", value=sample, allowed='above 0 s, for example "5 kHz"')
    return period


def zero_order_hold(
    system: StateSpace, period: float, delay: float = 0.0, delayed: Sequence[int] | None = None
) -> StateSpace:
    """The system between samples, its inputs held, exactly: Eq. (T21.17); rates are last differences, Eq. (T21.19).

    `delay` [s] of the inputs `delayed` (all), Eq. (T21.18).
    """
    late = list(range(system.B.shape[1])) if delayed is None else list(delayed)
    system = _with_rates_beside(system)
    n, m = system.B.shape
    if abs(delay) <= NEARLY * period or not late:
        step, push = held_step(system.A, system.B, period)
        return without_rates(replace(system.select(), A=step, B=push, sample=period))
    if not 0 <= delay <= LATEST * period:
        raise InputError("is no delay", key="delay", value=delay, allowed=f"0 to {LATEST} samples of {period:g} s")
    whole = int(np.floor(delay / period + NEARLY))
    part = max(delay - whole * period, 0.0)
    step, push = held_step(system.A, system.B, period)
    now, _ = held_step(system.A, system.B, period - part)
    before = now @ held_step(system.A, system.B, part)[1]  # what an input still does that changes within the period
    cut = part > NEARLY * period
    length = whole + cut
    B, D = np.array(push), np.array(system.D)
    B[:, late], D[:, late] = 0.0, 0.0
    k = len(late)
    A = np.zeros((n + length * k, n + length * k))
    A[:n, :n] = step
    A[n + k :, n : n + (length - 1) * k] = np.eye((length - 1) * k)  # the newest first
    enters = np.vstack([B, np.zeros((length * k, m))])
    C = np.hstack([system.C, np.zeros((len(system.C), length * k))])
    oldest = slice(n + (length - 1) * k, n + length * k)
    A[:n, oldest] += (before if cut else push)[:, late]
    C[:, oldest] = system.D[:, late]
    if cut:
        fresh = push[:, late] - before[:, late]
        if length == 1:
            enters[:n, late] += fresh
        else:
            A[:n, n + (length - 2) * k : n + (length - 1) * k] += fresh
    enters[n : n + k, late] = np.eye(k)
    past = tuple(f"{system.inputs[i]} {j + 1} before" for j in range(length) for i in late)
    return without_rates(
        replace(system.select(), A=A, B=enters, C=C, D=D, states=(*system.states, *past), sample=period)
    )


def _with_rates_beside(system: StateSpace) -> StateSpace:
    """A system whose rates of inputs, if outputs follow some, are inputs of their own, which drive no states."""
    if system.D_rate is None:
        return system
    at = np.flatnonzero(system.D_rate.any(axis=0))
    return replace(
        system,
        B=np.hstack([system.B, np.zeros((len(system.A), at.size))]),
        D=np.hstack([system.D, system.D_rate[:, at]]),
        inputs=(*system.inputs, *(RATE + system.inputs[k] for k in at)),
        D_rate=None,
    )


def held_step(A: Array, B: Array, period: float) -> tuple[Array, Array]:
    """exp(A T) and the integral of exp(A t) B over a time T."""
    n, m = B.shape
    whole = np.asarray(expm(np.block([[A, B], [np.zeros((m, n + m))]]) * period), dtype=float)
    return whole[:n, :n], whole[:n, n:]


def without_rates(system: StateSpace) -> StateSpace:
    """A sampled system whose rates of readings are their last differences over the period, Eq. (T21.19)."""
    rates = [i for i, name in enumerate(system.inputs) if name.startswith(RATE)]
    if not rates or system.sample is None:
        return system
    kept = [i for i in range(len(system.inputs)) if i not in rates]
    read = [system.inputs[i].removeprefix(RATE) for i in rates]
    names = list(dict.fromkeys([*(system.inputs[i] for i in kept), *read]))
    places = np.zeros((len(rates), len(names)))
    places[np.arange(len(rates)), [names.index(name) for name in read]] = 1.0
    plain = np.zeros((len(kept), len(names)))
    plain[np.arange(len(kept)), [names.index(system.inputs[i]) for i in kept]] = 1.0
    B_rate, D_rate = system.B[:, rates] / system.sample, system.D[:, rates] / system.sample
    n, r = len(system.A), len(rates)
    return replace(
        system,
        A=np.block([[system.A, -B_rate], [np.zeros((r, n + r))]]),
        B=np.vstack([system.B[:, kept] @ plain + B_rate @ places, places]),
        C=np.hstack([system.C, -D_rate]),
        D=system.D[:, kept] @ plain + D_rate @ places,
        inputs=tuple(names),
        states=(*system.states, *(f"{name} before" for name in read)),
    )


DECAYS = 5.0  # time constants of the slowest motion
MOST = 100.0  # of its periods, where it hardly decays
PERIOD = 40  # instants in a period of the fastest oscillation that lasts
LONGEST = 1e7  # steps that a computer's memory takes
COUNT = 2000  # instants at most, where none are given


def instants(system: StateSpace, duration: float | None, step: float | None) -> Array:
    """Instants [s] from 0 on: as long as the slowest motion needs, as fine as the fastest oscillation, or as given."""
    if system.sample is not None:
        step = system.sample
    s, frequency, _ = oscillating_poles(system.poles(), system.sample)
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
    moves = (
        system
        if system.sample is not None
        else zero_order_hold(replace(system.select(), D_rate=None), time[1] - time[0])
    )
    x = np.array(system.B) if rings else np.zeros((n, m))
    for i in range(len(time)):
        u = float(not impulse or (i == 0 and not rings)) * np.eye(m)
        found[:, :, i] = system.C @ x + system.D @ u
        x = moves.A @ x + moves.B @ u
    return found
