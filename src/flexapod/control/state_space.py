"""A linear system with named channels: matrices A, B, C, D and what can be asked of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexapod.arrays import Array
from flexapod.control.channels import Names, chosen
from flexapod.control.frequency import response
from flexapod.control.poles import damping_of, poles_of, zeros_of
from flexapod.errors import InputError

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["StateSpace"]

Complex = NDArray[np.complex128]


@dataclass(frozen=True, kw_only=True)
class StateSpace:
    """x' = A x + B u, y = C x + D u, Eq. (T21.1), or from sample to sample x_next = A x + B u.

    Parameters
    ----------
    A, B, C, D : ndarray, shapes (n, n), (n, m), (p, n), (p, m)
    inputs, outputs, states : tuples of str
        Names of single channels, as ``drive:3`` and ``tool:z``; a group is what stands before the colon.
    units : mapping
        Units of inputs and outputs by the name of the channel.
    sample : float, optional
        Time between samples [s]; None of a continuous system.
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

    def __post_init__(self) -> None:
        """Read-only matrices whose shapes fit the names."""
        n, m, p = len(self.states), len(self.inputs), len(self.outputs)
        for name, shape in (("A", (n, n)), ("B", (n, m)), ("C", (p, n)), ("D", (p, m))):
            value = np.array(getattr(self, name), dtype=float)
            if value.shape != shape:
                raise InputError(
                    f"has the shape {value.shape}", key=name, allowed=f"{shape}: {n} states, {m} inputs, {p} outputs"
                )
            value.setflags(write=False)
            object.__setattr__(self, name, value)
        if self.sample is not None and not self.sample > 0:
            raise InputError("is not a time", key="sample", value=self.sample, allowed="above 0 s, or None")

    def select(self, inputs: Names = None, outputs: Names = None) -> StateSpace:
        """The same states with some channels, by names or groups, in the order given."""
        into, out = chosen(inputs, self.inputs, "inputs"), chosen(outputs, self.outputs, "outputs")
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
        )

    def at(self, hz: ArrayLike) -> Complex:
        """Complex response (outputs, inputs, frequencies) at frequencies [Hz], Eqs. (T21.1)-(T21.3)."""
        s = 2j * np.pi * np.atleast_1d(np.asarray(hz, dtype=float))
        return response(self.A, self.B, self.C, self.D, s if self.sample is None else np.exp(s * self.sample))

    def frequency_response(self, hz: ArrayLike) -> Dataset:
        """Response at frequencies [Hz] as a Dataset: `frequency_response` (output, input, frequency, part)."""
        from flexapod.control.datasets import response_dataset

        return response_dataset(self, hz)

    def poles(self) -> Complex:
        """Eigenvalues of A, the slowest first, (n,) [1/s]; of a sampled system in the plane of z."""
        return poles_of(self.A)

    def zeros(self, input: Names = None, output: Names = None) -> Complex:
        """Zeros from as many inputs to as many outputs [1/s], Eq. (T21.5), the slowest first.

        What no input moves or no output shows is left out: such a pole and its zero cancel.
        """
        part = self.select(input, output)
        if len(part.inputs) != len(part.outputs):
            raise InputError(
                f"are {len(part.inputs)} inputs and {len(part.outputs)} outputs",
                key="zeros",
                allowed="as many inputs as outputs, for example one of each",
            )
        return zeros_of(part.A, part.B, part.C, part.D, part.poles())

    def damp(self) -> Dataset:
        """Frequencies [Hz], damping ratios and poles, by frequency, Eq. (T21.4); of a pair the pole above the axis."""
        from flexapod.control.datasets import damping_dataset

        return damping_dataset(*damping_of(self.poles(), self.sample))
