"""Sensitivities as text: for each output the numbers that it depends on, the strongest first, with bars."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from flexapod.common.quantities import text
from flexapod.design.tornado import bars, factor_words
from flexapod.output.text.parts import Bullets, Chapter, Item, TextTable

if TYPE_CHECKING:
    from xarray import Dataset

LONGEST = 12  # characters of a bar
SHOWN = 12  # keys of an output
UNITS = {"1": "", "N m-1": "N/m"}
HELD = "Loss factors are made viscous at one frequency; it is held."


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
    """Keys, outputs, and all numbers of each pair, NaN where there is none."""
    names = ("sensitivity", "uncertainty", "factor", "factor_effect", "value")
    plain = {name: data[name].values.tolist() for name in names}
    words = {name: data[name].values.tolist() for name in ("key", "output", "output_units", "note")}
    return {**words, **plain, "remarks": [HELD]}
