"""Results of linear systems as Datasets, and linear systems for other programs and files.

Datasets have named channels, and complex numbers along `part`. Files of MATLAB, NumPy, JSON and NetCDF have all
names and units.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from flexapod.common.arguments import frequencies
from flexapod.common.arrays import Array, Complex
from flexapod.common.datasets import build_dataset
from flexapod.common.errors import ComputationError, InputError
from flexapod.common.files import path_of, replace_file
from flexapod.common.lazy_imports import load_module
from flexapod.control.frequency_response import pole_properties

if TYPE_CHECKING:
    import xarray as xr

    from flexapod.control.state_space import StateSpace
    from flexapod.solve.linear.random_vibration import RandomVibration

PARTS = ["real", "imaginary"]
ROUNDING = 1e-8  # of the largest response of its kind: what is no more is zero
RESPONSE = ("frequency_response", "response of outputs to inputs", "output_units / input_units")


class Channels(Protocol):
    """Protocol of objects with named inputs and outputs and their units."""

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the inputs."""
        ...

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the outputs."""
        ...

    @property
    def units(self) -> Mapping[str, str]:
        """Unit of each channel that has one."""
        ...


def split_complex(values: Complex) -> Array:
    """Complex numbers with a last axis of real and imaginary part: files of NetCDF have no complex ones."""
    return np.ascontiguousarray(values).view(float).reshape(*values.shape, 2)


def join_complex(values: xr.DataArray) -> xr.DataArray:
    """Complex numbers of an array with the dimension `part`."""
    return values.sel(part="real", drop=True) + 1j * values.sel(part="imaginary", drop=True)


def response_unit(output: str, input: str) -> str:
    """Unit of a response by those of its channels."""
    if output == input:
        return "1"
    return f"{output}/({input})" if " " in input or "/" in input else output if input == "1" else f"{output}/{input}"


def channel_units(data: xr.Dataset, dim: str) -> dict[str, str]:
    """Units of channels along a dimension, `input` or `output`, by name."""
    return dict(zip(data[dim].values.tolist(), data[f"{dim}_units"].values.tolist(), strict=True))


def significant_pairs(sizes: Mapping[tuple[str, str], float], units: Mapping[str, str]) -> list[tuple[str, str]]:
    """Pairs of output and input whose size is above rounding, relative to outputs of like unit by the same input.

    `units` of the outputs: alike are those of one, where a radian counts as a metre, and 1 N m as 1 N. What symmetry
    makes zero comes out at 3e-9 and less, of a pose of equilibrium that is symmetric to that.
    """
    kind = {output: units[output].replace("rad", "m").replace("N m", "N") for output, _ in sizes}
    most: dict[tuple[str, str], float] = {}
    for (output, by), size in sizes.items():
        most[kind[output], by] = max(size, most.get((kind[output], by), 0.0))
    return [(output, by) for (output, by), size in sizes.items() if not size <= ROUNDING * most[kind[output], by]]


def channel_labels(system: Channels, *dims: str) -> dict[str, tuple[str, list[str]]]:
    """Names and units of channels as coordinates: `output`, `output_units`, `input`, `input_units`."""
    names = {"input": system.inputs, "output": system.outputs}
    labels = {dim: (dim, list(names[dim])) for dim in dims}
    return labels | {f"{dim}_units": (dim, [system.units.get(name, "1") for name in names[dim]]) for dim in dims}


def response_dataset(
    system: Channels, hz: ArrayLike, values: Complex, words: tuple[str, str, str] = RESPONSE
) -> xr.Dataset:
    """Complex values (output, input, frequency, part) under the name of `words`: name, long name, unit."""
    frequency = frequencies(hz)
    name, long_name, unit = words
    attrs = {"long_name": long_name, "units": unit}
    return build_dataset(
        {name: (("output", "input", "frequency", "part"), split_complex(values), attrs)},
        channel_labels(system, "output", "input")
        | {"frequency": ("frequency", frequency, {"units": "Hz"}), "part": ("part", PARTS)},
    )


@dataclass(frozen=True, kw_only=True)
class MeasuredChannels:
    """Channels of a measurement."""

    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    units: Mapping[str, str]


def frf_dataset(frequency: Array, values: Complex, outputs: Mapping[str, str], inputs: Mapping[str, str]) -> xr.Dataset:
    """`frequency_response` of values (outputs, inputs, f) at frequencies [Hz], from wherever they are.

    `outputs` and `inputs` are units by name: at the point where a structure is hit both have one name and two units.
    """
    data = response_dataset(MeasuredChannels(inputs=(*inputs,), outputs=(*outputs,), units={}), frequency, values)
    return data.assign_coords(output_units=("output", [*outputs.values()]), input_units=("input", [*inputs.values()]))


def h2_dataset(system: StateSpace, values: Array, why: dict[tuple[int, int], str]) -> xr.Dataset:
    """`h2_norm` and `reason` (output, input); attribute `warnings`: a line for each channel that is infinite.

    Of a sampled system it is rms by rms, of white samples; of a continuous one rms by the root of a density.
    """
    reason = np.full(values.shape, "", dtype=object)
    for at, words in why.items():
        reason[at] = words
    lines = [f"{system.outputs[i]} by {system.inputs[j]} is infinite: {words}" for (i, j), words in why.items()]
    attrs = {"long_name": "H2 norm", "units": "output_units / input_units * Hz**0.5"}
    if system.sample is not None:
        attrs = {"long_name": "H2 norm: rms by the rms of white samples", "units": "output_units / input_units"}
    return build_dataset(
        {
            "h2_norm": (("output", "input"), values, attrs),
            "reason": (("output", "input"), reason.astype(str), {"long_name": "why the norm is infinite"}),
        },
        channel_labels(system, "output", "input"),
        {"warnings": "\n".join(lines)},
    )


def hinf_dataset(value: float, hertz: float) -> xr.Dataset:
    """`hinf_norm` and the `frequency` of it."""
    return build_dataset(
        {
            "hinf_norm": ((), value, {"long_name": "largest singular value over frequency"}),
            "frequency": ((), hertz, {"units": "Hz", "long_name": "frequency of the largest singular value"}),
        }
    )


def vibration_dataset(system: StateSpace, found: RandomVibration, error: float) -> xr.Dataset:
    """`psd` and `cumulative_rms` over `spectrum_frequency`, `rms`, `covariance` of outputs."""
    labels = channel_labels(system, "output")
    labels["output_b"] = ("output_b", list(system.outputs))
    f = ("spectrum_frequency", found.frequency, {"units": "Hz"})
    along = ("spectrum_frequency", "output")
    return build_dataset(
        {
            "psd": (along, found.psd, {"units": "output_units**2 / Hz", "long_name": "one-sided spectral density"}),
            "cumulative_rms": (along, found.cumulative, {"units": "output_units", "long_name": "rms from here up"}),
            "rms": ("output", found.rms, {"units": "output_units", "long_name": "standard deviation"}),
            "covariance": (("output", "output_b"), found.covariance, {"long_name": "covariance of outputs"}),
        },
        labels | {"spectrum_frequency": f},
        {"estimated_error": error},
    )


def source_dataset(system: StateSpace, found: RandomVibration, error: float) -> xr.Dataset:
    """`rms_by_source` (source, output), whose squares add up to those of `rms`."""
    words = {"units": "output_units", "long_name": "standard deviation by source"}
    return build_dataset(
        {
            "rms_by_source": (("source", "output"), found.by_source, words),
            "rms": ("output", found.rms, {"units": "output_units", "long_name": "standard deviation"}),
        },
        channel_labels(system, "output") | {"source": ("source", list(found.sources))},
        {"estimated_error": error},
    )


def history_dataset(system: StateSpace, time: Array, values: Array, name: str) -> xr.Dataset:
    """`step_response` or `impulse_response` (output, input, time)."""
    words = {"long_name": name.replace("_", " "), "units": "output_units / input_units"}
    if name.startswith("impulse"):
        words |= {"units": "output_units / (input_units s)", "feed_through": "its impulse at 0 is left out"}
    return build_dataset(
        {name: (("output", "input", "time"), values, words)},
        channel_labels(system, "output", "input") | {"time": ("time", time, {"units": "s"})},
    )


def impedance_dataset(
    frequency: Array, values: Complex, parallel: tuple[Array, Array], series: tuple[Array, Array]
) -> xr.Dataset:
    """`impedance` over `frequency`, and springs and dampers with the same."""
    found: dict[str, tuple[object, ...]] = {
        "impedance": (
            ("frequency", "part"),
            split_complex(values),
            {"units": "N s/m", "long_name": "force over velocity"},
        )
    }
    for name, (stiffness, damping) in {"parallel": parallel, "series": series}.items():
        pair = f"spring and damper in {name}"
        found[f"{name}_stiffness"] = ("frequency", stiffness, {"units": "N/m", "long_name": f"spring of a {pair}"})
        found[f"{name}_damping"] = ("frequency", damping, {"units": "N s/m", "long_name": f"damper of a {pair}"})
    return build_dataset(found, {"frequency": ("frequency", frequency, {"units": "Hz"}), "part": PARTS})


def system_dataset(system: StateSpace) -> xr.Dataset:
    """Matrices A, B, C, D (D_rate) with named states, inputs and outputs; `sample` [s], 0 of a continuous system."""
    labels = channel_labels(system, "output", "input")
    labels |= {name: (name, list(system.states)) for name in ("state", "state_b")}
    dims = {"A": ("state", "state_b"), "B": ("state", "input"), "C": ("output", "state"), "D": ("output", "input")}
    dims |= {} if system.D_rate is None else {"D_rate": dims["D"]}
    found = {name: (dim, getattr(system, name)) for name, dim in dims.items()}
    return build_dataset(found, labels, {"sample": system.sample or 0.0, "sample_units": "s"})


def locus_dataset(factors: Array, poles: Complex, zeros: Complex, sample: float | None) -> xr.Dataset:
    """`pole`, `frequency`, `damping_ratio` over `gain` and `branch`, `open_zero`, where branches end."""
    _, frequency, ratio = pole_properties(poles, sample)
    names = {"units": "s-1" if sample is None else "1"}
    return build_dataset(
        {
            "pole": (("gain", "branch", "part"), split_complex(poles), names | {"long_name": "pole of the loop"}),
            "frequency": (("gain", "branch"), frequency, {"units": "Hz", "long_name": "size over 2 pi"}),
            "damping_ratio": (("gain", "branch"), ratio, {"units": "1", "long_name": "damping ratio"}),
            "open_zero": (("zero", "part"), split_complex(zeros), names | {"long_name": "zero of the loop gain"}),
        },
        {"gain": ("gain", factors, {"long_name": "factor on the controller"}), "part": PARTS},
        {} if sample is None else {"sample": sample},
    )


def best_dataset(gain: float, ratio: float, frequency: float, factors: Array, ratios: Array) -> xr.Dataset:
    """`gain`, `damping_ratio`, `frequency` of the best, `least_damping_ratio` over `factor`."""
    ratio_words = {"units": "1", "long_name": "least damping ratio of the poles"}
    return build_dataset(
        {
            "gain": ((), gain, {"long_name": "factor on the controller"}),
            "damping_ratio": ((), ratio, ratio_words),
            "frequency": ((), frequency, {"units": "Hz", "long_name": "frequency of the pole that has it"}),
            "least_damping_ratio": ("factor", ratios, ratio_words),
        },
        {"factor": ("factor", factors, {"long_name": "factor on the controller"})},
    )


def margins_dataset(
    actuators: tuple[str, ...], each: list[dict[str, tuple[float, float]]], unstable: int
) -> xr.Dataset:
    """Margins by `actuator`, and their frequencies."""
    both = {"gain_margin": ("1", ("below", "above"), "factor at which the loop is at its limit")}
    single = {
        "phase_margin": ("rad", "phase", "lag that the loop bears"),
        "delay_margin": ("s", "delay", "further delay that the loop bears"),
        "modulus_margin": ("1", "modulus", "least distance of the loop gain from -1"),
    }
    found, at = {}, {"units": "Hz", "long_name": "frequency at which it is so"}
    for name, (unit, keys, words) in both.items():
        values = np.array([[one[key] for key in keys] for one in each])
        found[name] = (("actuator", "side"), values[..., 0], {"units": unit, "long_name": words})
        found[f"{name}_frequency"] = (("actuator", "side"), values[..., 1], at)
    for name, (unit, key, words) in single.items():
        values = np.array([one[key] for one in each])
        found[name] = ("actuator", values[:, 0], {"units": unit, "long_name": words})
        found[f"{name}_frequency"] = ("actuator", values[:, 1], at)
    labels = {"actuator": list(actuators), "side": ["below", "above"]}
    return build_dataset(found, labels, {"unstable_poles": unstable})


def damping_dataset(poles: Complex, frequency: Array, ratio: Array) -> xr.Dataset:
    """`frequency`, `damping_ratio`, `pole` (mode, part) of poles that are sorted by frequency."""
    return build_dataset(
        {
            "frequency": ("mode", frequency, {"units": "Hz", "long_name": "size of the pole over 2 pi"}),
            "damping_ratio": ("mode", ratio, {"units": "1", "long_name": "damping ratio"}),
            "pole": (("mode", "part"), split_complex(poles), {"units": "s-1", "long_name": "pole"}),
        },
        {"mode": np.arange(1, len(poles) + 1), "part": PARTS},
    )


def to_control(system: StateSpace) -> Any:
    """See `StateSpace.to_control`."""
    try:
        control: Any = load_module("control")  # it has no types
    except ImportError:
        raise ComputationError(
            "python-control is not installed", next_step='pip install "flexapod[control]", or pip install control'
        ) from None
    if not (system.inputs and system.outputs):
        raise InputError("has no inputs or no outputs", key="system", value=system, allowed="at least one of each")
    if system.D_rate is not None:
        by = ", ".join(system.inputs[k] for k in np.flatnonzero(system.D_rate.any(axis=0)))
        raise InputError(
            "has outputs that follow rates of inputs, which python-control has no place for", key="system", value=by,
            next_step=".select(inputs, outputs) takes others; a low_pass of the controller's rates has none",
        )  # fmt: skip
    names = {"inputs": list(system.inputs), "outputs": list(system.outputs), "states": list(system.states)}
    return control.ss(system.A, system.B, system.C, system.D, system.sample or 0, **names)


def save(system: StateSpace, path: str | Path) -> Path:
    """See `StateSpace.save`."""
    path = path_of(path, "path")
    write = WRITERS.get(path.suffix.lower())
    if write is None:
        raise InputError("is not a format of linear systems", key="path", value=path.name, allowed=", ".join(WRITERS))
    with replace_file(path) as temporary:
        write(system, temporary)
    return path


def _named(system: StateSpace) -> dict[str, np.ndarray]:
    """Matrices and names; units of inputs and outputs; a sample time of 0 is that of a continuous system.

    `D_rate` only where outputs follow rates of inputs.
    """
    names = {"inputs": system.inputs, "outputs": system.outputs, "states": system.states}
    units = {f"{name[:-1]}_units": [system.units.get(x, "1") for x in names[name]] for name in ("inputs", "outputs")}
    texts = {name: np.array(list(values), dtype=str) for name, values in (names | units).items()}
    matrices = {name: getattr(system, name) for name in "ABCD"}
    matrices |= {} if system.D_rate is None else {"D_rate": system.D_rate}
    return matrices | texts | {"sample": np.array(system.sample or 0.0)}


def _mat(system: StateSpace, path: Path) -> None:
    from scipy.io import savemat

    given = {name: x.astype(object) if x.dtype.kind == "U" else x for name, x in _named(system).items()}  # as cells
    with path.open("wb") as file:
        savemat(file, given, oned_as="row")


def _npz(system: StateSpace, path: Path) -> None:
    with path.open("wb") as file:
        np.savez(file, allow_pickle=False, **_named(system))


def _json(system: StateSpace, path: Path) -> None:
    path.write_text(json.dumps({name: x.tolist() for name, x in _named(system).items()}), encoding="utf-8")


def _nc(system: StateSpace, path: Path) -> None:
    system_dataset(system).to_netcdf(path, engine="netcdf4")


WRITERS: dict[str, Callable[[StateSpace, Path], None]] = {".mat": _mat, ".npz": _npz, ".json": _json, ".nc": _nc}
