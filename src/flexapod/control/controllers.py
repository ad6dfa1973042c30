"""Controllers between named sensors and actuators: laws, alone or decoupled, and functions, (T21.12)-(T21.16)."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass

import numpy as np
from scipy.linalg import block_diag

from flexapod.common.arguments import matrix
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError, names_of
from flexapod.common.units import quantity
from flexapod.control import filters
from flexapod.control.feedback import channel_law
from flexapod.control.filters import ControlLaw, Number
from flexapod.control.state_space import RATE, Names, StateSpace, channel_indices

NO_UNITS: Mapping[str, str] = {}


class Controller(ABC):
    """Law from sensors to forces or commands of actuators, signs included: damping is negative."""

    @abstractmethod
    def on(self, outputs: Sequence[str], inputs: Sequence[str], units: Mapping[str, str] = NO_UNITS) -> StateSpace:
        """State space from sensors, some of the outputs of a system, to actuators, some of its inputs, u = K y.

        Parameters
        ----------
        outputs, inputs : sequences of str
            Names of all channels of the system.
        units : mapping, optional
            Their units.

        Raises
        ------
        InputError
            No such channel, or numbers that do not fit.
        """

    def sampled(
        self, period: Number, outputs: Sequence[str], inputs: Sequence[str], units: Mapping[str, str] = NO_UNITS
    ) -> StateSpace:
        """Law from sample to sample, readings held for a `period` [s]: x_next = A x + B y, u = C x + D y.

        Eq. (T21.17). Other arguments as of `on`: names of all channels there are, of which it takes its own.
        """
        return self.on(outputs, inputs, units).sampled(period)


def assemble_controller(
    columns: Sequence[ControlLaw], into: Array, out: Array, sensors: Sequence[str], actuators: Sequence[str],
    units: Mapping[str, str],
) -> StateSpace:  # fmt: skip
    """Laws between matrices: u = `out` (actuators, k) . laws (k) . `into` (k, sensors) y, Eq. (T21.12)."""
    n, k = sum(len(law.A) for law in columns), len(columns)
    A, C = np.reshape(_diagonal([law.A for law in columns]), (n, n)), _diagonal([law.C[None] for law in columns])
    read, rates = (np.reshape(_diagonal([law.B[:, [i]] for law in columns]), (n, k)) for i in (0, 1))
    direct, damped = (np.diag([law.D[i] for law in columns]) for i in (0, 1))
    names, B, D = list(sensors), read @ into, out @ direct @ into
    if rates.any() or damped.any():
        seen = np.flatnonzero((rates @ into).any(axis=0) | (out @ damped @ into).any(axis=0)).tolist()
        names += [RATE + sensors[i] for i in seen]
        B, D = np.hstack([B, (rates @ into)[:, seen]]), np.hstack([D, (out @ damped @ into)[:, seen]])
    return StateSpace(
        A=A,
        B=B,
        C=out @ np.reshape(C, (k, n)),
        D=D,
        inputs=tuple(names),
        outputs=tuple(actuators),
        states=tuple(f"law {k + 1} x{i + 1}" for k, law in enumerate(columns) for i in range(len(law.A))),
        units={name: units[name.removeprefix(RATE)] for name in (*sensors, *actuators) if name in units},
    )


@dataclass(frozen=True)
class Decentralised(Controller):
    """Each actuator by the sensor of the same place, u_i = -law(y_i), Eq. (T21.13)."""

    law: ControlLaw
    _: KW_ONLY
    sensor: Names
    actuator: Names = "drive"

    def on(self, outputs: Sequence[str], inputs: Sequence[str], units: Mapping[str, str] = NO_UNITS) -> StateSpace:
        """See `Controller.on`."""
        filters.check_law(self.law)
        sensors, actuators = collocated_channels(self.sensor, self.actuator, outputs, inputs)
        each = np.eye(len(sensors))
        return assemble_controller([self.law * -1.0] * len(sensors), each, each, sensors, actuators, units)


@dataclass(frozen=True)
class IFF(Controller):
    """Integral force feedback: u_i = -gain / (s + w) (force_i + parallel_stiffness stroke_i), Eq. (T21.14).

    Parameters
    ----------
    gain : float
        [1/s]
    high_pass : float or str
        Corner [Hz] below which nothing is integrated: of static stiffness w / (w + gain) stays, and a robot that turns
        stays stable. Without it and without `parallel_stiffness` nothing holds at rest what the drives carry.
    parallel_stiffness : float or str
        Force per `stroke` [N/m] that is added to what the sensors read, as if springs beside actuators and sensors
        carried it: the robot keeps that stiffness.
    sensor, stroke, actuator : names
        Channels: forces through the actuators, elongations of these, forces of these.
    """

    gain: float
    _: KW_ONLY
    high_pass: Number = 0.0
    parallel_stiffness: Number = 0.0
    sensor: Names = "force-sensor:drive"
    stroke: Names = "stroke"
    actuator: Names = "drive"

    def on(self, outputs: Sequence[str], inputs: Sequence[str], units: Mapping[str, str] = NO_UNITS) -> StateSpace:
        """See `Controller.on`."""
        law = filters.integrator(-quantity(self.gain, "number", key="gain"), self.high_pass)
        sensors, actuators = collocated_channels(self.sensor, self.actuator, outputs, inputs)
        each = np.eye(len(sensors))
        stiffness = quantity(self.parallel_stiffness, "stiffness", key="parallel_stiffness")
        if not stiffness:
            return assemble_controller([law] * len(sensors), each, each, sensors, actuators, units)
        strokes, _ = collocated_channels(self.stroke, self.actuator, outputs, inputs)
        into = np.hstack([each, stiffness * each])
        return assemble_controller([law] * len(sensors), into, each, [*sensors, *strokes], actuators, units)


@dataclass(frozen=True)
class DVF(Controller):
    """Direct velocity feedback: u_i = -gain (rate of sensor_i), with a `low_pass` [Hz] or without, Eq. (T21.15)."""

    gain: float
    _: KW_ONLY
    low_pass: Number | None = None
    sensor: Names = "stroke"
    actuator: Names = "drive"

    def on(self, outputs: Sequence[str], inputs: Sequence[str], units: Mapping[str, str] = NO_UNITS) -> StateSpace:
        """See `Controller.on`."""
        law = filters.rate(self.gain, self.low_pass)
        return Decentralised(law, sensor=self.sensor, actuator=self.actuator).on(outputs, inputs, units)


@dataclass(frozen=True)
class PID(Controller):
    """u_i = -(proportional y_i + integral of y_i + derivative rate of y_i); `low_pass` [Hz] of the rate."""

    proportional: float
    integral: float = 0.0
    derivative: float = 0.0
    _: KW_ONLY
    low_pass: Number | None = None
    sensor: Names = "stroke"
    actuator: Names = "drive"

    def on(self, outputs: Sequence[str], inputs: Sequence[str], units: Mapping[str, str] = NO_UNITS) -> StateSpace:
        """See `Controller.on`."""
        law = filters.pid(self.proportional, self.integral, self.derivative, self.low_pass)
        return Decentralised(law, sensor=self.sensor, actuator=self.actuator).on(outputs, inputs, units)


@dataclass(frozen=True)
class SensorFusion(Controller):
    """Two sensors of one motion, the first below, the second above a `corner` [Hz], u_i = -law(L y_i + H z_i)."""

    law: ControlLaw
    _: KW_ONLY
    low: Names
    high: Names
    corner: Number
    order: int = 1
    actuator: Names = "drive"

    def on(self, outputs: Sequence[str], inputs: Sequence[str], units: Mapping[str, str] = NO_UNITS) -> StateSpace:
        """See `Controller.on`."""
        filters.check_law(self.law)
        below, above = filters.complementary(self.corner, self.order)
        low, actuators = collocated_channels(self.low, self.actuator, outputs, inputs)
        high, _ = collocated_channels(self.high, self.actuator, outputs, inputs)
        each = np.eye(len(low))
        both = [self.law * below * -1.0] * len(low) + [self.law * above * -1.0] * len(low)
        return assemble_controller(both, np.eye(2 * len(low)), np.hstack([each, each]), [*low, *high], actuators, units)


@dataclass(frozen=True)
class Decoupled(Controller):
    """u = -out . law . into y: readings into directions that do not disturb each other, and back, Eq. (T21.16).

    Parameters
    ----------
    law : ControlLaw or sequence of ControlLaw
        One for all directions, or one each.
    into : ndarray, shape (k, sensors)
        Directions by readings, for example the inverse of a Jacobian.
    out : ndarray, shape (actuators, k)
        Actuators by what the directions ask for, for example the inverse of its transpose.
    """

    law: ControlLaw | Sequence[ControlLaw]
    _: KW_ONLY
    into: Array
    out: Array
    sensor: Names = "stroke"
    actuator: Names = "drive"

    def on(self, outputs: Sequence[str], inputs: Sequence[str], units: Mapping[str, str] = NO_UNITS) -> StateSpace:
        """See `Controller.on`."""
        sensors = [outputs[i] for i in channel_indices(self.sensor, outputs, "sensor")]
        actuators = [inputs[i] for i in channel_indices(self.actuator, inputs, "actuator")]
        into, out = matrix(self.into, "into", "(k, sensors)"), matrix(self.out, "out", "(actuators, k)")
        out = out.T if np.ndim(self.out) == 1 else out
        each = (
            [self.law] * len(into)
            if isinstance(self.law, ControlLaw) or not isinstance(self.law, Sequence)
            else self.law
        )
        given = [filters.check_law(law) for law in each]
        shapes = {"into": (into, (len(given), len(sensors))), "out": (out, (len(actuators), len(given)))}
        for key, (found, shape) in shapes.items():
            if found.shape != shape:
                words = f"{shape}: {len(given)} laws, {len(sensors)} sensors, {len(actuators)} actuators"
                raise InputError(f"has the shape {found.shape}", key=key, allowed=words)
        return assemble_controller([law * -1.0 for law in given], into, out, sensors, actuators, units)


@dataclass(frozen=True)
class Parallel(Controller):
    """Several controllers at once: their outputs to one actuator add up, as of an inner and an outer loop."""

    parts: tuple[Controller | StateSpace, ...]

    def on(self, outputs: Sequence[str], inputs: Sequence[str], units: Mapping[str, str] = NO_UNITS) -> StateSpace:
        """See `Controller.on`."""
        parts = self.parts if isinstance(self.parts, Sequence) else ()
        each = [channel_law(part, outputs, inputs, units) for part in parts]
        if not each:
            raise InputError("are none", key="parts", allowed="a controller at least")
        readings = tuple(dict.fromkeys(name for part in each for name in part.inputs))
        actuators = tuple(dict.fromkeys(name for part in each for name in part.outputs))
        reads = [np.array([[float(a == b) for b in readings] for a in part.inputs]) for part in each]
        drives = [np.array([[float(a == b) for b in part.outputs] for a in actuators]) for part in each]
        n = sum(len(part.A) for part in each)
        return StateSpace(
            A=np.reshape(_diagonal([part.A for part in each]), (n, n)),
            B=np.vstack([part.B @ read for part, read in zip(each, reads, strict=True)]),
            C=np.hstack([drive @ part.C for part, drive in zip(each, drives, strict=True)]),
            D=np.sum([d @ part.D @ r for part, r, d in zip(each, reads, drives, strict=True)], axis=0),
            inputs=readings,
            outputs=actuators,
            states=tuple(f"part {k + 1} {name}" for k, part in enumerate(each) for name in part.states),
            units={name: unit for part in each for name, unit in part.units.items()},
        )


def _diagonal(blocks: Sequence[Array]) -> Array:
    """Blocks along a diagonal; those without rows or columns still have the others."""
    return np.asarray(block_diag(*blocks), dtype=float)


def collocated_channels(
    sensor: Names, actuator: Names, outputs: Sequence[str], inputs: Sequence[str]
) -> tuple[list[str], list[str]]:
    """Names of sensors and actuators, as many of each."""
    sensors = [outputs[i] for i in channel_indices(sensor, outputs, "sensor")]
    actuators = [inputs[i] for i in channel_indices(actuator, inputs, "actuator")]
    if len(sensors) != len(actuators):
        raise InputError(
            f"are {len(sensors)} for {len(actuators)} actuators",
            key="sensor",
            value=", ".join(sensors),
            allowed="a sensor for each actuator",
            next_step="Name single channels, as drive:3",
        )
    return sensors, actuators


@dataclass(frozen=True, kw_only=True)
class FunctionController:
    """Function that a simulation calls once a sample: ``function(t, readings) -> values``, t [s].

    Parameters
    ----------
    function : callable
        Of an instant and the readings (p,), in the order of `inputs`; returns the values (m,) of `outputs`. Called in
        the order of samples; after a step that fails some come again with the same instants.
    inputs, outputs : tuples of str
        Single channels that it reads, as ``stroke:1``, and that it moves, as ``drive:1``.
    """

    function: Callable[[float, Array], object]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]

    def __post_init__(self) -> None:
        """Check the function and the names of its channels."""
        if not callable(self.function):
            raise InputError("is no function", key="function", value=self.function, allowed="function(t, readings)")
        for key in ("inputs", "outputs"):
            object.__setattr__(self, key, tuple(names_of(getattr(self, key), key)))
