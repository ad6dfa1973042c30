"""An optimisation in words: what is best, which limits hold it, and what they cost."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from flexapod.analysis.scalar_outputs import OUTPUTS
from flexapod.common.quantities import text
from flexapod.output.text.parts import Item, Remarks, TextTable, warning_lines

if TYPE_CHECKING:
    from xarray import Dataset

STEPS = {"Hz": 1.0, "m": 1e-6, "N m-1": 1e6, "kg": 1.0}  # a unit of a limit, as engineers count


def value_text(name: str, value: float) -> str:
    """A value of an output with its unit."""
    unit = OUTPUTS[name].units
    return text(value, {"1": "", "N m-1": "N/m"}.get(unit, unit), 4)


def optimum_items(data: Dataset) -> Iterator[Item]:
    """The answer, the values, the limits, the front, remarks."""
    yield from optimum_sentences(data)
    rows = [
        [str(key), f"{start:.6g}", f"{found:.6g}", f"{low:.4g} to {high:.4g}"]
        for key, start, found, low, high in zip(
            data.variable.values, data.start.values, data.optimum.values, data.low.values, data.high.values, strict=True
        )
    ]
    rows += [[str(name), "", str(row), ""] for name, row in zip(data["list"].values, data.chosen.values, strict=True)]
    yield ""
    yield TextTable(["variable [SI]", "before", "now", "bounds"], rows)
    if "target" in data:
        yield ""
        name, front = data.attrs["objective_name"], data.attrs["front_name"]
        table = [
            [value_text(front, t), value_text(name, v) if np.isfinite(v) else "cannot"]
            for t, v in zip(data.target.values, data.front_objective.values, strict=True)
        ]
        yield TextTable([f"{front} at most", name], table)
    yield f"{data.attrs['calls']} studies computed."
    yield Remarks(warning_lines(data))


def optimum_sentences(data: Dataset) -> Iterator[str]:
    """The answer in words."""
    name = data.attrs["objective_name"]
    rows = list(
        zip(*(data[key].values for key in ("output", "sense", "limit", "reached", "kept", "multiplier")), strict=True)
    )
    if data.attrs["status"] != "kept":
        for output, sense, limit, reached, kept, _ in rows:
            if not kept:
                best, asked = value_text(output, reached), value_text(output, limit)
                yield f"Cannot: {output} {best} at best, for {asked} at {sense}."
        return
    yield f"{name}: {value_text(name, float(data.objective))}, before {value_text(name, float(data.objective_start))}."
    for output, sense, limit, reached, _, cost in rows:
        if cost:
            step = STEPS.get(OUTPUTS[output].units, 1.0)
            more = value_text(name, abs(cost) * step)
            verb = "costs" if (cost > 0) == (data.attrs["verb"] == "least") else "brings"
            yield f"{output} is held at {value_text(output, limit)}: {value_text(output, step)} more {verb} {more}."
        else:
            found, asked = value_text(output, reached), value_text(output, limit)
            yield f"{output} {found} keeps {asked} at {sense} with room to spare."
    for key, value, low, high in zip(*(data[k].values for k in ("variable", "optimum", "low", "high")), strict=True):
        if abs(value - low) < 1e-9 * (high - low) or abs(value - high) < 1e-9 * (high - low):
            yield f"{key} is at its bound."


def optimum_as_dict(data: Dataset) -> dict[str, Any]:
    """All numbers by name, the sentences, the attributes that say what they are of."""
    names = [name for name in data.variables if name in data]
    numbers = {str(name): data[name].values.tolist() for name in names}
    plain = {name: data.attrs[name] for name in ("status", "calls", "objective_name", "objective_units", "front_name")}
    return {**numbers, **plain, "sentences": list(optimum_sentences(data)), "remarks": warning_lines(data)}
