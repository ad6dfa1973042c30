"""A linear system with named channels: matrices A, B, C, D and the analyses of them.

Channels by name: ``drive:3`` is one, ``drive`` stands for all that begin with ``drive:``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import ArrayLike

from flexapod.common.arguments import frequencies, number
from flexapod.common.arrays import Array, Complex, floats
from flexapod.common.errors import InputError, names_of, suggest_word
from flexapod.common.lazy_imports import LazyModule
from flexapod.common.units import quantity
from flexapod.control.frequency_response import oscillating_poles, poles_of, response
from flexapod.control.norms import h2_norms, hinf_norm, relative_gains, truncate_modes
from flexapod.control.zeros import zeros_of

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.control import datasets, discretization, feedback, random_response
    from flexapod.control.controllers import Controller
    from flexapod.control.feedback import DelayedLoop
    from flexapod.control.random_response import Sources
else:
    datasets = LazyModule("flexapod.control.datasets")
    discretization = LazyModule("flexapod.control.discretization")
    feedback = LazyModule("flexapod.control.feedback")
    random_response = LazyModule("flexapod.control.random_response")

RATE = "rate:"  # before the name of a reading: its rate of change
NOISE = "noise:"  # before the name of a sensor: what is added to its reading

Names = str | Sequence[str] | None


def channel_indices(given: Names, among: Sequence[str], key: str) -> list[int]:
    """Places of channels by names or groups, in the order of the names; all for None.

    Parameters
    ----------
    given : str or sequence of str, optional
        Names (``tool:z``) and groups (``tool``).
    among : sequence of str
        All names of channels there are.
    key : str
        What a refusal calls the argument.

    Raises
    ------
    InputError
        No channel of this name, with the nearest.
    """
    if given is None:
        return list(range(len(among)))
    found: list[int] = []
    for name in names_of(given, key):
        places = [i for i, known in enumerate(among) if known == name or known.startswith(f"{name}:")]
        if not places:
            raise _unknown(name, among, key)
        found += [i for i in places if i not in found]
    return found


def channel_groups(names: Sequence[str]) -> list[str]:
    """Groups that channels belong to, in their order: the text before the last colon."""
    return list(dict.fromkeys(name.rpartition(":")[0] or name for name in names))


def _unknown(name: str, among: Sequence[str], key: str) -> InputError:
    return InputError(
        "is not a channel",
        key=key,
        value=name,
        allowed=", ".join(channel_groups(among)) + f", or a single one as {among[0]}" if among else "none",
        next_step=suggest_word(name, [*channel_groups(among), *among]),
    )


@dataclass(frozen=True, kw_only=True, repr=False)
class StateSpace:
    """x' = A x + B u, y = C x + D u + D_rate u', Eqs. (T21.1), (T21.46), or from sample to sample x_next = A x + B u.

    Parameters
    ----------
    A, B, C, D : ndarray, shapes (n, n), (n, m), (p, n), (p, m)
    inputs, outputs, states : tuples of str
        Names of single channels, as ``drive:3`` and ``tool:z``; a group is what stands before the colon.
    units : mapping
        Units of inputs and outputs by the name of the channel.
    sample : float, optional
        Time between samples [s]; None of a continuous system.
    D_rate : ndarray, shape (p, m), optional
        Of rates of inputs, as loops without a filter have of errors of sensors; None where there are none.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    states: tuple[str, ...]
    units: Mapping[str, str]
    sample: float | None = None
    D_rate: Array | None = None

    def __post_init__(self) -> None:
        """Read-only matrices whose shapes fit the names."""
        for name in ("inputs", "outputs", "states"):
            object.__setattr__(self, name, _names(getattr(self, name), name))
        if not isinstance(self.units, Mapping):
            raise InputError("are no units", key="units", value=self.units, allowed='by channel, as {"tool:z": "m"}')
        n, m, p = len(self.states), len(self.inputs), len(self.outputs)
        if self.D_rate is not None and not np.any(np.asarray(self.D_rate)):
            object.__setattr__(self, "D_rate", None)
        shapes = {"A": (n, n), "B": (n, m), "C": (p, n), "D": (p, m)}
        for name, shape in (shapes if self.D_rate is None else shapes | {"D_rate": (p, m)}).items():
            try:
                value = floats(getattr(self, name))
            except ValueError:
                raise InputError("is no matrix of numbers", key=name, value=getattr(self, name)) from None
            if value.shape != shape:
                raise InputError(
                    f"has the shape {value.shape}", key=name, allowed=f"{shape}: {n} states, {m} inputs, {p} outputs"
                )
            if not np.isfinite(value).all():
                raise InputError("has numbers that are not finite", key=name)
            value.setflags(write=False)
            object.__setattr__(self, name, value)
        if self.sample is not None:
            object.__setattr__(self, "sample", number(self.sample, "sample", "time", above=0.0))
            if self.D_rate is not None:
                raise InputError("is of continuous systems", key="D_rate", allowed="None of a sampled one")

    def __repr__(self) -> str:
        """Number of states, sample time, and channels by group."""
        return f"{type(self).__name__}({self._summary()})"

    def _summary(self) -> str:
        kind = "" if self.sample is None else f", every {self.sample:g} s"
        into, out = (f"{len(names)} ({', '.join(channel_groups(names))})" for names in (self.inputs, self.outputs))
        return f"{len(self.states)} states{kind}, inputs {into}, outputs {out}"

    def select(self, inputs: Names = None, outputs: Names = None) -> StateSpace:
        """System of the same states with some channels, by names or groups, in the order given."""
        into, out = channel_indices(inputs, self.inputs, "inputs"), channel_indices(outputs, self.outputs, "outputs")
        return StateSpace(
            A=self.A,
            B=self.B[:, into],
            C=self.C[out],
            D=self.D[np.ix_(out, into)],
            inputs=tuple(self.inputs[i] for i in into),
            outputs=tuple(self.outputs[i] for i in out),
            states=self.states,
            units=self.units,
            sample=self.sample,
            D_rate=None if self.D_rate is None else self.D_rate[np.ix_(out, into)],
        )

    def sampled(self, period: float | str, delay: float | str = 0.0) -> StateSpace:
        """Sampled system, inputs held for a `period` [s] (or "5 kHz") and late by a `delay` [s], (T21.17).

        Rates of inputs are their last differences, Eq. (T21.19).
        """
        if self.sample is not None:
            raise InputError("is sampled already", key="sample", value=self.sample, allowed="a continuous system")
        return discretization.zero_order_hold(
            self, discretization.period_of(period), quantity(delay, "time", key="delay")
        )

    @overload
    def close(self, controller: Controller | StateSpace) -> StateSpace: ...
    @overload
    def close(
        self, controller: Controller | StateSpace, *, sample: float | str, delay: float | str = 0.0
    ) -> StateSpace: ...
    @overload
    def close(self, controller: Controller | StateSpace, *, delay: float | str) -> StateSpace | DelayedLoop: ...
    def close(
        self, controller: Controller | StateSpace, *, delay: float | str = 0.0, sample: float | str | None = None
    ) -> StateSpace | DelayedLoop:
        """The system with a controller, u = r + K (y + w), Eq. (T21.21).

        Parameters
        ----------
        controller : Controller or StateSpace
            From outputs to inputs of this system.
        delay : float or str
            Of the actuators [s]: exact in the response of a continuous loop, and between samples.
        sample : float or str, optional
            Time between samples [s], or their rate as ``"5 kHz"``: readings and actuators are held in between.

        Returns
        -------
        StateSpace or DelayedLoop
            With inputs ``noise:SENSOR``, which are added to readings, and outputs ``control:ACTUATOR``. A continuous
            loop with a delay has no finite number of states: a `DelayedLoop` has its response and its margins.
        """
        return feedback.close(self, controller, delay, sample)

    def _square(self, key: str, inputs: Names, outputs: Names) -> StateSpace:
        part = self.select(inputs, outputs)
        if len(part.inputs) != len(part.outputs):
            raise InputError(
                f"are {len(part.inputs)} inputs and {len(part.outputs)} outputs",
                key=key,
                allowed="as many inputs as outputs, for example one of each",
            )
        return part

    def at(self, hz: ArrayLike) -> Complex:
        """Complex response (outputs, inputs, frequencies) at frequencies [Hz], Eqs. (T21.1)-(T21.3)."""
        s = np.asarray(2j * np.pi * frequencies(hz), dtype=np.complex128)
        found = response(self.A, self.B, self.C, self.D, s if self.sample is None else np.exp(s * self.sample))
        return found if self.D_rate is None else found + self.D_rate[:, :, None] * s

    def frequency_response(self, hz: ArrayLike) -> Dataset:
        """Response at frequencies [Hz] as a Dataset: `frequency_response` (output, input, frequency, part)."""
        return datasets.response_dataset(self, hz, self.at(hz))

    def poles(self) -> Complex:
        """Eigenvalues of A, the slowest first, (n,) [1/s]; of a sampled system in the plane of z."""
        return poles_of(self.A)

    def zeros(self, input: Names = None, output: Names = None) -> Complex:
        """Zeros from as many inputs to as many outputs [1/s], Eq. (T21.5), the slowest first.

        What no input moves or no output shows is left out: such a pole and its zero cancel.
        """
        part = self._square("zeros", input, output)
        return zeros_of(part.A, part.B, part.C, part.D, part.D_rate)

    def h2(self, inputs: Names = None, outputs: Names = None) -> Dataset:
        """`h2_norm` (output, input) of each channel, Eq. (T21.25): rms under white noise of density 2, one-sided.

        Of a sampled system rms under white samples of the variance 1, without the unit Hz**0.5.
        Infinite where something follows what has no end of frequencies or never decays; `reason` says what.
        """
        part = self.select(inputs, outputs)
        return datasets.h2_dataset(part, *h2_norms(part))

    def hinf(self, inputs: Names = None, outputs: Names = None) -> Dataset:
        """`hinf_norm`, the largest singular value of the response of the channels, and its `frequency`, Eq. (T21.27).

        Channels of several units are added as they are: choose one unit, or one of each.
        """
        return datasets.hinf_dataset(*hinf_norm(self.select(inputs, outputs)))

    def rga(self, hz: ArrayLike, inputs: Names = None, outputs: Names = None) -> Dataset:
        """`relative_gain` (output, input, frequency, part) at frequencies [Hz], Eq. (T21.29), of as many of each."""
        part = self._square("rga", inputs, outputs)
        words = ("relative_gain", "relative gain: 1 where other loops change nothing", "1")
        return datasets.response_dataset(part, hz, relative_gains(part.at(hz)), words)

    def psd(self, sources: Sources, outputs: Names = None) -> Dataset:
        """Random vibration of outputs by independent sources: the integral of `flexapod.vibration`, (T18.6)-(T18.11).

        Parameters
        ----------
        sources : Disturbance or mapping
            That of a study, or one-sided spectra by channel or group of inputs: tables of a study, or pairs of
            frequencies (m,) [Hz] and densities (m,) or (m, columns).
        outputs : names, optional

        Returns
        -------
        xarray.Dataset
            `psd` and `cumulative_rms` (spectrum_frequency, output), `rms` (output), `covariance`.
        """
        part = self.select(outputs=outputs)
        return datasets.vibration_dataset(part, *random_response.output_vibration(part, sources))

    def by_source(self, sources: Sources, outputs: Names = None) -> Dataset:
        """`rms_by_source` (source, output) as of `psd`; squares add up to those of `rms`."""
        part = self.select(outputs=outputs)
        return datasets.source_dataset(part, *random_response.output_vibration(part, sources))

    def step(self, duration: float | None = None, step: float | None = None) -> Dataset:
        """`step_response` (output, input, time) after unit steps at 0, exact; by itself as long as motions last.

        Without impulses at 0, where outputs follow rates of inputs.
        """
        time = discretization.instants(self, duration, step)
        return datasets.history_dataset(
            self, time, discretization.histories(self, time, impulse=False), "step_response"
        )

    def impulse(self, duration: float | None = None, step: float | None = None) -> Dataset:
        """`impulse_response` (output, input, time) after unit impulses at 0, exact; without that of feed-through."""
        time = discretization.instants(self, duration, step)
        return datasets.history_dataset(
            self, time, discretization.histories(self, time, impulse=True), "impulse_response"
        )

    def to_control(self) -> Any:
        """The same as `control.StateSpace` of python-control, with its names."""
        return datasets.to_control(self)

    def save(self, path: str | Path) -> Path:
        """Matrices, names, units, sample time as ``.mat`` (MATLAB 5), ``.npz``, ``.json``, ``.nc``; replaces a file."""
        return datasets.save(self, path)

    def reduce(
        self, modes: int | None = None, *, below: float | str | None = None, residual: bool = True
    ) -> StateSpace:
        """The slowest `modes` of `damp`, or all `below` a frequency [Hz], Eqs. (T21.23)-(T21.24).

        `residual`: what is left out still gives way as at rest. Without that zeros move.
        """
        return truncate_modes(self, modes, below, residual)

    def damp(self) -> Dataset:
        """Frequencies [Hz], damping ratios and poles, by frequency, Eq. (T21.4); of a pair the pole above the axis."""
        return datasets.damping_dataset(*oscillating_poles(self.poles(), self.sample))


def _names(given: object, key: str) -> tuple[str, ...]:
    """Names of channels or states, none twice among channels."""
    found = names_of(given, key)
    if key != "states" and len(set(found)) < len(found):
        twice = dict.fromkeys(name for name in found if found.count(name) > 1)
        raise InputError("are twice", key=key, value=", ".join(twice), allowed="each name once")
    return tuple(found)


def check_system(system: StateSpace) -> StateSpace:
    """The system, where it is one."""
    if not isinstance(system, StateSpace):
        raise InputError(
            "is no linear system", key="system", value=system, allowed="a StateSpace, as fx.linearize returns it"
        )
    return system
