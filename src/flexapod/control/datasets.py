"""Answers of a linear system as Datasets: named channels, complex numbers along `part`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from flexapod.arrays import Array

if TYPE_CHECKING:
    from flexapod.control.state_space import StateSpace

__all__ = ["PARTS", "channel_labels", "complex_of", "damping_dataset", "in_parts", "response_dataset"]

Complex = NDArray[np.complex128]
PARTS = ["real", "imaginary"]


def in_parts(values: Complex) -> Array:
    """Complex numbers with a last axis of real and imaginary part: files of NetCDF have no complex ones."""
    return np.ascontiguousarray(values).view(float).reshape(*values.shape, 2)


def complex_of(values: xr.DataArray) -> xr.DataArray:
    """Complex numbers of an array with the dimension `part`."""
    return values.sel(part="real", drop=True) + 1j * values.sel(part="imaginary", drop=True)


def channel_labels(system: StateSpace, *dims: str) -> dict[str, tuple[str, list[str]]]:
    """Names and units of channels as coordinates: `output`, `output_units`, `input`, `input_units`."""
    names = {"input": system.inputs, "output": system.outputs}
    labels = {dim: (dim, list(names[dim])) for dim in dims}
    return labels | {f"{dim}_units": (dim, [system.units.get(name, "1") for name in names[dim]]) for dim in dims}


def response_dataset(system: StateSpace, hz: ArrayLike) -> xr.Dataset:
    """`frequency_response` (output, input, frequency, part) in the output's unit over the input's."""
    frequency = np.atleast_1d(np.asarray(hz, dtype=float))
    words = {"long_name": "response of outputs to inputs", "units": "output_units / input_units"}
    return xr.Dataset(
        {"frequency_response": (("output", "input", "frequency", "part"), in_parts(system.at(frequency)), words)},
        channel_labels(system, "output", "input")
        | {"frequency": ("frequency", frequency, {"units": "Hz"}), "part": ("part", PARTS)},
    )


def damping_dataset(poles: Complex, frequency: Array, ratio: Array) -> xr.Dataset:
    """`frequency`, `damping_ratio`, `pole` (mode, part) of poles that are sorted by frequency."""
    return xr.Dataset(
        {
            "frequency": ("mode", frequency, {"units": "Hz", "long_name": "size of the pole over 2 pi"}),
            "damping_ratio": ("mode", ratio, {"units": "1", "long_name": "damping ratio"}),
            "pole": (("mode", "part"), in_parts(poles), {"units": "s-1", "long_name": "pole"}),
        },
        {"mode": np.arange(1, len(poles) + 1), "part": PARTS},
    )
