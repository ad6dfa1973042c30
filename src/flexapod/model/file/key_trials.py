"""Keys of a study file by trial: what the readers ask of every example, and take where one of its keys is left out.

`python -m flexapod.model.file.key_trials` writes what it finds into ``common/tables/key_rows.json``, from where
`flexapod keys` and the page ``docs/study-file.md`` have it: a thousand trials take two seconds.
"""

from __future__ import annotations

import tempfile
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from flexapod.common.files import write_text
from flexapod.common.tables import key_rows
from flexapod.common.tables.columns import Column
from flexapod.common.tables.key_rows import ListedEntry, PageRow
from flexapod.common.tables.reference import Entry, plain_path, reference
from flexapod.common.units import DIMENSIONS
from flexapod.model.file.fields import NotedField, Notes, read_notes

_NEEDED = {"robot": ("robot", "payload", "leg", "motion"), "actuator": ("actuator", "simulation")}
_EXTENDED = ("robot", "leg", "actuator")  # an example of a part of these leaves the rest as it is (see _whole)


def study_data(entry: Entry) -> dict[str, Any]:
    """A whole study with the entry's example in it, as tables."""
    data: dict[str, Any] = {}
    for name in _NEEDED[entry.study]:
        first = next(e for e in reference().entries if e.study == entry.study and e.table == name)
        data |= tomllib.loads(first.example)
    example = tomllib.loads(entry.example)
    for name, table in example.items():
        part = name in _EXTENDED and isinstance(table, dict) and not _whole(table)
        data[name] = {**data[name], **table} if part else table
    if data.get("robot", {}).get("platform", {}).get("fixed"):
        del data["payload"], data["motion"]
    return data


def _whole(table: dict[str, Any]) -> bool:
    """Tell whether an example of a table stands for itself: another geometry, a leg of other bodies, another beam."""
    return ("base" in table and "type" in table) or "strut" in table or "length" in table


def tried_entries() -> list[ListedEntry]:
    """All entries with their rows, from trial studies.

    Raises
    ------
    ValueError
        A key without words, or an example that cannot be read.
    """
    seen: dict[tuple[str, str], set[PageRow]] = {}
    found = []
    with tempfile.TemporaryDirectory() as name:
        for file, text in reference().files.items():
            (Path(name) / file).write_text(text, encoding="utf-8")
        for entry in reference().entries:
            rows = list(_rows(entry, Path(name)))
            before = seen.setdefault((entry.study, entry.table), set())
            new = tuple(row for row in rows if row not in before)
            found.append(ListedEntry(entry, new, tuple(row.key for row in rows if row in before)))
            before.update(rows)
    return found


def _rows(entry: Entry, folder: Path) -> Iterator[PageRow]:
    data = study_data(entry)
    notes, error = read_notes(data, folder)
    if error is not None:
        raise ValueError(f"the example of {entry.table} {entry.title!r} in keys.toml is refused: {error}")
    fields = {f.name: f for f in notes.fields.values() if plain_path(f.table) == entry.table}
    words = words_of(notes, entry.table)
    for name in sorted({*fields, *entry.data} - set(words)):
        raise ValueError(f"{entry.table}.{name} has no words: add them to the field of its class, as Key or Quantity")
    for name in (name for name in words if name in fields or name in entry.data):
        field = fields.get(name)
        yield PageRow(
            key=name,
            what=words[name].removeprefix("table: "),
            unit=_unit(words[name], field),
            default=_default(entry, name, data, folder, notes),
            allowed="" if field is None else ", ".join(field.choices or ()) or field.bounds.words,
        )


def words_of(notes: Notes, table: str) -> dict[str, str]:
    """Words for the keys of a table: of the classes that it fills, and of keys that are no fields."""
    columns = _columns(notes, table)
    return {name: column.why for name, column in columns.items() if column.why} | dict(reference().words.get(table, {}))


def _columns(notes: Notes, table: str) -> dict[str, Column]:
    return {name: x for path, found in notes.columns.items() if plain_path(path) == table for name, x in found.items()}


def _unit(words: str, field: NotedField | None) -> str:
    if field is None or words.startswith(("table", "list")):
        return "tables" if words.startswith("list") else "table"
    if field.kind in ("text", "whole"):
        return {"text": "text", "whole": "whole number"}[field.kind]
    units = [DIMENSIONS[dimension].unit or "number" for dimension in field.dimensions]
    together = units[0] if len(set(units)) == 1 else ", ".join(units)
    many = {"vector": f"{len(units)} x ", "rows": f"rows of {len(units)} x "}.get(field.kind, "")
    return (many + together) if len(set(units)) == 1 else together


def _default(entry: Entry, name: str, data: dict[str, Any], folder: Path, notes: Notes) -> str:
    key = f"{entry.table}.{name}"
    error = None
    if name in entry.data:
        less, error = read_notes(_without(data, entry.table.split("."), name), folder)
        if error is not None and error.what == "is missing":
            return "required"
        notes = notes if error is not None else less
    column = _columns(notes, entry.table).get(name)
    if words := reference().defaults.get(key) or (column.usual if column else ""):
        return words
    found = [f for f in notes.fields.values() if plain_path(f.key) == key]
    if error is not None:  # refused without it for another reason: what the model takes, if anything
        return "required" if not found or found[0].default is None else _text(found[0].default)
    return _text(found[0].taken) if found else "none"


def _without(data: Any, path: list[str], name: str) -> Any:
    """A copy of tables without the key at a path, in every table of a list."""
    if isinstance(data, list):
        return [_without(item, path, name) for item in data]
    if not path:
        return {key: value for key, value in data.items() if key != name}
    return {key: _without(value, path[1:], name) if key == path[0] else value for key, value in data.items()}


def _text(value: object) -> str:
    if isinstance(value, np.ndarray | tuple | list):
        return "[" + ", ".join(_text(item) for item in value) + "]"
    return "none" if value is None else f"{value:g}" if isinstance(value, float) else str(value)


if __name__ == "__main__":
    write_text(Path(key_rows.__file__).with_suffix(".json"), key_rows.stored_text(tried_entries()))
