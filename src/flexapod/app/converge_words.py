"""A convergence study on the terminal: a table a family, the file's setting, the recommended one."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from flexapod.app.terminal import print_table, print_text

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["as_dict", "show", "show_ladder"]

_TITLES = {"step": "Step", "shapes": "Shapes", "elements": "Beam elements", "segments": "Segments"}
_NAMES = {"deviation": "centre of mass", "tip": "tip deflection"}


def show(data: Dataset) -> None:
    """Print the tables of the families, what they tell, and the recommendation."""
    for i, group in enumerate(data.group.values):
        spectral = str(data.rate.values[i]).startswith("spectral")
        own = _error(float(data[f"own_error_{_quantities(data)[0]}"][i]))
        print_text()
        print_text(f"{_TITLES[str(group)]}: {data.rate.values[i]}.")
        print_text(f"Errors against {data.group_reference.values[i]}, itself good to {own}.")
        _table(data, str(group), orders=math.isfinite(float(data.order[i])) and not spectral)
    print_text()
    _conclusion(data)
    for line in filter(None, (*str(data.attrs["notes"]).splitlines(), *str(data.attrs["warnings"]).splitlines())):
        print_text(f"Note: {line}")


def show_ladder(data: Dataset) -> None:
    """Print every fidelity with error and cost."""
    from flexapod.study.words import column

    names = _quantities(data)
    print_text()
    own = ", ".join(f"{_error(float(data.attrs[f'reference_error_{q}']))} in the {_NAMES[q]}" for q in names)
    print_text(
        f"Every fidelity, with the same step: errors against {data.attrs['reference']} "
        f"(8 of these shapes differ from it by {own})."
    )
    found = _rows(data, "ladder")
    _, each = column([1e6 * row["seconds_per_step"] for row in found], "", 3)
    unit, times = column([row["seconds"] for row in found], "s", 3)
    errors = (f"error, {_NAMES[q]}" for q in names)
    head = ["fidelity", "made of", *errors, "time of a step [µs]", f"time [{unit}]", ""]
    rows = [
        [
            str(row["fidelity"]),
            str(row["label"]),
            *(_error(row[f"error_{q}"]) for q in names),
            each[i],
            times[i],
            str(row["failure"]),
        ]
        for i, row in enumerate(found)
    ]
    print_table(head, rows, left=(0, 1, len(head) - 1))
    if data.attrs["notes"]:
        print_text(f"Note: {data.attrs['notes']}")


def as_dict(data: Dataset) -> dict[str, object]:
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


def _table(data: Dataset, family: str, *, orders: bool) -> None:
    """Rows of a family; without orders where the error falls with no power or not steadily."""
    from flexapod.study.words import column

    names, rows = _quantities(data), _rows(data, family)
    columns = [[str(row["label"]).removeprefix("step ") for row in rows]]
    head = [family]
    for q in names:
        unit, peaks = column([math.nan if row["failure"] else row[f"peak_{q}"] for row in rows], "m", 5)
        head += [f"peak [{unit}], {_NAMES[q]}", "error"]
        columns += [peaks, ["reference" if row["reference"] else _error(row[f"error_{q}"]) for row in rows]]
        if orders:
            head.append("order")
            columns.append([_order(row[f"order_{q}"]) for row in rows])
    unit, times = column([row["seconds"] for row in rows], "s", 3)
    columns += [[str(row["steps"]) for row in rows], times, [str(row["failure"]) for row in rows]]
    head += ["steps", f"time [{unit}]", ""]
    print_table(head, [list(line) for line in zip(*columns, strict=True)], left=(0, len(head) - 1))


def _conclusion(data: Dataset) -> None:
    """The file's setting beside the recommended one, and the lines to paste."""
    good = f"against {data.attrs['reference']}, itself good to {_error(float(data.attrs['reference_error']))}"
    file, chosen = _rows(data, "file"), _rows(data, "recommended")
    for row in file:
        print_text(f"As in the file ({row['label']}): {_cost(data, row)}.")
    for row in chosen:
        faster = ""
        if file and file[0]["seconds"] > 2 * row["seconds"]:
            faster = f", {file[0]['seconds'] / row['seconds']:.0f} times faster than the file's setting"
        print_text(f"Recommended for {data.attrs['accuracy']:g} ({row['label']}): {_cost(data, row)}{faster}; {good}.")
        print_text("In [simulation], in place of fidelity, basis, modes, step and tolerance:")
        print_text()
        for line in str(data.attrs["recommended"]).splitlines():
            print_text(line, indent=4)


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
    from flexapod.study.words import text

    if not (isinstance(seconds, float) and math.isfinite(seconds)):
        return "-"
    return f"{1e6 * seconds:.3g} µs" if seconds < 1e-3 else text(seconds, "s")
