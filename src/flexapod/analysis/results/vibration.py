"""Frequency, envelope and sag of a vibration whose frequency drifts, in windows that move along it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError


class Vibration(NamedTuple):
    """At instants `time` [s]: `frequency` [Hz], `envelope` (amplitude) and `sag` (mean) in the unit of the signal."""

    time: Array
    frequency: Array
    envelope: Array
    sag: Array


def local_vibration(time: Array, signal: Array, frequency: Array, count: int = 9) -> Vibration:
    """Fit of one drifting harmonic and a parabola in windows of three periods.

    Parameters
    ----------
    time, signal : (T,) arrays
        Equally spaced instants [s].
    frequency : (T,) array
        Expected frequency [Hz]; its drift is taken from here, its level is fitted within 20 %.
    count : int
        How many windows, their centres spread evenly.

    Raises
    ------
    InputError
        The signal is shorter than a window.
    """
    from scipy.optimize import minimize_scalar

    phase = np.concatenate([[0.0], np.cumsum(0.5 * (frequency[1:] + frequency[:-1]) * np.diff(time))])
    if phase[-1] < 3.2:
        raise InputError("is too short", key="signal", value=f"{phase[-1]:.3g} periods", allowed="more than 3.2")
    rows = []
    for centre in np.linspace(1.6, phase[-1] - 1.6, count):
        inside = np.abs(phase - centre) <= 1.5
        turns, y = phase[inside] - centre, signal[inside]
        found = minimize_scalar(_misfit, bounds=(0.8, 1.2), method="bounded", args=(turns, y), options={"xatol": 1e-9})
        ratio = float(found["x"])  # pyright: ignore
        c, _ = _fit(ratio, turns, y)
        at = np.interp(centre, phase, np.arange(len(time)))
        now = np.interp(at, np.arange(len(time)), time)
        rows.append((now, ratio * np.interp(now, time, frequency), np.hypot(c[3], c[4]), c[0]))
    return Vibration(*np.array(rows).T)


def _fit(ratio: float, turns: Array, y: Array) -> tuple[Array, float]:
    """Coefficients of 1, turns, turns^2, cos and sin; sum of squared residuals."""
    c, s = np.cos(2 * np.pi * ratio * turns), np.sin(2 * np.pi * ratio * turns)
    columns = np.stack([np.ones_like(turns), turns, turns**2, c, s], axis=1)
    found = np.asarray(np.linalg.lstsq(columns, y, rcond=None)[0], dtype=float)
    return found, float(np.sum((columns @ found - y) ** 2))


def _misfit(ratio: float, turns: Array, y: Array) -> float:
    return _fit(ratio, turns, y)[1]
