"""Controllers that change: gains interpolated over poses, (T21.43), and adaptive damping, (T21.44)-(T21.45).

Adaptive damping tracks the frequency of a vibration, and damps only that.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from flexapod.common.arguments import number, numbers
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.tables.csv_tables import POSE
from flexapod.common.units import quantities
from flexapod.control.controllers import Controller, FunctionController, collocated_channels
from flexapod.control.discretization import LATEST, period_of
from flexapod.control.feedback import channel_law
from flexapod.control.state_space import Names
from flexapod.model import AXES

if TYPE_CHECKING:
    from flexapod.control.state_space import StateSpace


@dataclass(frozen=True, kw_only=True)
class Scheduled:
    """Controllers at the points of a grid of poses; between them matrices are interpolated straight, Eq. (T21.43).

    Parameters
    ----------
    axes : mapping
        Values of each coordinate of the grid, rising, by its name: ``{"heave": [-0.1, 0, 0.1]}`` [m, rad].
    controllers : sequence
        One for each point, in the order of the axes, the last changing fastest; all of one kind, so that states mean
        the same.
    """

    axes: Mapping[str, Sequence[float]]
    controllers: Sequence[Controller | StateSpace]

    def __post_init__(self) -> None:
        """Axes that rise, a controller for each point."""
        if not isinstance(self.axes, Mapping) or not self.axes:
            raise InputError("are none", key="axes", value=self.axes, allowed='as {"heave": [-0.1, 0, 0.1]} [m, rad]')
        for name, given in self.axes.items():
            given = quantities(given, _measures(name), key=f"axes.{name}")
            values = numbers(given, f"axes.{name}", "two values or more, rising")
            if len(values) < 2 or (np.diff(values) <= 0).any():
                raise InputError("does not rise", key=f"axes.{name}", value=given, allowed="two values or more")
        points, known = (
            int(np.prod([len(values) for values in self.axes.values()])),
            isinstance(self.controllers, Sequence),
        )
        if not known or len(self.controllers) != points:
            words = f"are {len(self.controllers)}" if known else "are no list of controllers"
            raise InputError(words, key="controllers", allowed=f"{points}, one for each point")

    def at(
        self, pose: Mapping[str, float], outputs: Sequence[str], inputs: Sequence[str], period: float | None = None
    ) -> StateSpace:
        """The controller at a pose, from `outputs` of a system to `inputs`, for samples of a `period` [s] if given.

        Raises
        ------
        InputError
            A pose outside of the grid, or controllers of several kinds.
        """
        T = None if period is None else period_of(period)
        each = [_law(one, outputs, inputs, T) for one in self.controllers]
        _check_alike(each)
        found = dict.fromkeys("ABCD", 0.0)
        for k, weight in _weights(self.axes, pose):
            found = {name: value + weight * getattr(each[k], name) for name, value in found.items()}
        return replace(each[0], **found)

    def following(
        self, pose: Callable[[float], Mapping[str, float]], period: float | str, outputs: Sequence[str],
        inputs: Sequence[str],
    ) -> FunctionController:  # fmt: skip
        """Controller for a simulation along a path: `pose` of an instant [s], sampled with a `period` [s].

        States are remembered by their sample, so that samples that come again after a step that failed find their own.
        """
        T = period_of(period)
        each = [_law(one, outputs, inputs, T) for one in self.controllers]
        _check_alike(each)
        known: dict[int, Array] = {}

        def control_output(t: float, y: Array) -> Array:
            k = round(t / T)
            x = known.get(k, np.zeros(len(each[0].A))) if k else np.zeros(len(each[0].A))
            shares = list(_weights(self.axes, pose(t)))
            A, B, C, D = (sum(w * getattr(each[i], name) for i, w in shares) for name in "ABCD")
            known[k + 1] = A @ x + B @ y
            known.pop(k - LATEST, None)
            return C @ x + D @ y

        return FunctionController(function=control_output, inputs=each[0].inputs, outputs=each[0].outputs)


def _law(
    one: Controller | StateSpace, outputs: Sequence[str], inputs: Sequence[str], period: float | None
) -> StateSpace:
    law = channel_law(one, outputs, inputs, {})
    return law if period is None or law.sample is not None else law.sampled(period)


def _check_alike(each: Sequence[StateSpace]) -> None:
    kinds = {(one.inputs, one.outputs, one.states) for one in each}
    if len(kinds) > 1:
        raise InputError("are of several kinds", key="controllers", allowed="the same channels and states everywhere")


def _measures(name: str) -> str:
    """Dimension of a coordinate of a grid; a plain number where it is no coordinate of a pose."""
    return POSE.get(name, "number")


def _weights(axes: Mapping[str, Sequence[float]], pose: Mapping[str, float]) -> list[tuple[int, float]]:
    """Points about a pose and their weights, which add up to 1."""
    if not isinstance(pose, Mapping) or set(pose) - {*axes, *AXES}:
        words = 'coordinates by name, as {"heave": 0.05} [m, rad]; of the grid: ' + ", ".join(axes)
        raise InputError("is no pose of this grid", key="pose", value=pose, allowed=words)
    sides = []
    for name, values in axes.items():
        kind = _measures(name)
        grid = np.asarray(quantities(values, kind, key=f"axes.{name}"), dtype=float)
        x = number(pose.get(name, 0.0), name, kind)
        if not grid[0] <= x <= grid[-1]:
            raise InputError("is outside of the grid", key=name, value=x, allowed=f"{grid[0]:g} to {grid[-1]:g}")
        k = min(int(np.searchsorted(grid, x, side="right")) - 1, len(grid) - 2)
        share = (x - grid[k]) / (grid[k + 1] - grid[k])
        sides.append([(k, 1 - share), (k + 1, share)])
    shape = tuple(len(values) for values in axes.values())
    return [
        (int(np.ravel_multi_index([k for k, _ in corner], shape)), float(np.prod([w for _, w in corner])))
        for corner in product(*sides)
        if all(w for _, w in corner)
    ]


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
    ) -> FunctionController:
        """Controller for a simulation, from sample to sample; repeated samples find the state that they had.

        `outputs`, `inputs`: names of the channels there are, of which it takes its own.
        """
        T, gain = period_of(period), number(self.gain, "gain")
        sensors, actuators = collocated_channels(self.sensor, self.actuator, outputs, inputs)
        start = np.stack([self.tracker.start()] * len(sensors))
        known: dict[int, Array] = {}

        def control_output(t: float, y: Array) -> Array:
            k = round(t / T)
            state = known.get(k, start) if k else start
            state = np.stack([self.tracker.step(v, x, T) for v, x in zip(y, state, strict=True)])
            known[k + 1] = state
            known.pop(k - LATEST, None)
            return gain * state[:, 2] * state[:, 1]  # (T21.45)  y' = a' = -w b

        return FunctionController(function=control_output, inputs=tuple(sensors), outputs=tuple(actuators))
