"""Adaptive damping: the frequency of a vibration is tracked and only that is damped, (T21.44)-(T21.45)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from flexapod.common.arguments import number
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.control.channels import Names
from flexapod.control.controllers import pairs
from flexapod.control.discretization import LATEST, period_of
from flexapod.control.function import Function

if TYPE_CHECKING:
    from flexapod.control.state_space import StateSpace

__all__ = ["AdaptiveDamping", "Tracker"]


@dataclass(frozen=True, kw_only=True)
class Tracker:
    """A frequency-locked loop: an oscillator that follows a reading and its own frequency, Eq. (T21.44).

    Parameters
    ----------
    frequency : float or str
        At which it starts [Hz].
    width : float
        How fast the oscillator follows, over its frequency.
    speed : float
        How fast the frequency follows [1/s]: time constant 1 / speed.
    lowest, highest : float or str
        Between which it stays [Hz].
    """

    frequency: float | str
    width: float = 1.0
    speed: float = 20.0
    lowest: float | str = 0.1
    highest: float | str = 1e4

    def __post_init__(self) -> None:
        """Numbers above 0."""
        number(self.width, "width", above=0.0)
        number(self.speed, "speed", least=0.0)
        self.start()

    def start(self) -> Array:
        """Oscillator in and out of phase, angular frequency [rad/s]."""
        found, low, high = self._limits
        if not low <= found <= high:
            raise InputError("is outside of its limits", key="frequency", value=self.frequency)
        return np.array([0.0, 0.0, found])

    def step(self, y: float, state: Array, period: float) -> Array:
        """State after a reading that holds for a `period` [s]; the oscillator by the implicit midpoint rule."""
        a, b, w = state
        _, low, high = self._limits
        h, k = 0.5 * period * w, self.width
        # (T21.44)  a' = w (k (y - a) - b), b' = w a
        det = 1.0 + h * k + h * h
        mid_a = (a + h * k * y - h * b) / det
        mid_b = b + h * mid_a
        size = mid_a**2 + mid_b**2
        if size > 0.0:
            w = float(np.clip(w - period * self.speed * w * k * (y - mid_a) * mid_b / size, low, high))
        return np.array([2 * mid_a - a, 2 * mid_b - b, w])

    @cached_property
    def _limits(self) -> tuple[float, float, float]:
        """Angular frequencies [rad/s]: at first, lowest, highest."""
        texts = (self.frequency, self.lowest, self.highest)
        names = ("frequency", "lowest", "highest")
        found = [2 * np.pi * number(text, key, "frequency", above=0.0) for text, key in zip(texts, names, strict=True)]
        return found[0], found[1], found[2]


@dataclass(frozen=True, kw_only=True)
class AdaptiveDamping:
    """u_i = -gain (rate of the tracked vibration of sensor_i), Eq. (T21.45).

    Parameters
    ----------
    gain : float
        Force over velocity [N s/m].
    tracker : Tracker
        One of the same kind for each sensor.
    sensor, actuator : names
    """

    gain: float
    tracker: Tracker
    sensor: Names = "stroke"
    actuator: Names = "drive"

    def __post_init__(self) -> None:
        """A gain that is a number, and a tracker."""
        number(self.gain, "gain")
        if not isinstance(self.tracker, Tracker):
            raise InputError("is no tracker", key="tracker", value=self.tracker, allowed='Tracker(frequency="12 Hz")')

    def on(self, outputs: Sequence[str], inputs: Sequence[str], units: object = None) -> StateSpace:
        """Refuses: what adapts has no linear law."""
        raise InputError("adapts: it has no linear law", key="controller", next_step="Use it in fx.simulate")

    def sampled(
        self, period: float | str, outputs: Sequence[str], inputs: Sequence[str], units: object = None
    ) -> Function:
        """For simulations, from sample to sample; samples that come again find the state that they had.

        `outputs`, `inputs`: names of the channels there are, of which it takes its own.
        """
        T, gain = period_of(period), number(self.gain, "gain")
        sensors, actuators = pairs(self.sensor, self.actuator, outputs, inputs)
        start = np.stack([self.tracker.start()] * len(sensors))
        known: dict[int, Array] = {}

        def asked(t: float, y: Array) -> Array:
            k = round(t / T)
            state = known.get(k, start) if k else start
            state = np.stack([self.tracker.step(v, x, T) for v, x in zip(y, state, strict=True)])
            known[k + 1] = state
            known.pop(k - LATEST, None)
            return gain * state[:, 2] * state[:, 1]  # (T21.45)  y' = a' = -w b

        return Function(function=asked, inputs=tuple(sensors), outputs=tuple(actuators))
