"""Rows and tables of a study file that can be added and taken out, and lists that are too long for a form."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import tomlkit

from flexapod.app.browser.document import (
    Document,
    TypedQuantity,
    check_toml,
    quantity,
)
from flexapod.model.file.fields import NotedField
from flexapod.model.file.study_text import rename_table, replace_lines, table_spans, with_each_leg

STARTS: dict[str, dict[str, object]] = {"load": {"wrench": [0] * 6}, "initial": {"start": "equilibrium"}}
"""Tables that a robot's study may leave out, as they are added: they change nothing yet."""

POINTS = "motion.points"


_MANY = dict(enumerate("two three four five six seven eight".split(), start=2))


@dataclass(frozen=True, kw_only=True)
class StructureEdit:
    """A change that a button makes.

    `place`: the folder that shows it, ``[motion]``, "" where there is none yet; `inside`: the folder in that one;
    `label`; `hint`; `apply`: the document after it, which may raise InputError; `rows`: key of the list whose row it
    adds or takes out, "" where it is none.
    """

    place: str
    inside: str = ""
    label: str
    hint: str
    apply: Callable[[Document], Document]
    rows: str = ""


def structure_edits(document: Document) -> list[StructureEdit]:
    """Changes that add parts to a study file or take them out; none for a text that is not TOML."""
    try:
        data = tomllib.loads(document.text)
    except tomllib.TOMLDecodeError:
        return []
    found = _motion(data.get("motion"))
    if "robot" in data:
        found += _legs(data) + _tables(data)
    return found


def _motion(motion: object) -> list[StructureEdit]:
    if not isinstance(motion, dict):
        return []
    if motion.get("type") == "combined" and "amplitudes" not in motion:
        hint = "The axes that move; others are added below"
        start = {"roll": "1 deg"}
        return [_offer("[motion]", "Add amplitudes", hint, lambda d: d.with_value("motion.amplitudes", start))]
    if motion.get("type") != "waypoints":
        return []
    points = motion.get("points", [])
    if not isinstance(points, list) or not all(isinstance(point, dict) for point in points):
        return []
    hint = "A copy of the last point at a later time"
    found = [StructureEdit(place="[motion]", label="Add a point", hint=hint, apply=_with_point, rows=POINTS)]
    if len(points) > 1:
        found += [_without_offer(place) for place in range(len(points))]
    return found


def _without_offer(place: int) -> StructureEdit:
    name = f"points[{place + 1}]"
    return StructureEdit(
        place="[motion]",
        inside=name,
        label=f"Take out {name}",
        hint="Without this point",
        apply=lambda document: _without_point(document, place),
        rows=POINTS,
    )


def _legs(data: dict[str, Any]) -> list[StructureEdit]:
    leg, count = data.get("leg"), _count(data)
    if isinstance(leg, dict) and count > 1:
        many = _MANY.get(count, str(count))
        hint = f"[[leg]] {many} times, all as this one at first"
        return [_offer("[leg]", f"{many.capitalize()} different legs", hint, _each_leg)]
    if isinstance(leg, list) and len(leg) == count and "+" not in str(data["robot"].get("type")):
        return [
            _offer("[[leg]] 1", "All legs as this one", "[leg] once, as leg 1 is; the others are taken out", _one_leg)
        ]
    return []


def _count(data: dict[str, Any]) -> int:
    """Legs of the robot by its type, such as "3-UPS+UP"; 0 where it has none that says so."""
    groups = [group.strip().partition("-") for group in str(data["robot"].get("type", "6-UPS")).split("+")]
    counts = [first if dash else "1" for first, dash, _ in groups]
    return sum(map(int, counts)) if all(count.isdecimal() for count in counts) else 0


def _tables(data: dict[str, Any]) -> list[StructureEdit]:
    found = []
    for name, start in STARTS.items():
        if name in data:
            label, hint = f"Take out [{name}]", "Without this table"
            found.append(_offer(f"[{name}]", label, hint, lambda d, n=name: d.without_key(n)))
        else:
            hint = "A table that the file leaves out"
            found.append(_offer("", f"Add [{name}]", hint, lambda d, n=name, s=start: _with_table(d, n, s)))
    return found


def _offer(place: str, label: str, hint: str, apply: Callable[[Document], Document]) -> StructureEdit:
    return StructureEdit(place=place, label=label, hint=hint, apply=apply)


def _with_table(document: Document, name: str, values: dict[str, object]) -> Document:
    tree = tomlkit.parse(document.text)
    table = tomlkit.table()
    table.update(values)
    tree[name] = table
    return document.with_text(tree.as_string())


def _with_point(document: Document) -> Document:
    """Document with one more waypoint: the pose of the last, as much later as that is after the one before."""
    expected = tomllib.loads(document.text)
    points = expected["motion"].setdefault("points", [])
    if not points:
        return document.with_value("motion.points", [{"time": "1 s", "roll": "1 deg"}])
    last = {**points[-1], "time": _later(points)}
    points.append(last)
    found = table_spans(document.text, POINTS)
    if found:
        added = ["", f"[[{POINTS}]]", *tomlkit.dumps(last).splitlines()]
        text = replace_lines(document.text, found[-1][1], found[-1][1], added)
    else:
        tree: Any = tomlkit.parse(document.text)
        row = tomlkit.inline_table()
        row.update(last)
        tree["motion"]["points"].append(row)
        text = tree.as_string()
    return document.with_text(check_toml(text, expected, POINTS))


def _without_point(document: Document, place: int) -> Document:
    """Document without one waypoint, the first is 0."""
    expected = tomllib.loads(document.text)
    del expected["motion"]["points"][place]
    found = table_spans(document.text, POINTS)
    if not found:
        text = document.without_key(f"{POINTS}[{place + 1}]").text
    else:
        text = replace_lines(document.text, *found[place], [])
    return document.with_text(check_toml(text, expected, POINTS))


def _later(points: list[dict[str, object]]) -> object:
    """A time as much after the last point's as that is after the one before (or after 0), in its unit."""
    last = quantity(points[-1].get("time"))
    if last is None:
        return "1 s"
    before = quantity(points[-2].get("time")) if len(points) > 1 else None
    step = last.number - before.in_unit(last.unit, "time").number if before is not None else last.number
    return TypedQuantity(last.number + (step if step > 0 else 1.0), last.unit).toml_value()


def _each_leg(document: Document) -> Document:
    """``[[leg]]`` for each leg in place of ``[leg]``; the comments stay with the first."""
    expected = tomllib.loads(document.text)
    expected["leg"] = [expected["leg"]] * _count(expected)
    return document.with_text(check_toml(with_each_leg(document.text), expected, "leg"))


def _one_leg(document: Document) -> Document:
    """``[leg]`` as the first ``[[leg]]`` is; the others go with their comments."""
    expected = tomllib.loads(document.text)
    expected["leg"] = expected["leg"][0]
    text, found = document.text, table_spans(document.text, "leg")
    for first, after in reversed(found[1:]):
        blank = first > 0 and not text.splitlines()[first - 1].strip()
        text = replace_lines(text, first - blank, after, [])
    for first, after in found[:1]:
        text = replace_lines(text, first, after, rename_table(text.splitlines()[first:after], "leg", "[leg]"))
    return document.with_text(check_toml(text, expected, "leg"))


MOST_ROWS = 20  # rows of a list that are shown

_ROW = re.compile(r"(.*?)\[(\d+)\]")


def split_long_lists(fields: Sequence[NotedField]) -> tuple[list[NotedField], dict[str, int]]:
    """Fields but for those of lists with more than `MOST_ROWS` rows, and by key of such a list how many rows it has."""
    rows: dict[str, int] = {}
    for field in fields:
        if found := _ROW.match(field.key):
            rows[found[1]] = max(int(found[2]), rows.get(found[1], 0))
        elif field.kind == "rows" and isinstance(field.value, list):
            rows[field.key] = len(field.value)
    long = {key: count for key, count in rows.items() if count > MOST_ROWS}
    return [field for field in fields if _list_of(field.key) not in long], long


def without_rows(offers: Sequence[StructureEdit], long: dict[str, int]) -> list[StructureEdit]:
    """Edits but for those that add a row to a long list or take one out."""
    return [offer for offer in offers if offer.rows not in long]


def _list_of(key: str) -> str:
    found = _ROW.match(key)
    return found[1] if found else key
