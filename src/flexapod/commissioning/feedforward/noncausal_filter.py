"""Inputs that a linear system needs for a wanted output, bounded, before it moves and after, Eqs. (T22.20)-(T22.22)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.control import StateSpace

__all__ = ["Inverse", "answer", "inverse"]

DECAY = 16.0  # time constants of the slowest zero before and after: e^-16 = 1e-7
MOST = 2**19  # instants
FINE = 60  # instants in the time of the fastest zero that the output can ask for
LEAST = 2048  # instants while the output moves
IMAGINARY = 1e-6  # of its size: a zero is on the axis
FREE = 1e-2  # of the response a thousand times as fast
KEPT = 1e-6  # of its largest size: of the input before and after what counts

Complex = NDArray[np.complex128]


@dataclass(frozen=True, kw_only=True)
class Inverse:
    """An input at instants ``time`` (n,) [s], 0 where the output begins to move: ``value`` (n,), and ``zeros`` [1/s].

    ``before``, ``after`` [s]: how long it acts while the output does not move yet and no longer.
    """

    time: Array
    value: Array
    zeros: Complex
    before: float
    after: float


def inverse(system: StateSpace, moving: float, bend: Callable[[Array], Array]) -> Inverse:
    """The bounded input of a system of one input and one output that moves freely at rest, Eq. (T22.20).

    Parameters
    ----------
    system : StateSpace
        Its output is a place: input over its second derivative is finite where nothing changes.
    moving : float
        How long the output moves, from rest to rest [s].
    bend : callable
        Second derivative of the output at instants (T,) from 0 to `moving`.

    Raises
    ------
    InputError
        Several channels; zeros on the imaginary axis: what is bounded would never end.
    """
    if len(system.inputs) != 1 or len(system.outputs) != 1 or system.sample is not None:
        raise InputError("is not a continuous system of one input and one output", key="system")
    zeros = system.zeros()
    zeros = zeros[np.abs(zeros) > 0]
    if (np.abs(zeros.real) <= IMAGINARY * np.abs(zeros)).any():
        worst = zeros[np.argmin(np.abs(zeros.real) / np.abs(zeros))]
        raise InputError(
            f"has a zero at {worst.real:.3g} {worst.imag:+.3g}i 1/s, on the imaginary axis: its input would never end",
            key="order",
            value="stable-inversion",
            allowed="zeros beside the axis: give what vibrates some damping",
        )
    ahead, behind = (_lasts(zeros[way * zeros.real > 0]) for way in (1, -1))
    whole = ahead + moving + behind
    fast = max([abs(z) for z in zeros if abs(z) < LEAST / moving], default=0.0)
    step = min(moving / LEAST, 2 * np.pi / (FINE * fast) if fast else np.inf)
    count = min(MOST, int(2 ** np.ceil(np.log2(whole / step))))
    step = whole / count
    time: Array = (step * np.arange(count) - ahead).astype(float)
    inside = (time >= 0) & (time <= moving)
    wanted = np.where(inside, bend(np.clip(time, 0.0, moving)), 0.0)
    hz = np.fft.rfftfreq(count, step).astype(float)
    value = np.fft.irfft(np.fft.rfft(wanted) / _bends(system, hz), count)  # (T22.20)
    acting = np.flatnonzero(np.abs(value) > KEPT * np.abs(value).max())
    first, last = float(time[acting[0]]), float(time[acting[-1]])
    kept = (time >= min(first, 0.0)) & (time <= max(last, moving))
    return Inverse(
        time=time[kept], value=value[kept], zeros=zeros, before=max(0.0, -first), after=max(0.0, last - moving)
    )


def _lasts(zeros: Complex) -> float:
    """How long inputs of these zeros last [s]."""
    return DECAY / float(np.abs(zeros.real).min()) if zeros.size else 0.0


def _bends(system: StateSpace, hz: Array) -> Complex:
    """Second derivative of the output over the input at frequencies, the first of which is 0, Eq. (T22.21)."""
    s = 2j * np.pi * hz
    found = np.empty(len(hz), dtype=complex)
    found[1:] = s[1:] ** 2 * system.at(hz[1:])[0, 0]
    low = 1e-3 * hz[1]  # the double pole at rest cancels in the limit
    found[0] = (2j * np.pi * low) ** 2 * system.at([low])[0, 0, 0]
    if not abs(found[0]) > FREE * np.abs(found[1:3]).max():
        raise InputError(
            "does not move freely: where nothing changes its input would have to hold it",
            key="system",
            allowed="an input whose force, or acceleration, is in proportion to that of the output when slow",
        )
    return found


def answer(system: StateSpace, time: Array, value: Array) -> Array:
    """Outputs (outputs, n) at even instants of a system at rest under an input, straight between them, (T22.22)."""
    from scipy.linalg import expm

    n, h = len(system.A), time[1] - time[0]
    whole = np.zeros((n + 2, n + 2))
    whole[:n, :n], whole[:n, n], whole[n, n + 1] = system.A, system.B[:, 0], 1.0 / h
    step = expm(whole * h)
    x, found = np.zeros(n), np.empty((len(system.outputs), len(time)))
    for k, u in enumerate(value):
        found[:, k] = system.C @ x + system.D[:, 0] * u
        if k + 1 < len(value):
            x = step[:n, :n] @ x + step[:n, n] * u + step[:n, n + 1] * (value[k + 1] - u)
    return found
