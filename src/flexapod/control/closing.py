"""Ways to close a loop: continuous, between samples, or with a delay that stays exact, (T21.21)-(T21.22)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexapod.common.arguments import frequencies
from flexapod.common.errors import InputError
from flexapod.common.units import quantity
from flexapod.control.channels import NOISE, RATE, chosen
from flexapod.control.discretization import held, period_of
from flexapod.control.feedback import CONTROL, closed, law_of, noise_names, units_with

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.control.controllers import Controller
    from flexapod.control.state_space import StateSpace

__all__ = ["DelayedLoop", "close"]

Complex = NDArray[np.complex128]


@dataclass(frozen=True, kw_only=True)
class DelayedLoop:
    """A loop whose actuators are late by a `delay` [s]: its response is exact, Eq. (T21.22); its states have no end."""

    system: StateSpace
    controller: StateSpace
    delay: float

    @property
    def inputs(self) -> tuple[str, ...]:
        """Those of the system, then what is added to readings."""
        return (*self.system.inputs, *noise_names(self.controller.inputs, self.system.inputs))

    @property
    def outputs(self) -> tuple[str, ...]:
        """Those of the system, then what the controller asks of actuators, before the delay; of inner loops the sum."""
        asked = (CONTROL + name for name in self.controller.outputs)
        return tuple(dict.fromkeys((*self.system.outputs, *asked)))

    @property
    def units(self) -> dict[str, str]:
        """Units of channels."""
        return units_with(self.system.units, (*self.inputs, *self.outputs))

    def at(self, hz: ArrayLike) -> Complex:
        """Complex response (outputs, inputs, frequencies) at frequencies [Hz], Eq. (T21.22)."""
        s = 2j * np.pi * frequencies(hz)
        late = np.exp(-s * self.delay)[:, None, None]
        G, read, K = self.opened(hz)
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

    def opened(self, hz: ArrayLike) -> tuple[Complex, Complex, Complex]:
        """Responses (f, any, any) without the loop: of the system, of what is read of it, of the controller."""
        s = 2j * np.pi * frequencies(hz)
        G, K = (np.moveaxis(part.at(hz), 2, 0) for part in (self.system, self.controller))
        names = self.controller.inputs
        rows = [chosen(name.removeprefix(RATE), self.system.outputs, "sensor")[0] for name in names]
        rates = np.array([name.startswith(RATE) for name in names])
        return G, G[:, rows] * np.where(rates, s[:, None], 1.0)[:, :, None], K

    def _actuators(self) -> list[int]:
        return [chosen(name, self.system.inputs, "actuator")[0] for name in self.controller.outputs]

    def frequency_response(self, hz: ArrayLike) -> Dataset:
        """Response at frequencies [Hz] as a Dataset: `frequency_response` (output, input, frequency, part)."""
        from flexapod.control.datasets import response_dataset

        return response_dataset(self, hz, self.at(hz))


def close(
    system: StateSpace, controller: Controller | StateSpace, delay: float | str, sample: float | str | None
) -> StateSpace | DelayedLoop:
    """See `StateSpace.close`."""
    law = law_of(controller, system.outputs, system.inputs, system.units)
    late = quantity(delay, "time", key="delay")
    if late < 0:
        raise InputError("is below 0", key="delay", value=delay, allowed="0 s or more")
    at = [chosen(name, system.inputs, "actuator")[0] for name in law.outputs]
    if sample is not None:
        if system.sample is not None:
            raise InputError("is that of a system that is sampled already", key="sample", value=sample)
        system = held(system, period_of(sample), late, at)
    elif late and system.sample is not None:
        raise InputError("is for continuous systems", key="delay", value=delay, next_step=".sampled(period, delay)")
    if system.sample is not None and law.sample is None:
        law = held(law, system.sample)
    if late and system.sample is None:
        return DelayedLoop(system=system, controller=law, delay=late)
    return closed(system, law)
