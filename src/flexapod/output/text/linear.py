"""Text of `flexapod frf` and `flexapod damp`: responses in a line each, poles in a table."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from flexapod.common.quantities import column, number, sentence
from flexapod.control.datasets import channel_units, join_complex, response_unit, significant_pairs
from flexapod.output.text.parts import Item, TextTable

if TYPE_CHECKING:
    from xarray import Dataset

ROWS = 42  # of a table on a terminal
GROWS = 1e-9  # damping ratio below minus which a pole grows


def frf_items(data: Dataset, pose: str | None, drives: str) -> Iterator[Item]:
    """Each response: its size at the lowest frequency, and where it is largest; with its unit."""
    f = data.frequency.values
    yield f"{_where(pose, drives)}, {number(f[0])} to {number(f[-1])} Hz, {len(f)} frequencies."
    yield ""
    size = np.abs(join_complex(data.frequency_response).transpose("output", "input", "frequency").values)
    out, into = (channel_units(data, dim) for dim in ("output", "input"))
    curves = dict(zip(product(out, into), size.reshape(-1, len(f)), strict=True))
    rows = []
    for output, input in significant_pairs({pair: float(curve.max()) for pair, curve in curves.items()}, out):
        curve, unit = curves[output, input], response_unit(out[output], into[input])
        at = int(curve.argmax())
        rows.append((output, input, f"{curve[0]:.4g}", f"{curve[at]:.4g}", f"{f[at]:.4g}", unit))
    head = ["output", "input", f"at {number(f[0])} Hz", "largest", "at [Hz]", "unit"]
    yield TextTable(head, rows[:ROWS], left=(0, 1, 5))
    if len(rows) > ROWS:
        yield f"The first {ROWS} of {len(rows)} responses; --out DIR or --json has all."
    if nothing := len(curves) - len(rows):
        yield sentence(f"{nothing} more are 0 but for rounding")


def frf_as_dict(data: Dataset, files: Sequence[Path]) -> dict[str, object]:
    """Responses as plain data: real and imaginary parts by output and input."""
    values = data.frequency_response.transpose("output", "input", "part", "frequency").values
    return {
        "frequency": data.frequency.values.tolist(),
        "responses": [
            {
                "output": str(output),
                "input": str(input),
                "output_unit": str(data.output_units.values[i]),
                "input_unit": str(data.input_units.values[j]),
                "real": values[i, j, 0].tolist(),
                "imaginary": values[i, j, 1].tolist(),
            }
            for i, output in enumerate(data.output.values)
            for j, input in enumerate(data.input.values)
        ],
        "files": files,
    }


def damp_items(data: Dataset, pose: str | None, drives: str, count: int) -> Iterator[Item]:
    """The slowest poles, and how many of all grow."""
    yield f"{_where(pose, drives)}."
    yield ""
    pole, ratio = join_complex(data.pole).values, data.damping_ratio.values
    shown = slice(0, count)
    _, frequencies = column(data.frequency.values[shown], "Hz", 6)
    texts = [_ratio(z, s) for z, s in zip(ratio[shown], pole[shown], strict=True)]
    decay = [f"{-1 / s.real:.4g}" if s.real < 0 else "never" for s in pole[shown]]
    yield TextTable(
        ["pole", "frequency [Hz]", "damping [%]", "time constant [s]"],
        list(zip(map(str, data.mode.values[shown]), frequencies, texts, decay, strict=True)),
    )
    if data.sizes["mode"] > count:
        yield f"The slowest {count} of {data.sizes['mode']} poles; more with --count."
    grow = np.flatnonzero(ratio < -GROWS)
    if len(grow):
        at = ", ".join(f"{data.frequency.values[k]:.4g} Hz" for k in grow[:4])
        yield f"Warning: {len(grow)} {'pole grows' if len(grow) == 1 else 'poles grow'}: at {at}."


def _ratio(ratio: float, pole: complex) -> str:
    return f"{100 * ratio:.4g}" if pole.imag else "real"


def damp_as_dict(data: Dataset) -> dict[str, object]:
    """Poles as plain data."""
    pole = join_complex(data.pole).values
    columns = (
        data.frequency.values.tolist(),
        data.damping_ratio.values.tolist(),
        np.real(pole).tolist(),
        np.imag(pole).tolist(),
    )
    names = ("frequency", "damping_ratio", "real", "imaginary")
    return {"poles": [dict(zip(names, row, strict=True)) for row in zip(*columns, strict=True)]}


def _where(pose: str | None, drives: str) -> str:
    where = f"at {pose} from home" if pose else "at home"
    held = "drives as the study has them" if drives == "given" else "drives released, with the forces that held them"
    return f"About the static equilibrium {where}, {held}"
