"""Text on parameter studies: points and extremes of a sweep, tables of a convergence study."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from flexapod.common.lazy_imports import LazyModule
from flexapod.common.quantities import column, text
from flexapod.common.ranking import first_largest, first_least
from flexapod.output.text.parts import Item, Lines, TextTable

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.design import sweeps
else:
    sweeps = LazyModule("flexapod.design.sweeps")

MESSAGES = 3  # different ones that are shown
EXTREMES = ("median", "smallest", "largest")


def sweep_as_dict(data: Dataset) -> dict[str, Any]:
    """Counts, messages, and the extremes of every scalar of a point."""
    states = Counter(data.status.values.tolist())
    return {
        "points": data.sizes["point"],
        **{state: states[state] for state in ("computed", "failed", "pending")},
        "failures": [{"message": m, "points": n, "first": first} for m, n, first in _failures(data)],
        "remarks": [{"remark": m, "points": n} for m, n in _remarks(data)],
        "scalars": {name: _extremes(data, name) for name in sweeps.scalar_names(data) if data[name].notnull().any()},
    }


def sweep_items(data: Dataset) -> Iterator[Item]:
    """Number of points in each state, messages of those that failed, extremes."""
    found = sweep_as_dict(data)
    states = [f"{found[state]} {state}" for state in ("computed", "failed", "pending") if found[state]]
    yield f"{found['points']} points: {', '.join(states)}."
    failures, scalars = found["failures"], found["scalars"]
    for entry in failures[:MESSAGES]:
        yield f"Failed: {_times(entry['points'])}, first point {entry['first']}: {entry['message']}"
    if len(failures) > MESSAGES:
        yield f"... and {len(failures) - MESSAGES} other messages: see the table."
    for entry in found["remarks"][:MESSAGES]:
        yield f"Warning at {_times(entry['points'])}: {entry['remark']}"
    if not scalars:
        return
    rows = []
    for name, extremes in scalars.items():
        unit = str(data[name].attrs.get("units", "1"))
        shown, values = column([extremes[key] for key in EXTREMES], "" if unit == "1" else unit)
        rows.append([name, shown, *values])
    yield ""
    yield TextTable(["scalar", "unit", *EXTREMES], rows, left=(0, 1))
    main = next(iter(scalars))
    for key in EXTREMES[1:]:
        at = scalars[main][f"{key}_at"]
        yield f"{main} is {key} at point {at['point']}{_place(data, at['point'])}."


def _extremes(data: Dataset, name: str) -> dict[str, Any]:
    values = data[name].values
    low, high = first_least(values), first_largest(values)
    return {
        "median": float(np.nanmedian(values)),
        "smallest": float(values[low]),
        "smallest_at": {"point": low, **_keys(data, low)},
        "largest": float(values[high]),
        "largest_at": {"point": high, **_keys(data, high)},
    }


def _keys(data: Dataset, point: int) -> dict[str, Any]:
    """Values of the varied keys at a point; keys that scatter by leg or joint are left to the table."""
    return {str(name): array.values[point].item() for name, array in data.coords.items() if _single(array)}


def _single(array: Any) -> bool:
    return array.dims == ("point",) and not isinstance(array.values[0], str | list)


def _place(data: Dataset, point: int) -> str:
    words = []
    for name, array in data.coords.items():
        if array.dims == ("point",):
            value, unit = array.values[point], str(array.attrs.get("units", ""))
            shown = value if isinstance(value, str) else text(float(value), "" if unit == "1" else unit, 4).strip()
            words.append(f"{name} = {shown}")
    return f" ({', '.join(words)})" if words else ""


def _failures(data: Dataset) -> list[tuple[str, int, int]]:
    """Messages, the most frequent first, with how many points and the first of them."""
    failed = np.flatnonzero(data.status.values == "failed").tolist()
    messages = data.message.values
    counts = Counter(messages[point] for point in failed)
    first = {messages[point]: point for point in reversed(failed)}
    return [(message, count, first[message]) for message, count in counts.most_common()]


def _remarks(data: Dataset) -> list[tuple[str, int]]:
    """Remarks by kind (what they say up to their first number), the most frequent first, each by its first wording."""
    kinds: dict[str, list[str]] = {}
    for remarks in data.remarks.values:
        for line in filter(None, str(remarks).splitlines()):
            words = line.split(": ", 1)[-1] if line.startswith("leg ") else line
            kinds.setdefault("".join(c for c in words if not c.isdigit())[:30], []).append(line)
    return [(lines[0], len(lines)) for lines in sorted(kinds.values(), key=len, reverse=True)]


def _times(count: int) -> str:
    return "1 point" if count == 1 else f"{count} points"


_TITLES = {"step": "Step", "shapes": "Shapes", "elements": "Beam elements", "segments": "Segments"}
_NAMES = {"deviation": "centre of mass", "tip": "tip deflection"}


def convergence_items(data: Dataset) -> Iterator[Item]:
    """The tables of the families, the conclusion from them, and the recommendation."""
    for i, group in enumerate(data.group.values):
        spectral = str(data.rate.values[i]).startswith("spectral")
        own = _error(float(data[f"own_error_{_quantities(data)[0]}"][i]))
        yield ""
        yield f"{_TITLES[str(group)]}: {data.rate.values[i]}."
        yield f"Errors against {data.group_reference.values[i]}, itself good to {own}."
        yield _table(data, str(group), orders=math.isfinite(float(data.order[i])) and not spectral)
    yield ""
    yield from _conclusion(data)
    for line in filter(None, (*str(data.attrs["notes"]).splitlines(), *str(data.attrs["warnings"]).splitlines())):
        yield f"Note: {line}"


def ladder_items(data: Dataset) -> Iterator[Item]:
    """Every fidelity with error and cost."""
    names, found = _quantities(data), _rows(data, "ladder")
    own = ", ".join(f"{_error(float(data.attrs[f'reference_error_{q}']))} in the {_NAMES[q]}" for q in names)
    yield ""
    yield (
        f"Every fidelity, with the same step: errors against {data.attrs['reference']} "
        f"(8 of these shapes differ from it by {own})."
    )
    _, each = column([1e6 * row["seconds_per_step"] for row in found], "", 3)
    unit, times = column([row["seconds"] for row in found], "s", 3)
    errors = (f"error, {_NAMES[q]}" for q in names)
    head = ["fidelity", "made of", *errors, "time of a step [µs]", f"time [{unit}]", ""]
    rows = [
        [row["fidelity"], row["label"], *(_error(row[f"error_{q}"]) for q in names), *times, row["failure"]]
        for row, *times in zip(found, each, times, strict=True)
    ]
    yield TextTable(head, rows, left=(0, 1, len(head) - 1))
    if data.attrs["notes"]:
        yield f"Note: {data.attrs['notes']}"


def convergence_as_dict(data: Dataset) -> dict[str, object]:
    """The table as plain data."""
    lines = {name: str(data.attrs.get(name, "")).splitlines() for name in ("recommended", "notes", "warnings")}
    names = [str(name) for name, values in data.data_vars.items() if values.dims == ("group",)]
    families = data.group.values if names else ()
    groups = [
        {"family": str(family), **{name: data[name].values[i].item() for name in names}}
        for i, family in enumerate(families)
    ]
    kept = ("accuracy", "quantity", "reference", "reference_error", "reference_error_deviation", "reference_error_tip")
    facts = {name: data.attrs[name] for name in kept if name in data.attrs}
    rows = [_row(data, i) for i in range(data.sizes["setting"])]
    return {**facts, "partial": bool(data.attrs["partial"]), **lines, "families": groups, "settings": rows}


def _table(data: Dataset, family: str, *, orders: bool) -> TextTable:
    """Rows of a family; without orders where the error falls with no power or not steadily."""
    names, rows = _quantities(data), _rows(data, family)
    columns = [(family, [row["label"].removeprefix("step ") for row in rows])]
    for q in names:
        unit, peaks = column([math.nan if row["failure"] else row[f"peak_{q}"] for row in rows], "m", 5)
        errors = ["reference" if row["reference"] else _error(row[f"error_{q}"]) for row in rows]
        columns += [(f"peak [{unit}], {_NAMES[q]}", peaks), ("error", errors)]
        columns += [("order", [_order(row[f"order_{q}"]) for row in rows])] if orders else []
    unit, times = column([row["seconds"] for row in rows], "s", 3)
    columns += [("steps", [str(row["steps"]) for row in rows]), (f"time [{unit}]", times)]
    columns += [("", [row["failure"] for row in rows])]
    head, values = zip(*columns, strict=True)
    return TextTable(head, list(zip(*values, strict=True)), left=(0, len(head) - 1))


def _conclusion(data: Dataset) -> Iterator[Item]:
    """The file's setting beside the recommended one, and the lines to paste."""
    good = f"against {data.attrs['reference']}, itself good to {_error(float(data.attrs['reference_error']))}"
    file, chosen = _rows(data, "file"), _rows(data, "recommended")
    for row in file:
        yield f"As in the file ({row['label']}): {_cost(data, row)}."
    for row in chosen:
        faster = ""
        if file and file[0]["seconds"] > 2 * row["seconds"]:
            faster = f", {file[0]['seconds'] / row['seconds']:.0f} times faster than the file's setting"
        yield f"Recommended for {data.attrs['accuracy']:g} ({row['label']}): {_cost(data, row)}{faster}; {good}."
        yield "In [simulation], in place of fidelity, basis, modes, step and tolerance:"
        yield ""
        yield Lines(str(data.attrs["recommended"]))


def _cost(data: Dataset, row: dict[str, Any]) -> str:
    if row["failure"]:
        return f"failed: {row['failure']}"
    errors = ", ".join(f"{_error(row[f'error_{q}'])} in the {_NAMES[q]}" for q in _quantities(data))
    return f"error {errors}; {row['steps']} steps, {_time(row['seconds'])}"


def _quantities(data: Dataset) -> list[str]:
    return [name for name in _NAMES if f"error_{name}" in data]


def _rows(data: Dataset, family: str) -> list[dict[str, Any]]:
    return [_row(data, i) for i, name in enumerate(data.family.values) if name == family]


def _row(data: Dataset, i: int) -> dict[str, Any]:
    return {
        str(name): values.values[i].item() for name, values in data.data_vars.items() if values.dims == ("setting",)
    }


def _error(value: object) -> str:
    return f"{value:.1e}" if isinstance(value, float) and math.isfinite(value) else "-"


def _order(value: object) -> str:
    return f"{value:.2f}" if isinstance(value, float) and math.isfinite(value) else ""


def _time(seconds: object) -> str:
    if not (isinstance(seconds, float) and math.isfinite(seconds)):
        return "-"
    return f"{1e6 * seconds:.3g} µs" if seconds < 1e-3 else text(seconds, "s")
