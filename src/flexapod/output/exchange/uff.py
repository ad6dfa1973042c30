"""Frequency responses as a universal file of datasets 58, ASCII: one for each input and output."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError

if TYPE_CHECKING:
    from xarray import DataArray, Dataset

RESPONSE, COMPLEX_DOUBLE, FREQUENCY = 4, 6, 18  # function type, ordinate data type, abscissa data type
QUANTITIES = {"m": 8, "m/s": 11, "m/s^2": 12, "N": 9, "m s-1": 11, "m s-2": 12}  # specific data types of outputs
EXCITATION, GENERAL = 13, 1
DIRECTIONS = {axis: k for k, axis in enumerate(("x", "y", "z", "rx", "ry", "rz"), start=1)}
DIRECTIONS |= {axis: k for k, axis in enumerate(("fx", "fy", "fz", "mx", "my", "mz"), start=1)}
DIMS = ("output", "input", "frequency", "part")
EVEN = 1e-9  # of the spacing: how uneven a grid may be


def uff(data: Dataset) -> str:
    """A response (output, input, frequency, part) as text, dataset after dataset.

    The first line of each says output and input by name, the axes their units. Entity names are cut to ten characters;
    a channel with a number, as ``drive:3``, is that node, one with an axis, as ``tool:z``, that direction of node 1.
    Spacing is even where the frequencies are; of uneven ones the format keeps six digits.

    InputError: no such response among the variables.
    """
    found = next((x for x in getattr(data, "data_vars", {}).values() if set(x.dims) == set(DIMS)), None)
    if found is None:
        allowed = "a result of frequency_response, compliance or transmissibility"
        raise InputError("has no response over frequency", key="data", allowed=allowed)
    return "".join(
        f"{line}\n"
        for i in range(found.sizes["output"])
        for j in range(found.sizes["input"])
        for line in _set(found, i, j)
    )


def _set(found: DataArray, i: int, j: int) -> Iterator[str]:
    one = found.transpose(*DIMS).isel(output=i, input=j)
    frequency, values = one.frequency.values, one.values
    names = str(one.output.values), str(one.input.values)
    units = str(one.output_units.values), str(one.input_units.values)
    start, step = _spacing(frequency)
    yield from ("    -1", "    58")
    yield from (f"{' / '.join(names)}", "flexapod: frequency response", "NONE", "NONE", "NONE")
    yield f"{RESPONSE:5d}{0:10d}{0:5d}{0:10d}{_place(names[0])}{_place(names[1])}"
    even = step is not None
    yield f"{COMPLEX_DOUBLE:10d}{len(frequency):10d}{int(even):10d}{start:13.5E}{step or 0.0:13.5E}{0.0:13.5E}"
    yield _axis(FREQUENCY, "Frequency", "Hz")
    yield _axis(QUANTITIES.get(units[0], GENERAL), names[0], units[0])
    yield _axis(EXCITATION if units[1] == "N" else QUANTITIES.get(units[1], GENERAL), names[1], units[1])
    yield _axis(0, "NONE", "NONE")
    yield from _values(frequency, values, even=even)
    yield "    -1"


def _spacing(frequency: Array) -> tuple[float, float | None]:
    """First frequency and spacing; that is None where it is not the same throughout."""
    start = float(frequency[0]) if len(frequency) else 0.0
    if len(frequency) < 2:
        return start, None
    step = float(frequency[-1] - start) / (len(frequency) - 1)
    even = start + step * np.arange(len(frequency))
    return start, step if np.abs(frequency - even).max() <= EVEN * abs(step) else None


def _place(name: str) -> str:
    """Entity, node and direction of a channel."""
    entity, _, last = name.rpartition(":")
    node = int(last) if last.isdigit() else 1
    return f" {(entity or last)[:10]:<10}{node:10d}{DIRECTIONS.get(last, 0):4d}"


def _axis(kind: int, label: str, unit: str) -> str:
    return f"{kind:10d}{0:5d}{0:5d}{0:5d} {label[:20]:<20} {unit[:20]:<20}"


def _values(frequency: Array, values: Array, *, even: bool) -> Iterator[str]:
    texts = [f"{x:20.12E}{y:20.12E}" for x, y in values]
    if even:
        yield from ("".join(texts[k : k + 2]) for k in range(0, len(texts), 2))
    else:
        yield from (f"{f:13.5E}{text}" for f, text in zip(frequency, texts, strict=True))
