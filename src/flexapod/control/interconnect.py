"""Systems closed by controllers, with what enters at the sensors, (T21.20)-(T21.21)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Protocol, runtime_checkable

import numpy as np

from flexapod.arrays import Array
from flexapod.control.channels import NOISE, RATE, chosen
from flexapod.errors import InputError

if TYPE_CHECKING:
    from flexapod.control.state_space import StateSpace

__all__ = ["CONTROL", "OnChannels", "closed", "law_of", "opened", "units_with"]

CONTROL = "control:"  # before the name of an actuator: what the controller asks of it
SINGULAR = 1e-12  # distance of a direct gain around a loop from 1 at which nothing says where it ends


@dataclass(frozen=True, kw_only=True)
class Readings:
    """What a controller reads: C x + D u + w, `noise` (readings, m + new) of all inputs and new ones by `names`."""

    C: Array
    D: Array
    noise: Array
    names: tuple[str, ...]


def _readings(system: StateSpace, readings: tuple[str, ...]) -> Readings:
    """Outputs by their names, rates of outputs exactly, Eq. (T21.20); errors of readings as further inputs.

    Raises
    ------
    InputError
        A rate of what jumps with an input.
    """
    plain = [name.removeprefix(RATE) for name in readings]
    rows = [chosen(name, system.outputs, "sensor")[0] for name in plain]
    C, D = np.array(system.C[rows]), np.array(system.D[rows])
    for i, name in enumerate(readings):
        if not name.startswith(RATE):
            continue
        if system.sample is not None or D[i].any():
            raise InputError(
                "has no rate: it jumps with an input" if D[i].any() else "has no rate between samples",
                key="sensor",
                value=plain[i],
                next_step="Give the controller a low_pass",
            )
        C[i], D[i] = C[i] @ system.A, C[i] @ system.B
    names = tuple(NOISE + name for name in dict.fromkeys(readings) if not name.startswith(RATE))
    new = tuple(name for name in names if name not in system.inputs)
    every = [*system.inputs, *new]
    noise = np.zeros((len(readings), len(every)))
    for i, name in enumerate(readings):
        if not name.startswith(RATE):
            noise[i, every.index(NOISE + name)] = 1.0
    return Readings(C=C, D=D, noise=noise, names=new)


@runtime_checkable
class OnChannels(Protocol):
    """What finds its channels among those of a system, as `controllers.Controller`."""

    def on(self, outputs: Sequence[str], inputs: Sequence[str], units: Mapping[str, str]) -> StateSpace:
        """The law between channels."""
        ...


def law_of(
    controller: OnChannels | StateSpace, outputs: Sequence[str], inputs: Sequence[str], units: Mapping[str, str]
) -> StateSpace:
    """A controller between channels of a system; a state space is one itself, with channels that the system has."""
    if isinstance(controller, type) or not (isinstance(controller, OnChannels) or hasattr(controller, "A")):
        raise InputError(
            "is no controller", key="controller", value=controller,
            allowed="one of flexapod.control, as IFF(100.0), or a StateSpace",
        )  # fmt: skip
    if isinstance(controller, OnChannels):
        return controller.on(outputs, inputs, units)
    for name in controller.inputs:
        chosen(name.removeprefix(RATE), outputs, "sensor")
    for name in controller.outputs:
        chosen(name, inputs, "actuator")
    return controller


def opened(system: StateSpace, controller: StateSpace) -> tuple[Array, Array, Array, Array]:
    """A, B, C, D from the actuators through system and controller back to them, the loop cut there."""
    at = [chosen(name, system.inputs, "actuator")[0] for name in controller.outputs]
    read = _readings(system, controller.inputs)
    A = np.block([[system.A, np.zeros((len(system.A), len(controller.A)))], [controller.B @ read.C, controller.A]])
    B = np.vstack([system.B[:, at], controller.B @ read.D[:, at]])
    return A, B, np.hstack([controller.D @ read.C, controller.C]), controller.D @ read.D[:, at]


def closed(system: StateSpace, controller: StateSpace) -> StateSpace:
    """The system with u = r + K (y + w), Eq. (T21.21): inputs r and w, outputs y and what the controller asks for.

    Raises
    ------
    InputError
        Sample times that differ, no such channel, or a loop without any state in it that has no answer.
    """
    if system.sample != controller.sample:
        words = f"of the controller is {controller.sample}, of the system {system.sample}"
        raise InputError(f"differs: that {words}", key="sample", next_step="Sample both with .sampled(period)")
    at = [chosen(name, system.inputs, "actuator")[0] for name in controller.outputs]
    read = _readings(system, controller.inputs)
    n, new = len(system.A), len(read.names)
    m = len(system.inputs) + new
    B, D = np.hstack([system.B, np.zeros((n, new))]), np.hstack([system.D, np.zeros((len(system.D), new))])
    Dy = np.hstack([read.D, np.zeros((len(read.D), new))])
    puts = np.eye(m)[:, at]
    loop = np.eye(m) - puts @ controller.D @ Dy
    if np.abs(1.0 - np.linalg.eigvals(controller.D @ read.D[:, at])).min(initial=1.0) < SINGULAR:
        raise InputError(
            "feeds a sensor straight through to the actuator that moves it",
            key="controller",
            allowed="a direct gain times the sensor's direct response other than 1",
        )
    # (T21.21)  u = r + P (Ck xk + Dk (Cy x + Dy u + w))
    by_x, by_k, by_r = (
        np.linalg.solve(loop, matrix)
        for matrix in (puts @ controller.D @ read.C, puts @ controller.C, np.eye(m) + puts @ controller.D @ read.noise)
    )
    asked = np.hstack([by_x[at], by_k[at]]).astype(float), np.asarray(by_r[at] - puts.T, dtype=float)
    A = np.block(
        [
            [system.A + B @ by_x, B @ by_k],
            [controller.B @ (read.C + Dy @ by_x), controller.A + controller.B @ Dy @ by_k],
        ]
    )
    outputs, C, D = _asked_for(system, controller, np.hstack([system.C + D @ by_x, D @ by_k]), D @ by_r, asked)
    names = (*system.inputs, *read.names)
    return replace(
        system.select(),
        A=A,
        B=np.vstack([B @ by_r, controller.B @ (Dy @ by_r + read.noise)]),
        C=C,
        D=D,
        inputs=names,
        outputs=outputs,
        states=(*system.states, *_fresh(controller.states, system.states)),
        units=units_with(system.units, (*names, *outputs)),
    )


def _asked_for(
    system: StateSpace, controller: StateSpace, C: Array, D: Array, asked: tuple[Array, Array]
) -> tuple[tuple[str, ...], Array, Array]:
    """Outputs with what the controllers ask of actuators; of an inner and an outer loop the sum."""
    outputs = list(system.outputs)
    for name, c, d in zip(controller.outputs, *asked, strict=True):
        own = CONTROL + name
        if own in outputs:
            C[outputs.index(own)] += c
            D[outputs.index(own)] += d
        else:
            outputs.append(own)
            C, D = np.vstack([C, c]), np.vstack([D, d])
    return tuple(outputs), C, D


def _fresh(names: tuple[str, ...], taken: tuple[str, ...]) -> list[str]:
    known = set(taken)
    loop = next(k for k in range(1, len(known) + 2) if not any(f"loop {k} {name}" in known for name in names))
    return [f"loop {loop} {name}" for name in names]


def units_with(units: Mapping[str, str], names: Sequence[str]) -> dict[str, str]:
    """Units with those of noises and of what controllers ask for: of the channels that they belong to."""
    found = dict(units)
    for name in names:
        plain = name.removeprefix(NOISE).removeprefix(CONTROL)
        if name not in found and plain in found:
            found[name] = found[plain]
    return found
