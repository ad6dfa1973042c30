"""What a sweep found, in words: how many points, which failed and why, where the main scalar is least and largest."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["as_dict", "show"]

MESSAGES = 3  # different ones that are shown


def as_dict(data: Dataset) -> dict[str, Any]:
    """Counts, messages, and the extremes of every scalar of a point."""
    from flexapod.surveys.sweeps import scalar_names

    states = Counter(data.status.values.tolist())
    return {
        "points": data.sizes["point"],
        **{state: states[state] for state in ("computed", "failed", "pending")},
        "failures": [{"message": m, "points": n, "first": first} for m, n, first in _failures(data)],
        "remarks": [{"remark": m, "points": n} for m, n in _remarks(data)],
        "scalars": {name: _extremes(data, name) for name in scalar_names(data) if data[name].notnull().any()},
    }


def show(data: Dataset) -> None:
    """Print what was found."""
    from flexapod.app.terminal import print_table, print_text
    from flexapod.study.words import column

    found = as_dict(data)
    states = [f"{found[state]} {state}" for state in ("computed", "failed", "pending") if found[state]]
    print_text(f"{found['points']} points: {', '.join(states)}.")
    for entry in found["failures"][:MESSAGES]:
        print_text(f"Failed: {_times(entry['points'])}, first point {entry['first']}: {entry['message']}")
    if len(found["failures"]) > MESSAGES:
        print_text(f"... and {len(found['failures']) - MESSAGES} other messages: see the table.")
    for entry in found["remarks"][:MESSAGES]:
        print_text(f"Warning at {_times(entry['points'])}: {entry['remark']}")
    rows = []
    for name, extremes in found["scalars"].items():
        unit = str(data[name].attrs.get("units", "1"))
        shown, values = column(
            [extremes[key] for key in ("median", "smallest", "largest")], "" if unit == "1" else unit
        )
        rows.append([name, shown, *values])
    if rows:
        print_text()
        print_table(["scalar", "unit", "median", "smallest", "largest"], rows, left=(0, 1))
        main = next(iter(found["scalars"]))
        for key in ("smallest", "largest"):
            at = found["scalars"][main][f"{key}_at"]
            print_text(f"{main} is {key} at point {at['point']}{_place(data, at['point'])}.")


def _extremes(data: Dataset, name: str) -> dict[str, Any]:
    values = data[name].values
    low, high = int(np.nanargmin(values)), int(np.nanargmax(values))
    return {
        "median": float(np.nanmedian(values)),
        "smallest": float(values[low]),
        "smallest_at": {"point": low, **_keys(data, low)},
        "largest": float(values[high]),
        "largest_at": {"point": high, **_keys(data, high)},
    }


def _keys(data: Dataset, point: int) -> dict[str, Any]:
    """What varies, at a point; keys that scatter by leg or joint are left to the table."""
    return {str(name): array.values[point].item() for name, array in data.coords.items() if _single(array)}


def _single(array: Any) -> bool:
    return array.dims == ("point",) and not isinstance(array.values[0], str | list)


def _place(data: Dataset, point: int) -> str:
    from flexapod.study.words import text

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
    for text in data.remarks.values:
        for line in filter(None, str(text).splitlines()):
            words = line.split(": ", 1)[-1] if line.startswith("leg ") else line
            kinds.setdefault("".join(c for c in words if not c.isdigit())[:30], []).append(line)
    return [(lines[0], len(lines)) for lines in sorted(kinds.values(), key=len, reverse=True)]


def _times(count: int) -> str:
    return "1 point" if count == 1 else f"{count} points"
