"""Loops judged: root locus, best gain, margins with an exact delay, (T21.30)-(T21.32)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq, linear_sum_assignment, minimize_scalar

from flexapod.arrays import Array
from flexapod.control.closing import DelayedLoop
from flexapod.control.interconnect import closed, opened
from flexapod.control.poles import damping_of, poles_of, zeros_of
from flexapod.control.sampling import held
from flexapod.errors import ComputationError, InputError
from flexapod.units import to_si

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.control.controllers import Controller
    from flexapod.control.state_space import StateSpace

__all__ = ["best_gain", "margins", "root_locus"]

Complex = NDArray[np.complex128]

STEPS = 40  # of a decade of gains, and of frequencies
NEAR = 12  # frequencies on each side of a resonance, closer and closer
SPAN = 100.0  # of frequencies beyond the slowest and fastest poles
FINEST = 1e-9  # relative accuracy of a crossing


def root_locus(system: StateSpace, controller: Controller | StateSpace, gains: ArrayLike) -> Dataset:
    """Poles of a loop over a factor on its controller.

    Parameters
    ----------
    system : StateSpace
    controller : Controller or StateSpace
        Its own gain is that of the factor 1.
    gains : array_like, shape (g,)
        Factors, 0 or more.

    Returns
    -------
    xarray.Dataset
        `pole` (gain, branch, part) [1/s], each branch one motion, as poles of neighbouring gains are paired;
        `frequency` [Hz] and `damping_ratio` (gain, branch); `open_zero` (zero, part): where branches end.
    """
    from flexapod.control.datasets import locus_dataset

    factors = np.atleast_1d(np.asarray(gains, dtype=float))
    law = _law(system, controller)
    poles = np.stack([_poles(system, law, factor) for factor in factors])
    for i in range(1, len(poles)):
        away = np.abs(poles[i - 1][:, None] - poles[i])
        poles[i] = poles[i][linear_sum_assignment(away)[1]]
    return locus_dataset(factors, poles, _open_zeros(system, law), system.sample)


def best_gain(
    system: StateSpace, controller: Controller | StateSpace, *, least: float = 1e-3, most: float = 1e3,
    below: float | str | None = None,
) -> Dataset:  # fmt: skip
    """Factor on a controller at which the least damping ratio of all oscillating poles is largest, Eq. (T21.30).

    Parameters
    ----------
    system, controller
        As of `root_locus`.
    least, most : float
        Between which factors to look.
    below : float or str, optional
        Frequency [Hz] above which poles do not count.

    Returns
    -------
    xarray.Dataset
        `gain`, `damping_ratio` there, `frequency` of the pole that has it; over `factor`: `least_damping_ratio`.
    """
    from flexapod.control.datasets import best_dataset

    law = _law(system, controller)
    edge = np.inf if below is None else to_si(below, "frequency", key="below")
    if not 0 < least < most:
        raise InputError("are no factors", key="least, most", value=f"{least}, {most}", allowed="0 < least < most")
    factors = np.geomspace(least, most, int(np.ceil(STEPS * np.log10(most / least))) + 1)
    ratios = np.array([_least_ratio(system, law, factor, edge)[0] for factor in factors])
    at = int(ratios.argmax())
    low, high = (np.log(factors[max(at - 1, 0)]), np.log(factors[min(at + 1, len(factors) - 1)]))
    found = minimize_scalar(
        lambda x: -_least_ratio(system, law, np.exp(x), edge)[0],
        bounds=(low, high), method="bounded", options={"xatol": FINEST},
    )  # fmt: skip
    gain = float(np.exp(found.x)) if -found.fun >= ratios[at] else float(factors[at])
    return best_dataset(gain, *_least_ratio(system, law, gain, edge), factors, ratios)


def margins(system: StateSpace, controller: Controller | StateSpace, *, delay: float | str = 0.0) -> Dataset:
    """How far each loop is from its limit, the others closed, its `delay` [s] exact, Eqs. (T21.31)-(T21.32).

    Returns
    -------
    xarray.Dataset
        By `actuator`: `gain_margin`, the factors nearest to 1 above and below it (`side`) at which the loop is at its
        limit; `phase_margin` [rad] and `delay_margin` [s] beyond the delay it has; `modulus_margin`, the least distance
        of the loop from -1; `..._frequency` [Hz] of each. Infinite where there is no limit. Attribute `unstable_poles`:
        how many poles grow; margins of a loop that has some say how far it is from having others.
    """
    from flexapod.control.datasets import margins_dataset

    law = _law(system, controller)
    late = to_si(delay, "time", key="delay")
    if system.sample is not None and late:
        raise InputError("is for continuous systems", key="delay", value=delay, next_step=".sampled(period, delay)")
    loop = DelayedLoop(system=system, controller=law, delay=late)
    hz = _frequencies(system, law)
    each = [_margins_of(_cut(loop, k), hz) for k in range(len(law.outputs))]
    return margins_dataset(law.outputs, each, _unstable(loop, hz))


def _law(system: StateSpace, controller: Controller | StateSpace) -> StateSpace:
    law = controller.on(system.outputs, system.inputs, system.units)
    return held(law, system.sample) if system.sample is not None and law.sample is None else law


def _scaled(law: StateSpace, factor: float) -> StateSpace:
    return replace(law, C=factor * law.C, D=factor * law.D)


def _poles(system: StateSpace, law: StateSpace, factor: float) -> Complex:
    return closed(system, _scaled(law, factor)).poles()


def _least_ratio(system: StateSpace, law: StateSpace, factor: float, edge: float) -> tuple[float, float]:
    """Least damping ratio of oscillating poles below a frequency [Hz], -1 of unstable real ones, and the pole's own."""
    poles, frequency, ratio = damping_of(_poles(system, law, factor), system.sample)
    counts = (frequency <= edge) & ((np.abs(poles.imag) > FINEST * np.abs(poles)) | (ratio < 0))
    counts &= frequency > FINEST * np.median(frequency)
    if not counts.any():
        return 1.0, 0.0
    at = np.flatnonzero(counts)[ratio[counts].argmin()]
    return float(ratio[at]), float(frequency[at])


def _open_zeros(system: StateSpace, law: StateSpace) -> Complex:
    """Zeros of the loop from its actuators back to them: where branches end as the factor grows without end."""
    A, B, C, D = opened(system, law)
    return zeros_of(A, B, C, D, poles_of(A))


def _around(loop: DelayedLoop) -> Callable[[float | Array], Complex]:
    """Gains around all loops from actuators back to them, (f, k, k), without the delay."""
    at = [loop.system.inputs.index(name) for name in loop.controller.outputs]

    def around(hz: float | Array) -> Complex:
        _, read, K = loop.opened(hz)
        return K @ read[:, :, at]

    return around


def _cut(loop: DelayedLoop, k: int) -> Callable[[float | Array], Complex]:
    """Minus the gain around loop k, cut at its actuator while the others stay closed, (f,)."""
    around = _around(loop)

    def gain(hz: float | Array) -> Complex:
        late = np.exp(-2j * np.pi * np.atleast_1d(np.asarray(hz, float)) * loop.delay)
        L = late[:, None, None] * around(hz)
        others = [i for i in range(L.shape[1]) if i != k]
        inner = np.eye(len(others)) - L[:, others][:, :, others]
        through = np.linalg.solve(inner, L[:, others][:, :, [k]])
        return -(L[:, k, k] + (L[:, [k]][:, :, others] @ through)[:, 0, 0])

    return gain


def _unstable(loop: DelayedLoop, hz: Array) -> int:
    """Poles of a delayed loop that grow, Eq. (T21.32): those without delay, and those that cross as it rises."""
    s, _, _ = damping_of(_poles(loop.system, loop.controller, 1.0), loop.system.sample)
    drifts = FINEST * np.median(np.abs(s)) if len(s) else 0.0
    count = sum(1 if pole.imag == 0 else 2 for pole in s if pole.real > drifts)
    if not loop.delay:
        return count
    around = _around(loop)
    values = np.linalg.eigvals(around(hz))
    for i in range(1, len(values)):
        values[i] = values[i][linear_sum_assignment(np.abs(values[i - 1][:, None] - values[i]))[1]]
    size = np.abs(values)
    for i, j in np.argwhere((size[1:] - 1) * (size[:-1] - 1) < 0):
        share = (1 - size[i, j]) / (size[i + 1, j] - size[i, j])
        at = hz[i] + share * (hz[i + 1] - hz[i])
        whole = np.linalg.eigvals(around(at))[0]
        angle = np.angle(whole[np.abs(whole - (1 - share) * values[i, j] - share * values[i + 1, j]).argmin()])
        turns = np.arange((angle % (2 * np.pi)) / (2 * np.pi * at), loop.delay, 1 / at)
        count += 2 * len(turns) * (1 if size[i + 1, j] < size[i, j] else -1)
    return count


def _frequencies(system: StateSpace, law: StateSpace) -> Array:
    """Frequencies [Hz] all over the poles of system, controller and loop, and closer and closer about resonances."""
    poles = np.concatenate([system.poles(), law.poles(), _poles(system, law, 1.0)])
    s, frequency, ratio = damping_of(poles, system.sample)
    frequency = np.where(np.isfinite(frequency), frequency, 0.0)
    known = frequency[frequency > FINEST * frequency.max(initial=0.0)]
    if not known.size:
        raise ComputationError("nothing in the loop has a frequency", next_step="Give the controller a filter")
    top = SPAN * known.max() if system.sample is None else 0.5 / system.sample
    low = min(known.min(), top) / SPAN
    spread = np.geomspace(low, top, int(STEPS * np.log10(top / low)) + 2)
    sharp = (ratio < 0.3) & (frequency > 0) & (s.imag > 0)
    about = [
        f * (1 + sign * max(abs(z), 1e-9) * 3.0**power)
        for f, z in zip(frequency[sharp], ratio[sharp], strict=True)
        for power in np.arange(-3, NEAR)
        for sign in (-1, 1)
        if max(abs(z), 1e-9) * 3.0**power < 0.5
    ]
    whole = np.unique(np.concatenate([spread, np.array(about)]))
    return whole[(whole >= low) & (whole <= top)]


def _margins_of(loop: Callable[[float | Array], Complex], hz: Array) -> dict[str, tuple[float, float]]:
    """Margins of one loop gain, each with its frequency [Hz]."""
    L = loop(hz)
    crossed = _crossings(lambda f: float(loop(f)[0].imag), L.imag, hz)
    real = [(float(loop(f)[0].real), f) for f in crossed]
    limits = [(-1.0 / x, f) for x, f in real if x < 0]
    above = min((x for x in limits if x[0] > 1), default=(np.inf, np.nan))
    below = max((x for x in limits if x[0] <= 1), default=(0.0, np.nan))
    ones = _crossings(lambda f: float(np.log(abs(loop(f)[0]))), np.log(np.maximum(np.abs(L), 1e-300)), hz)
    phases = [(float(np.angle(-loop(f)[0])), f) for f in ones]
    phase = min(((abs(angle), f) for angle, f in phases), default=(np.inf, np.nan))
    delays = [((angle % (2 * np.pi)) / (2 * np.pi * f), f) for angle, f in phases]
    apart = np.abs(1 + L)
    at = int(apart.argmin())
    low, high = hz[max(at - 1, 0)], hz[min(at + 1, len(hz) - 1)]
    nearest = minimize_scalar(
        lambda f: abs(1 + loop(f)[0]), bounds=(low, high), method="bounded", options={"xatol": FINEST * hz[at]}
    )
    return {
        "above": above,
        "below": below,
        "phase": phase,
        "delay": min(delays, default=(np.inf, np.nan)),
        "modulus": min((float(nearest.fun), float(nearest.x)), (float(apart[at]), float(hz[at]))),
    }


def _crossings(value: Callable[[float], float], values: Array, hz: Array) -> list[float]:
    """Frequencies at which a number passes through 0."""
    at = np.flatnonzero(values[1:] * values[:-1] < 0)
    return [brentq(value, hz[i], hz[i + 1], rtol=FINEST) for i in at]
