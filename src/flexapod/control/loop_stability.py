"""Margins of loops with an exact delay, and number of their unstable poles, (T21.31)-(T21.32)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from flexapod.common.arguments import number
from flexapod.common.arrays import Array, Complex
from flexapod.common.errors import ComputationError, InputError
from flexapod.common.units import DIMENSIONS
from flexapod.control.feedback import DelayedLoop, closed_loop, law_beside
from flexapod.control.frequency_response import oscillating_poles, pole_properties
from flexapod.control.state_space import check_system

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.control.controllers import Controller
    from flexapod.control.state_space import StateSpace


Gains = Callable[[Array], Complex]  # around all loops at frequencies [Hz], (f, k, k)
Kind = Literal["real", "one", "nearest"]

STEPS = 40  # frequencies in a decade
NEAR = 12  # frequencies on each side of a resonance, farther and farther
SPAN = 100.0  # of frequencies beyond the slowest and fastest poles
FINEST = 1e-9  # of the largest frequency, or the middle pole: less is none
CUTS, ROUNDS = 41, 6  # of a bracket: 41^-6 of it is left; its middle, often an undamped pole, is none
BESIDE = 1e-5  # of the least or over the largest of all frequencies: as good as rest and no end of them
SETTLED = 1e-3  # relative change of a loop from there to twice as far that is a number's
ENDS: tuple[Kind, Kind] = ("real", "nearest")
CLOSE = 3  # brackets of each loop in which the nearest point to -1 is looked for, and each margin of a delayed one
PARTS, TURNS = 8, 2500  # parts of a turn of the delay; most turns that are followed
FINER = 8  # parts of these, of several loops
LARGE, FAINT = 0.1, 1e-3  # gains of loops that are followed in any case, and at most
AT_ONCE = 4000  # frequencies


@dataclass(frozen=True, kw_only=True)
class Bracket:
    """Frequencies [Hz] between which loop `loop` crosses the real axis or the size 1, or is nearest to -1."""

    loop: int
    kind: Kind
    low: float
    high: float


def margins(system: StateSpace, controller: Controller | StateSpace, *, delay: float | str = 0.0) -> Dataset:
    """Gain, phase, delay and modulus margins of each loop, the others closed, `delay` [s] exact, (T21.31)-(T21.32).

    Returns
    -------
    xarray.Dataset
        By `actuator`: `gain_margin`, the factors nearest to 1 above and below it (`side`) at which the loop is at its
        limit; `phase_margin` [rad] and `delay_margin` [s] beyond the delay it has; `modulus_margin`, the least distance
        of the loop from -1; `..._frequency` [Hz] of each. Infinite where there is no limit. Attribute `unstable_poles`:
        how many poles grow; margins of a loop that has some say how far it is from having others.
    """
    from flexapod.control.datasets import margins_dataset

    law = law_beside(check_system(system), controller)
    late = number(delay, "delay", "time", least=0.0)
    if system.sample is not None and late:
        raise InputError("is for continuous systems", key="delay", value=delay, next_step=".sampled(period, delay)")
    around = _loop_gains(DelayedLoop(system=system, controller=law, delay=late))
    poles = closed_loop(system, law).poles()
    hz = _frequencies(np.concatenate([system.poles(), law.poles(), poles]), system.sample)
    whole = around(hz)
    fine, gains = _delay_grid(around, hz, whole, late)
    beside = _near_critical(gains, late, fine)
    fine, gains = _interpolated(gains, late, fine)
    cut = _open_loop_gains(gains, late, fine)
    brackets = _brackets(cut, fine)
    if late:
        brackets = _decisive(brackets, cut, beside, fine)
    found = _refined(brackets, lambda f: _open_loop_gains(around(f), late, f))
    found += _ends(lambda f: _open_loop_gains(around(f), late, f), hz, system.sample, late)
    each = [_of_loop(k, found) for k in range(len(law.outputs))]
    return margins_dataset(law.outputs, each, _growing(poles, system.sample, late, around, hz, whole))


def _loop_gains(loop: DelayedLoop) -> Gains:
    """Gains around all loops from actuators back to them, (f, k, k), without the delay."""
    at = [loop.system.inputs.index(name) for name in loop.controller.outputs]

    def around(hz: Array) -> Complex:
        _, read, K = loop.without_loop(hz)
        return K @ read[:, :, at]

    return around


def _open_loop_gains(whole: Complex, delay: float, hz: Array) -> Complex:
    """Minus the gain around each loop, cut at its actuator while the others stay closed, (k, f), Eq. (T21.31)."""
    L = np.exp(-2j * np.pi * hz * delay)[:, None, None] * whole
    found = np.empty((L.shape[1], len(L)), dtype=complex)
    for k in range(L.shape[1]):
        o = [i for i in range(L.shape[1]) if i != k]
        inner = np.eye(len(o)) - L[:, o][:, :, o]
        found[k] = -(L[:, k, k] + (L[:, [k]][:, :, o] @ np.linalg.solve(inner, L[:, o][:, :, [k]]))[:, 0, 0])
    return found


def _delay_grid(around: Gains, hz: Array, whole: Complex, delay: float) -> tuple[Array, Complex]:
    """Frequencies [Hz] between which the delay turns no loop further than an eighth, and the gains there, (f, k, k).

    First where loops are large, then where they are as large as the largest that is met at a limit below 1: beyond that
    no limit is nearer. A loop of gain g, with the others closed, is no larger than g / (1 - g).

    InputError: more turns than `TURNS`.
    """
    parts = np.ceil(PARTS * delay * np.diff(hz))
    if not (parts > 1).any():
        return hz, whole
    gain = np.linalg.norm(whole, 2, axis=(1, 2))
    larger = np.maximum(gain[1:], gain[:-1])
    wanted = (larger >= LARGE * min(1.0, gain.max())) & (larger > 0)
    if (asked := parts[wanted].sum()) > PARTS * TURNS:
        raise InputError(
            f"turns the loop {asked / PARTS:.3g} times where it is large", key="delay", value=delay,
            allowed=f"at most {TURNS} turns, {delay * PARTS * TURNS / asked:.3g} s here",
        )  # fmt: skip
    fine, gains = _subdivided_grid(around, hz, whole, np.where(wanted, parts, 1))
    sizes = np.array(
        [max((x for x in _crossings(L)[1] if x < 1), default=0.0) for L in _open_loop_gains(gains, delay, fine)]
    )
    order = np.argsort(-larger, kind="stable")
    order = order[np.cumsum(parts[order]) <= PARTS * TURNS]
    more = wanted.copy()
    more[order] |= larger[order] >= max(FAINT, float((sizes / (1 + sizes)).min()))
    return (fine, gains) if (more == wanted).all() else _subdivided_grid(around, hz, whole, np.where(more, parts, 1))


def _subdivided_grid(around: Gains, hz: Array, whole: Complex, parts: Array) -> tuple[Array, Complex]:
    """Frequencies whose intervals are cut in `parts`, and the gains there."""
    if not (parts > 1).any():
        return hz, whole
    _, _, fine = _shares(hz, parts)
    return fine, np.concatenate([around(f) for f in np.array_split(fine, len(fine) // AT_ONCE + 1)])


def _shares(hz: Array, parts: Array) -> tuple[NDArray[np.intp], Array, Array]:
    """Intervals that are cut in `parts`: of each point the interval before it, its share of that, its frequency."""
    counts = np.append(np.maximum(parts, 1).astype(int), 1)
    at = np.repeat(np.arange(len(hz)), counts)
    share = (np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)) / np.repeat(counts, counts)
    return at, share, hz[at] + share * np.append(np.diff(hz), 0.0)[at]


def _interpolated(gains: Complex, delay: float, hz: Array) -> tuple[Array, Complex]:
    """Gains of several loops between frequencies that a turn of the delay tells apart, to see where loops cross.

    Each cut loop then turns as often as the others bring it near its limit, and not only with the delay.
    """
    if gains.shape[1] == 1 or not delay:
        return hz, gains
    at, share, fine = _shares(hz, np.minimum(np.ceil(FINER * PARTS * delay * np.diff(hz)), FINER))
    after = np.minimum(at + 1, len(hz) - 1)
    return fine, gains[at] + share[:, None, None] * (gains[after] - gains[at])


def _near_critical(gains: Complex, delay: float, hz: Array) -> list[tuple[float, float]]:
    """Frequencies about which an eigenvalue of several delayed loops is nearest to 1: each loop is near -1 there."""
    values = -np.exp(-2j * np.pi * hz * delay)[:, None] * np.linalg.eigvals(gains)
    if values.shape[1] == 1 or not delay:
        return []
    for i in range(1, len(values)):
        values[i] = values[i][linear_sum_assignment(np.abs(values[i - 1][:, None] - values[i]))[1]]
    return [_neighbourhood(hz, i) for locus in values.T for i in _close(locus)]


def _neighbourhood(hz: Array, i: int) -> tuple[float, float]:
    """Ends of the interval that begins at a frequency and of its neighbours."""
    return float(hz[max(i - 1, 0)]), float(hz[min(i + 2, len(hz) - 1)])


def _crossings(L: Complex) -> tuple[NDArray[np.intp], Array]:
    """Crossings of a loop (f,) with the negative real axis: index of the point before, and the loop's size there."""
    at = np.flatnonzero((L.imag[1:] * L.imag[:-1] < 0) & (L.real[1:] + L.real[:-1] < 0))
    return at, np.exp(_between(np.log(np.abs(L)), L.imag, at))


def _close(L: Complex) -> list[int]:
    """Crossings of a loop nearest to -1, from both sides."""
    at, size = _crossings(L)
    sides = (np.flatnonzero(side) for side in (size > 1, size <= 1))
    return [
        i for side in sides for i in at[side[np.argsort(np.abs(np.log(size[side])), kind="stable")[:CLOSE]]].tolist()
    ]


def _through_poles(L: Complex) -> list[int]:
    """Indices after which a loop changes to its opposite, largest first: an undamped pole may lie there."""
    at = np.flatnonzero((L.imag[1:] * L.imag[:-1] < 0) & (L.real[1:] * L.real[:-1] < 0))
    return at[np.argsort(-np.abs(L[at]), kind="stable")[:CLOSE]].tolist()


def _between(values: Array, zero: Array, at: NDArray[np.intp]) -> Array:
    """Values between neighbours where `zero` changes its sign."""
    share = zero[at] / (zero[at] - zero[at + 1])
    return values[at] + share * (values[at + 1] - values[at])


def _decisive(brackets: list[Bracket], cut: Complex, beside: list[tuple[float, float]], hz: Array) -> list[Bracket]:
    """Brackets of a delayed loop that may hold its margins, selected by interpolation between neighbours."""
    chosen = [b for b in brackets if b.kind == "nearest"]
    for k, L in enumerate(cut):
        own = [*_close(L), *_through_poles(L)]
        chosen += [Bracket(loop=k, kind="real", low=float(hz[i]), high=float(hz[i + 1])) for i in own]
        for low, high in dict.fromkeys((*beside, *(_neighbourhood(hz, i) for i in own))):
            chosen.append(Bracket(loop=k, kind="nearest", low=low, high=high))
        level = np.log(np.abs(L))
        at = np.flatnonzero(level[1:] * level[:-1] < 0)
        turn = np.angle(-L[at]) + level[at] / (level[at] - level[at + 1]) * np.angle(L[at + 1] / L[at])
        late = turn % (2 * np.pi) / hz[at]
        first = (np.argsort(x, kind="stable")[:CLOSE] for x in (np.abs(np.angle(np.exp(1j * turn))), late))
        for i in at[np.unique(np.concatenate([*first]))].tolist():
            chosen.append(Bracket(loop=k, kind="one", low=float(hz[i]), high=float(hz[i + 1])))
    return chosen


def _brackets(cut: Complex, hz: Array) -> list[Bracket]:
    """Neighbouring frequencies between which something happens, by loop."""
    found = []
    for k, L in enumerate(cut):
        kinds: tuple[tuple[Kind, Array], ...] = (("real", L.imag), ("one", np.abs(L) - 1))
        for kind, values in kinds:
            at = np.flatnonzero(values[1:] * values[:-1] < 0).tolist()
            found += [Bracket(loop=k, kind=kind, low=float(hz[i]), high=float(hz[i + 1])) for i in at]
        for i in np.argsort(np.abs(1 + L), kind="stable")[:CLOSE].tolist():
            low, high = hz[[max(i - 1, 0), min(i + 1, len(hz) - 1)]].tolist()
            found.append(Bracket(loop=k, kind="nearest", low=low, high=high))
    return found


def _refined(brackets: list[Bracket], loops: Callable[[Array], Complex]) -> list[tuple[Bracket, float, complex]]:
    """Brackets, each with its frequency [Hz] and the loop's gain there: all divided at once, repeatedly."""
    values = np.zeros(0, dtype=complex)
    for _ in range(ROUNDS if brackets else 0):
        f = np.linspace([b.low for b in brackets], [b.high for b in brackets], CUTS + 1, axis=1)
        L = loops(f.ravel()).reshape(-1, *f.shape)
        some = [L[b.loop, i] for i, b in enumerate(brackets)]
        at = [_place(b.kind, one) for b, one in zip(brackets, some, strict=True)]
        values = np.array([one[min(i + 1, CUTS)] for i, one in zip(at, some, strict=True)])
        width = [2 if b.kind == "nearest" else 1 for b in brackets]
        brackets = [
            Bracket(loop=b.loop, kind=b.kind, low=row[i], high=row[min(i + w, CUTS)])
            for b, row, i, w in zip(brackets, f, at, width, strict=True)
        ]
    places = [0.5 * (b.low + b.high) if b.kind == "nearest" else b.high for b in brackets]
    return list(zip(brackets, places, values.tolist(), strict=True))


def _ends(
    loops: Callable[[Array], Complex], hz: Array, sample: float | None, delay: float
) -> list[tuple[Bracket, float, complex]]:
    """Loops at 0 Hz, half the sample rate or infinite frequency, where they are real, as brackets without width.

    That is read a little beside: real parts change with the square of the distance.
    """
    ends = [(0.0, hz[0] * BESIDE)]
    if sample is not None:
        ends.append((hz[-1], hz[-1]))
    elif not delay:
        ends.append((np.inf, min(hz[-1] / BESIDE, DIMENSIONS["frequency"].most)))
    found = []
    for f, near in ends:
        L = loops(np.array([near, near if near == f else near * 2 if f == 0.0 else near / 2]))
        for k, (one, other) in enumerate(L):
            if max(abs(one.imag), abs(one - other)) <= SETTLED * abs(one.real):
                found += [(Bracket(loop=k, kind=kind, low=f, high=f), f, complex(one.real)) for kind in ENDS]
    return found


def _place(kind: Kind, L: Complex) -> int:
    """Index of the part of a bracket with its crossing; for the point nearest to -1 the part before."""
    if kind == "nearest":
        return int(np.clip(np.abs(1 + L).argmin() - 1, 0, CUTS - 2))
    values = L.imag if kind == "real" else np.abs(L) - 1
    at = np.flatnonzero(values[1:] * values[:-1] <= 0)
    return int(at[0]) if len(at) else int(np.abs(values[:-1]).argmin())


def _of_loop(k: int, found: list[tuple[Bracket, float, complex]]) -> dict[str, tuple[float, float]]:
    """Margins of one loop, each with its frequency [Hz]."""
    own = {kind: [(f, L) for b, f, L in found if (b.loop, b.kind) == (k, kind)] for kind in ("real", "one", "nearest")}
    limits = [(-1.0 / L.real, f) for f, L in own["real"] if L.real < 0]
    phases = [(float(np.angle(-L)), f) for f, L in own["one"]]
    delays = [((angle % (2 * np.pi)) / (2 * np.pi * f), f) for angle, f in phases]
    return {
        "above": min((x for x in limits if x[0] > 1), default=(np.inf, np.nan)),
        "below": max((x for x in limits if x[0] <= 1), default=(0.0, np.nan)),
        "phase": min(phases, key=lambda x: abs(x[0]), default=(np.inf, np.nan)),
        "delay": min(delays, default=(np.inf, np.nan)),
        "modulus": min((abs(1 + L), f) for f, L in own["nearest"]),
    }


def _growing(poles: Complex, sample: float | None, delay: float, around: Gains, hz: Array, whole: Complex) -> int:
    """Poles of a delayed loop that grow, Eq. (T21.32): those without delay, and those that cross as it rises."""
    s, _, _ = pole_properties(poles, sample)
    drifts = FINEST * np.median(np.abs(s)) if len(s) else 0.0
    count = int((s.real > drifts).sum())
    if not delay:
        return count
    values: Complex = np.linalg.eigvals(whole).astype(np.complex128)
    for i in range(1, len(values)):
        values[i] = values[i][linear_sum_assignment(np.abs(values[i - 1][:, None] - values[i]))[1]]
    size = np.abs(values)
    places = np.argwhere((size[1:] - 1) * (size[:-1] - 1) < 0)
    for (i, j), at, angle in zip(places.tolist(), *_of_size_one(around, hz, values, places), strict=True):
        turns = max(0, int(np.ceil((delay - (angle % (2 * np.pi)) / (2 * np.pi * at)) / (1 / at))))
        count += 2 * turns * (1 if size[i + 1, j] < size[i, j] else -1)
    return count


def _of_size_one(
    around: Gains, hz: Array, values: Complex, places: NDArray[np.intp]
) -> tuple[list[float], list[float]]:
    """Frequencies [Hz] at which eigenvalues of the loops, (f, k), have the size 1, and their angles [rad] there.

    `places` (n, 2): before which frequency, and which eigenvalue. Many turns of a delay ask for many digits: intervals
    are cut twice, all at once, and what is left of them is as good as straight.
    """
    low, high, last = hz[places[:, 0]], hz[places[:, 0] + 1], values[places[:, 0], places[:, 1]]
    rows, ends, angle = np.arange(len(places)), low, np.angle(last)
    for _ in range(2 if len(places) else 0):
        f = np.linspace(low, high, CUTS + 1, axis=1)
        each = np.linalg.eigvals(around(f.ravel())).reshape(*f.shape, -1)
        followed = np.empty(f.shape, dtype=complex)
        for cut in range(CUTS + 1):
            last = each[rows, cut, np.abs(each[:, cut] - last[:, None]).argmin(axis=1)]
            followed[:, cut] = last
        size = np.log(np.abs(followed))
        at = (size[:, 1:] * size[:, :-1] <= 0).argmax(axis=1)
        low, high, last = f[rows, at], f[rows, at + 1], followed[rows, at]
        share = np.clip(size[rows, at] / (size[rows, at] - size[rows, at + 1]), 0.0, 1.0)
        ends = low + share * (high - low)
        angle = np.angle(last) + share * np.angle(followed[rows, at + 1] / last)
    return ends.tolist(), angle.tolist()


def _frequencies(poles: Complex, sample: float | None) -> Array:
    """Frequencies [Hz] all over poles of system, controller and loop, and closer and closer about resonances."""
    s, frequency, ratio = oscillating_poles(poles, sample)
    frequency = np.where(np.isfinite(frequency), frequency, 0.0)
    known = frequency[frequency > FINEST * frequency.max(initial=0.0)]
    if not known.size:
        raise ComputationError("nothing in the loop has a frequency", next_step="Give the controller a filter")
    top = min(SPAN * known.max(), DIMENSIONS["frequency"].most) if sample is None else 0.5 / sample
    low = min(known.min(), top) / SPAN
    spread = np.geomspace(low, top, int(STEPS * np.log10(top / low)) + 2)
    sharp = (ratio < 0.3) & (frequency > 0) & (s.imag > 0)
    near = np.maximum(np.abs(ratio[sharp]), FINEST)[:, None] * 3.0 ** np.arange(-3, NEAR)
    about = frequency[sharp][:, None] * np.where(near < 0.5, near, np.inf)
    sides = [frequency[sharp][:, None] + sign * about for sign in (-1, 1)]
    whole = np.unique(np.concatenate([spread, *sides], axis=None))
    return whole[(whole >= low) & (whole <= top)]
