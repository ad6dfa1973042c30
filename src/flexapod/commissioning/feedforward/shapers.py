"""Impulses of input shaping, and their residual vibration at other frequencies, Eqs. (T22.6)-(T22.11)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import ArrayLike

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError, check_known

TOLERATED = 0.05  # vibration left, over that of one impulse, which EI and 2HEI allow at the frequency they are made for
WIDE = 4.0  # times that frequency: how far insensitivity is looked for


@dataclass(frozen=True, kw_only=True)
class Shaper:
    """Impulses of sizes ``amplitudes`` (n,), together 1, at ``times`` (n,) [s] from 0 on."""

    times: Array
    amplitudes: Array

    @property
    def duration(self) -> float:
        """Time that shaping adds to a motion [s]."""
        return float(self.times[-1])

    def __mul__(self, other: Shaper) -> Shaper:
        """Shaper of two in sequence, whose residual vibrations multiply, Eq. (T22.10)."""
        times = np.add.outer(self.times, other.times).ravel()
        order = np.argsort(times, kind="stable")
        return Shaper(
            times=times[order], amplitudes=np.multiply.outer(self.amplitudes, other.amplitudes).ravel()[order]
        )

    def residual_share(self, frequency: ArrayLike, ratio: ArrayLike = 0.0) -> Array:
        """Residual vibration of a mode [Hz] over that of one impulse at the last one's instant, Eq. (T22.6)."""
        w = 2 * np.pi * np.asarray(frequency, dtype=float)[..., None]
        z = np.asarray(ratio, dtype=float)[..., None]
        s = w * (-z + 1j * np.sqrt(1 - z**2))
        return np.abs((self.amplitudes * np.exp(s * (self.duration - self.times))).sum(axis=-1))


def _zv(K: float) -> tuple[list[float], list[float]]:
    return [0.0, 0.5], [1.0, K]  # (T22.7)


def _mzv(K: float) -> tuple[list[float], list[float]]:
    root, K = np.sqrt(0.5), K**0.75
    return [0.0, 0.375, 0.75], [1 - root, (2 * root - 1) * K, (1 - root) * K**2]


def _zvd(K: float) -> tuple[list[float], list[float]]:
    return [0.0, 0.5, 1.0], [1.0, 2 * K, K**2]


def _ei(K: float) -> tuple[list[float], list[float]]:
    V = TOLERATED  # (T22.8)
    return [0.0, 0.5, 1.0], [(1 + V) / 4, (1 - V) / 2 * K, (1 + V) / 4 * K**2]


def _two_humps(K: float) -> tuple[list[float], list[float]]:
    V = TOLERATED  # (T22.9)
    X = np.cbrt(V**2 * (np.sqrt(1 - V**2) + 1))
    a = float((3 * X**2 + 2 * X + 3 * V**2) / (16 * X))
    return [0.0, 0.5, 1.0, 1.5], [a, (0.5 - a) * K, (0.5 - a) * K**2, a * K**3]


MOST = 4096  # impulses at once
KINDS = {"zv": _zv, "mzv": _mzv, "zvd": _zvd, "ei": _ei, "2hei": _two_humps}


def shaper(kind: str, frequency: ArrayLike, ratio: ArrayLike = 0.0) -> Shaper:
    """The impulses of a kind for modes of these frequencies [Hz] and damping ratios, one after the other.

    Raises
    ------
    InputError
        An unknown kind, no frequency, a mode that does not oscillate, or more than `MOST` impulses.
    """
    check_known(kind, KINDS, "kind")
    modes = np.broadcast_arrays(np.atleast_1d(np.asarray(frequency, dtype=float)), np.asarray(ratio, dtype=float))
    for f, z in zip(*modes, strict=True):
        if not (np.isfinite(f) and f > 0 and 0 <= z < 1):
            raise InputError(
                "is none that could vibrate", key="modes", value=f"{f:g} Hz, damping ratio {z:g}",
                allowed="frequencies above 0 Hz, damping ratios from 0 to below 1",
            )  # fmt: skip
    if not modes[0].size:
        raise InputError("names no mode", key="modes", allowed="one at least")
    each = len(KINDS[kind](1.0)[0])
    most = int(np.log(MOST) / np.log(each) + 1e-9)
    if modes[0].size > most:
        raise InputError(
            f"are {modes[0].size}, each of which multiplies the impulses of {kind!r} by {each}", key="modes",
            allowed=f"at most {most} at once, {MOST} impulses",
            next_step="Shape the lowest ones: what is left of the others is said with the result",
        )  # fmt: skip
    return reduce(Shaper.__mul__, (_of(kind, f, z) for f, z in zip(*modes, strict=True)))


def _of(kind: str, frequency: float, ratio: float) -> Shaper:
    damped = np.sqrt(1 - ratio**2)
    places, sizes = KINDS[kind](float(np.exp(-np.pi * ratio / damped)))
    amplitudes = np.array(sizes) / np.sum(sizes)
    return Shaper(times=np.array(places) / (frequency * damped), amplitudes=amplitudes)


def insensitivity(kind: str) -> float:
    """Width over frequency of the band with at most `TOLERATED` of the vibration, undamped, Eq. (T22.11)."""
    made = shaper(kind, 1.0)
    return sum(_edge(made, way) for way in (1.0, -1.0))


def _edge(made: Shaper, way: float) -> float:
    """Distance from 1 Hz on one side at which the vibration first exceeds the tolerated one [Hz]."""
    from scipy.optimize import brentq

    def over(step: ArrayLike) -> Array:
        return made.residual_share(1.0 + way * np.asarray(step)) - TOLERATED - 1e-9  # the hump in the middle touches it

    steps = np.linspace(0.0, WIDE if way > 0 else 1.0, 4001)
    k = int(np.argmax(over(steps) > 0))
    return float(brentq(lambda x: float(over(x)), steps[k - 1], steps[k]))  # type: ignore[arg-type]
