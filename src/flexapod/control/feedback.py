"""Systems closed by controllers: continuous, between samples, or with a delay that stays exact, (T21.20)-(T21.22).

Errors of sensors are inputs, and rates of readings are exact, (T21.46)-(T21.47). Mechanical impedance at a
joint is matched by springs and dampers, (T21.40)-(T21.42).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from flexapod.common.arguments import frequencies
from flexapod.common.arrays import Array, Complex
from flexapod.common.errors import InputError
from flexapod.common.units import quantity
from flexapod.control.discretization import period_of, zero_order_hold
from flexapod.control.state_space import NOISE, RATE, channel_indices, check_system

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.control.controllers import Controller
    from flexapod.control.state_space import StateSpace


CONTROL = "control:"  # before the name of an actuator: what the controller asks of it
SINGULAR = 1e-12  # distance of a direct gain around a loop from 1 at which nothing says where it ends


@dataclass(frozen=True, kw_only=True)
class Readings:
    """Readings of a controller, C x + D u + D_rate u'; errors of sensors are inputs, new ones by `names`.

    ``C`` (readings, n); ``D``, ``D_rate`` (readings, m + new).
    """

    C: Array
    D: Array
    D_rate: Array
    names: tuple[str, ...]


def noise_names(readings: Sequence[str], inputs: Sequence[str]) -> list[str]:
    """Inputs for errors of the sensors that are read, plainly or by their rate, without those that are there."""
    names = dict.fromkeys(NOISE + name.removeprefix(RATE) for name in readings)
    return [name for name in names if name not in inputs]


def _readings(system: StateSpace, readings: tuple[str, ...]) -> Readings:
    """Outputs by their names, rates of outputs and of their errors exactly, Eqs. (T21.20), (T21.46).

    Raises
    ------
    InputError
        A rate of what jumps with an input.
    """
    new = noise_names(readings, system.inputs)
    every = [*system.inputs, *new]
    plain = [name.removeprefix(RATE) for name in readings]
    rows = [channel_indices(name, system.outputs, "sensor")[0] for name in plain]
    C, D, D_rate = np.array(system.C[rows]), *np.zeros((2, len(rows), len(every)))
    D[:, : len(system.inputs)] = system.D[rows]
    if system.D_rate is not None:
        D_rate[:, : len(system.inputs)] = system.D_rate[rows]
    errors = np.array([name.startswith(NOISE) for name in every])
    for i, name in enumerate(readings):
        if name.startswith(RATE):
            jumps = bool(D[i, ~errors].any() or D_rate[i].any())
            if system.sample is not None or jumps:
                raise InputError(
                    "has no rate: it jumps with an input" if jumps else "has no rate between samples",
                    key="sensor",
                    value=plain[i],
                    next_step="Give the controller a low_pass",
                )
            D_rate[i] = D[i]
            C[i], D[i] = C[i] @ system.A, _extended(C[i : i + 1] @ system.B, len(new))[0]
        (D_rate if name.startswith(RATE) else D)[i, every.index(NOISE + plain[i])] += 1.0
    return Readings(C=C, D=D, D_rate=D_rate, names=tuple(new))


def _extended(matrix: Array, new: int) -> Array:
    """A matrix with further columns of 0."""
    return np.hstack([matrix, np.zeros((len(matrix), new))])


@runtime_checkable
class ControllerLike(Protocol):
    """Protocol of controllers that find their channels among those of a system, as `controllers.Controller`."""

    def on(self, outputs: Sequence[str], inputs: Sequence[str], units: Mapping[str, str]) -> StateSpace:
        """The law between channels."""
        ...


def channel_law(
    controller: ControllerLike | StateSpace, outputs: Sequence[str], inputs: Sequence[str], units: Mapping[str, str]
) -> StateSpace:
    """A controller between channels of a system; a state space is one itself, with channels that the system has."""
    if isinstance(controller, type) or not (isinstance(controller, ControllerLike) or hasattr(controller, "A")):
        raise InputError(
            "is no controller", key="controller", value=controller,
            allowed="one of flexapod.control, as IFF(100.0), or a StateSpace",
        )  # fmt: skip
    if isinstance(controller, ControllerLike):
        return controller.on(outputs, inputs, units)
    for name in controller.inputs:
        channel_indices(name.removeprefix(RATE), outputs, "sensor")
    for name in controller.outputs:
        channel_indices(name, inputs, "actuator")
    return controller


def law_beside(system: StateSpace, controller: ControllerLike | StateSpace) -> StateSpace:
    """A controller as a law between channels of a system, from sample to sample where that is sampled."""
    law = channel_law(controller, system.outputs, system.inputs, system.units)
    return zero_order_hold(law, system.sample) if system.sample is not None and law.sample is None else law


def open_loop(system: StateSpace, controller: StateSpace) -> tuple[Array, Array, Array, Array]:
    """A, B, C, D from the actuators through system and controller back to them, the loop cut there."""
    at = [channel_indices(name, system.inputs, "actuator")[0] for name in controller.outputs]
    read = _readings(system, controller.inputs)
    A = np.block([[system.A, np.zeros((len(system.A), len(controller.A)))], [controller.B @ read.C, controller.A]])
    B = np.vstack([system.B[:, at], controller.B @ read.D[:, at]])
    return A, B, np.hstack([controller.D @ read.C, controller.C]), controller.D @ read.D[:, at]


def closed_loop(system: StateSpace, controller: StateSpace) -> StateSpace:
    """The system with u = r + K (y + w), Eq. (T21.21): inputs r and w, outputs y and those of the controller.

    Raises
    ------
    InputError
        Sample times that differ, no such channel, or a loop without any state in it that has no answer.
    """
    if system.sample != controller.sample:
        words = f"of the controller is {controller.sample}, of the system {system.sample}"
        raise InputError(f"differs: that {words}", key="sample", next_step="Sample both with .sampled(period)")
    if controller.D_rate is not None:
        raise InputError(
            "answers the rate of one of its inputs", key="controller", value=controller,
            next_step="Give the loop inside it a low_pass, or .select other channels of it",
        )  # fmt: skip
    at = [channel_indices(name, system.inputs, "actuator")[0] for name in controller.outputs]
    read = _readings(system, controller.inputs)
    new = len(read.names)
    names = (*system.inputs, *read.names)
    B, D = _extended(system.B, new), _extended(system.D, new)
    D_rate = np.zeros(D.shape) if system.D_rate is None else _extended(system.D_rate, new)
    puts = np.eye(len(names))[:, at]
    through = puts @ controller.D
    if np.abs(1.0 - np.linalg.eigvals(controller.D @ read.D[:, at])).min(initial=1.0) < SINGULAR:
        raise InputError(
            "feeds a sensor straight through to the actuator that moves it",
            key="controller",
            allowed="a direct gain times the sensor's direct response other than 1",
        )
    # (T21.21)  u = r + P (Ck xk + Dk (Cy x + Dy u + Dy' u')), r with the errors of sensors
    by_x, by_k, by_r, by_rate = (
        np.linalg.solve(np.eye(len(names)) - through @ read.D, matrix)
        for matrix in (through @ read.C, puts @ controller.C, np.eye(len(names)), through @ read.D_rate)
    )
    A = np.block(
        [
            [system.A + B @ by_x, B @ by_k],
            [controller.B @ (read.C + read.D @ by_x), controller.A + controller.B @ read.D @ by_k],
        ]
    )
    own = np.hstack([system.C + D @ by_x, D @ by_k, D @ by_r, D_rate + D @ by_rate])
    asked: Array = np.hstack([by_x[at], by_k[at], by_r[at] - puts.T, by_rate[at]]).astype(np.float64)
    outputs, rows = _asked_for(system, controller, own, asked)
    C, D, D_rate = np.split(rows, [len(A), len(A) + len(names)], axis=1)
    # (T21.47)  states less what rates of inputs add to them
    ahead = np.vstack([B @ by_rate, controller.B @ (read.D @ by_rate + read.D_rate)])
    return replace(
        system.select(),
        A=A,
        B=np.vstack([B @ by_r, controller.B @ read.D @ by_r]) + A @ ahead,
        C=C,
        D=D + C @ ahead,
        D_rate=D_rate,
        inputs=names,
        outputs=outputs,
        states=(*system.states, *_fresh(controller.states, system.states)),
        units=loop_units(system.units, (*names, *outputs)),
    )


def _asked_for(system: StateSpace, controller: StateSpace, rows: Array, asked: Array) -> tuple[tuple[str, ...], Array]:
    """Outputs of the system and of the controllers; of an inner and an outer loop on one actuator the sum."""
    outputs = list(system.outputs)
    for name, row in zip(controller.outputs, asked, strict=True):
        own = CONTROL + name
        if own in outputs:
            rows[outputs.index(own)] += row
        else:
            outputs.append(own)
            rows = np.vstack([rows, row])
    return tuple(outputs), rows


def _fresh(names: tuple[str, ...], taken: tuple[str, ...]) -> list[str]:
    known = set(taken)
    loop = next(k for k in range(1, len(known) + 2) if not any(f"loop {k} {name}" in known for name in names))
    return [f"loop {loop} {name}" for name in names]


def loop_units(units: Mapping[str, str], names: Sequence[str]) -> dict[str, str]:
    """Units, with those of noises and controller outputs: each has the unit of its channel."""
    found = dict(units)
    for name in names:
        plain = name.removeprefix(NOISE).removeprefix(CONTROL)
        if name not in found and plain in found:
            found[name] = found[plain]
    return found


@dataclass(frozen=True, kw_only=True)
class DelayedLoop:
    """A loop whose actuators are late by a `delay` [s]: its response is exact, Eq. (T21.22); its states have no end."""

    system: StateSpace
    controller: StateSpace
    delay: float

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs: those of the system, then errors added to readings."""
        return (*self.system.inputs, *noise_names(self.controller.inputs, self.system.inputs))

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs: of the system, then of the controller before the delay; of inner loops the sum."""
        asked = (CONTROL + name for name in self.controller.outputs)
        return tuple(dict.fromkeys((*self.system.outputs, *asked)))

    @property
    def units(self) -> dict[str, str]:
        """Units of channels."""
        return loop_units(self.system.units, (*self.inputs, *self.outputs))

    def at(self, hz: ArrayLike) -> Complex:
        """Complex response (outputs, inputs, frequencies) at frequencies [Hz], Eq. (T21.22)."""
        s = 2j * np.pi * frequencies(hz)
        late = np.exp(-s * self.delay)[:, None, None]
        G, read, K = self.without_loop(hz)
        names, m = self.inputs, len(self.system.inputs)
        puts = np.eye(len(names))[:, self._actuators()]
        more = np.zeros((len(G), 1, len(names) - m))
        G, read = (np.concatenate([x, np.repeat(more, x.shape[1], axis=1)], axis=2) for x in (G, read))
        for i, name in enumerate(self.controller.inputs):
            read[:, i, names.index(NOISE + name.removeprefix(RATE))] += s if name.startswith(RATE) else 1.0
        u = np.linalg.inv(np.eye(len(names)) - late * (puts @ K @ read))
        places = np.zeros((len(self.outputs), K.shape[1]))
        for k, name in enumerate(self.controller.outputs):
            places[self.outputs.index(CONTROL + name), k] = 1.0
        found = places @ K @ read @ u
        found[:, : G.shape[1]] += G @ u
        return np.moveaxis(found, 0, 2)

    def without_loop(self, hz: ArrayLike) -> tuple[Complex, Complex, Complex]:
        """Responses (f, any, any) without the loop: of the system, of what is read of it, of the controller."""
        s = 2j * np.pi * frequencies(hz)
        G, K = (np.moveaxis(part.at(hz), 2, 0) for part in (self.system, self.controller))
        names = self.controller.inputs
        rows = [channel_indices(name.removeprefix(RATE), self.system.outputs, "sensor")[0] for name in names]
        rates = np.array([name.startswith(RATE) for name in names])
        return G, G[:, rows] * np.where(rates, s[:, None], 1.0)[:, :, None], K

    def _actuators(self) -> list[int]:
        return [channel_indices(name, self.system.inputs, "actuator")[0] for name in self.controller.outputs]

    def frequency_response(self, hz: ArrayLike) -> Dataset:
        """Response at frequencies [Hz] as a Dataset: `frequency_response` (output, input, frequency, part)."""
        from flexapod.control.datasets import response_dataset

        return response_dataset(self, hz, self.at(hz))


def close(
    system: StateSpace, controller: Controller | StateSpace, delay: float | str, sample: float | str | None
) -> StateSpace | DelayedLoop:
    """See `StateSpace.close`."""
    law = channel_law(controller, system.outputs, system.inputs, system.units)
    late = quantity(delay, "time", key="delay")
    if late < 0:
        raise InputError("is below 0", key="delay", value=delay, allowed="0 s or more")
    at = [channel_indices(name, system.inputs, "actuator")[0] for name in law.outputs]
    if sample is not None:
        if system.sample is not None:
            raise InputError("is that of a system that is sampled already", key="sample", value=sample)
        system = zero_order_hold(system, period_of(sample), late, at)
    elif late and system.sample is not None:
        raise InputError("is for continuous systems", key="delay", value=delay, next_step=".sampled(period, delay)")
    if system.sample is not None and law.sample is None:
        law = zero_order_hold(law, system.sample)
    if late and system.sample is None:
        return DelayedLoop(system=system, controller=law, delay=late)
    return closed_loop(system, law)


def impedance(system: StateSpace, hz: ArrayLike, *, force: str, place: str) -> Dataset:
    """Force over velocity at one place, Eq. (T21.40).

    Parameters
    ----------
    system : StateSpace
    hz : array_like, shape (f,)
        Frequencies above 0.
    force : str
        Input [N]: the force at the place.
    place : str
        Output [m]: displacement of the place along the force.

    Returns
    -------
    xarray.Dataset
        Over `frequency`: `impedance` (frequency, part) [N s/m]; the spring and the damper which beside each other
        (`parallel_stiffness` [N/m], `parallel_damping` [N s/m]), or one behind the other (`series_stiffness`,
        `series_damping`), have it, Eqs. (T21.41)-(T21.42). A stiffness below 0 is that of a mass, infinite that of
        what does not give way.
    """
    from flexapod.control.datasets import impedance_dataset

    part = check_system(system).select(force, place)
    if len(part.inputs) != 1 or len(part.outputs) != 1:
        raise InputError("are more than one channel", key="force, place", value=f"{force}, {place}")
    frequency = frequencies(hz)
    if not (frequency > 0).all():
        raise InputError("is not above 0", key="hz", allowed="frequencies above 0 Hz")
    omega = 2 * np.pi * frequency
    mobility = 1j * omega * part.at(frequency)[0, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        Z = 1.0 / mobility
        parallel = -omega * Z.imag, Z.real  # (T21.41)
        series = omega / mobility.imag, 1.0 / mobility.real  # (T21.42)
    return impedance_dataset(frequency, Z, parallel, series)
