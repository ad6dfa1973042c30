"""Sensitivities as text: for each output the numbers that it depends on, the strongest first, with bars."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from flexapod.common.quantities import text
from flexapod.output.text.parts import Bullets, Chapter, Item, TextTable

if TYPE_CHECKING:
    from xarray import Dataset

LONGEST = 12  # characters of a bar
SHOWN = 12  # keys of an output
LEAST = 1e-3  # of the largest sensitivity of the output: what is less is left out
UNITS = {"1": "", "N m-1": "N/m"}
HELD = "Loss factors are made viscous at one frequency; it is held."


class Bar(NamedTuple):
    """A key and what it does to an output: sensitivity, change by its `factor` [%], both perhaps NaN."""

    key: str
    sensitivity: float
    factor: float
    effect: float


def bars(data: Dataset, output: str) -> list[Bar]:
    """Keys that an output depends on, the strongest first."""
    one = data.sel(output=output)
    rows = zip(one.key.values, one.sensitivity.values, one.factor.values, one.factor_effect.values, strict=True)
    known = [Bar(str(key), *map(float, rest)) for key, *rest in rows if np.isfinite(rest[0])]
    known.sort(key=lambda bar: (-abs(bar.sensitivity), bar.key))
    return [bar for bar in known if abs(bar.sensitivity) > LEAST * abs(known[0].sensitivity)]


def factor_words(bar: Bar) -> str:
    """Change of the output by halving or doubling, in words; empty where nothing of that kind is asked."""
    if not np.isfinite(bar.effect):
        return ""
    return f"{'half' if bar.factor < 1 else 'double'}: {bar.effect:+.2g} %"


def sensitivity_items(data: Dataset) -> Iterator[Item]:
    """A table with bars for each output, then what has no sensitivity."""
    for output in map(str, data.output.values):
        one = data.sel(output=output)
        unit, rows = str(one.output_units.item()), bars(data, output)
        most = abs(rows[0].sensitivity) if rows else 1.0
        table = [
            [
                bar.key,
                f"{bar.sensitivity:+.3f}",
                ("+" if bar.sensitivity > 0 else "-") * max(1, round(LONGEST * abs(bar.sensitivity) / most)),
                factor_words(bar),
            ]
            for bar in rows[:SHOWN]
        ]
        title = f"{output} {text(float(one.value), UNITS.get(unit, unit))}: per cent for a per cent"
        yield Chapter(
            title, [TextTable(["key", "%/%", "", "instead"], table, left=(0, 2, 3))] if table else ["Nothing."]
        )
    if surprises := [*_surprises(data)]:
        yield Chapter("What makes up for something else", [Bullets(surprises)])
    if notes := [*_notes(data)]:
        yield Chapter("Without a number", [Bullets(notes)])
    yield HELD


def _surprises(data: Dataset) -> Iterator[str]:
    """Errors of which half is worse: they cancel others."""
    for output in map(str, data.output.values):
        if str(data.output_units.sel(output=output).item()) != "m":
            continue
        for bar in bars(data, output):
            if bar.factor < 1 and bar.effect > 0.05:
                value = float(data.value.sel(output=output))
                then = text(value * (1 + bar.effect / 100), "m")
                yield f"{output}: half of {bar.key} is worse, {then} for {text(value, 'm')}: it cancels other errors."


def _notes(data: Dataset) -> Iterator[str]:
    """Notes of keys and outputs that have no number."""
    for k, key in enumerate(map(str, data.key.values)):
        said: dict[str, list[str]] = {}
        for j, output in enumerate(map(str, data.output.values)):
            note = str(data.note.values[k, j])
            if note not in ("", "no effect"):
                said.setdefault(note, []).append(output)
        for note, outputs in said.items():
            yield f"{key}, {', '.join(outputs)}: {note}."


def sensitivity_as_dict(data: Dataset) -> dict[str, Any]:
    """Keys, outputs, and all numbers of each pair, None where there is none."""
    plain = {
        name: np.where(np.isfinite(data[name].values), data[name].values.astype(object), None).tolist()
        for name in ("sensitivity", "uncertainty", "factor", "factor_effect", "value")
    }
    words = {name: data[name].values.tolist() for name in ("key", "output", "output_units", "note")}
    return {**words, **plain, "remarks": [HELD]}
