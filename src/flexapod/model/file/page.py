"""Keys of a study file in rows, and the page ``docs/study-file.md``: from the readers, the model and its examples."""

from __future__ import annotations

import tempfile
import tomllib
from collections.abc import Iterator
from dataclasses import astuple, dataclass
from pathlib import Path
from textwrap import fill
from typing import Any

import numpy as np

from flexapod.common.tables.columns import Column
from flexapod.common.tables.csv_tables import POSE, WRENCH, force_columns, header
from flexapod.common.tables.reference import Entry, plain_path, reference
from flexapod.common.units import COMMON_UNITS, DIMENSIONS
from flexapod.model.file.fields import NotedField, Notes, read_notes
from flexapod.model.leg.material import MATERIALS
from flexapod.model.study.disturbance import FLOOR, FORCE_NOISE, WRENCH_NOISE
from flexapod.model.study.mount import BASE_ACCELERATION

HEAD = ("Key", "What it is", "Unit", "Default", "Allowed")
_NEEDED = {"robot": ("robot", "payload", "leg", "motion"), "actuator": ("actuator", "simulation")}
_EXTENDED = ("robot", "leg", "actuator")  # an example of a part of these leaves the rest as it is (see _whole)
_TABLES = {
    '`[motion]` with `type = "csv"`': (POSE, "one at least besides the time; others are 0"),
    '`load.wrench` with `law = "csv"`, of a robot': (
        WRENCH,
        "one at least besides the time; others are 0",
    ),
    "`robot.base_motion`": (BASE_ACCELERATION, "one at least besides the time; others are 0"),
    '`robot.base_motion` with `of = "displacement"`': (POSE, "one at least besides the time; others are 0"),
    '`leg.drive` with `law = "csv"`': (force_columns(6), "all columns, one for each leg"),
    '`leg.drive` of a screw with `law = "csv"`': (force_columns(6, "torque"), "all columns, one for each leg"),
    "`heat.file`": (
        {"piston": "temperature", "cylinder 3": "temperature"},
        "one at least besides the time: base, platform, piston, cylinder, screw, or one of the last three of a leg",
    ),
    "`disturbance.floor.spectrum`": (FLOOR["acceleration"], "one at least besides the frequency; others are 0"),
    "`disturbance.wrench.spectrum`": (WRENCH_NOISE, "one at least besides the frequency; others are 0"),
    "`disturbance.force_noise.spectrum`": (FORCE_NOISE, "or one for each leg: leg 1, leg 2; others are 0"),
    "`motion.rotation`": ({"value": "angle"}, "both columns"),
    "`motion.extension`": ({"value": "length"}, "both columns"),
    "`load.torque`": ({"value": "torque"}, "both columns"),
    "`load.force`": ({"value": "force"}, "both columns"),
}


@dataclass(frozen=True)
class PageRow:
    """A key in words."""

    key: str
    what: str
    unit: str
    default: str
    allowed: str


@dataclass(frozen=True)
class ListedEntry:
    """An entry with its rows; `besides`: its keys that an entry of the same table before it has listed already."""

    entry: Entry
    rows: tuple[PageRow, ...]
    besides: tuple[str, ...]

    @property
    def further(self) -> str:
        """Words for its keys that are listed above; nothing where there are none or it has no others."""
        return (
            f"Further keys, as above: {', '.join(f'`{key}`' for key in self.besides)}."
            if self.besides and self.rows
            else ""
        )


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


def list_entries(table: str | None = None) -> list[ListedEntry]:
    """All entries with their rows, or those of a table and of tables in it.

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
        chosen = (x for x in reference().entries if table is None or f"{x.table}.".startswith(f"{table}."))
        for entry in chosen:
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


def study_file_page() -> str:
    """The page ``docs/study-file.md``."""
    parts = [_INTRODUCTION, *_dimensions()]
    for study, title in (("robot", "## A robot"), ("actuator", "## A single actuator")):
        parts.append(title)
        for item in list_entries():
            if item.entry.study == study:
                parts += entry_text(item)
    parts += ["## What the choices mean", *_choices(), "## Tables over time", *_tables()]
    return "\n\n".join(_wrapped(part) for part in parts) + "\n"


def entry_text(item: ListedEntry) -> Iterator[str]:
    """Heading, words, rows and example of an entry, in Markdown."""
    entry = item.entry
    path = f"[{entry.table}]" if "." not in entry.table else entry.table
    yield f"{'###' if path[0] == '[' else '####'} `{path}`" + (f", {entry.title}" if entry.title else "")
    if entry.words:
        yield entry.words
    if item.rows:
        yield _table(HEAD, [(f"`{row.key}`", *astuple(row)[1:]) for row in item.rows])
    if item.further:
        yield item.further
    yield f"```toml\n{entry.example.strip()}\n```"


def _wrapped(part: str) -> str:
    """A paragraph in lines of at most 110 letters; headings, tables and code as they are."""
    return part if part.startswith(("#", "|", "```")) else fill(part, 110, break_on_hyphens=False)


def _dimensions() -> Iterator[str]:
    yield "## Numbers and units"
    yield (
        'A number without a unit is in SI; text carries its unit: `"27 mm"`, `"200 GPa"`, `"20 deg"`. Other units than '
        "those named here are read as well. The last column has the least and the largest size that is accepted; the "
        "least one applies to numbers that must be above 0."
    )
    rows = [
        (name, d.unit or "", f"`{d.example}`" if not d.unit else f'`"{d.example}"`',
         ", ".join(unit for unit in COMMON_UNITS.get(name, {}) if unit != d.unit), f"{d.least:g} to {d.most:g}")
        for name, d in DIMENSIONS.items()
    ]  # fmt: skip
    yield _table(("Quantity", "SI unit", "Example", "Also", "Size"), rows)


def _choices() -> Iterator[str]:
    for name, choices in reference().choices.items():
        yield f"`{name}`:"
        yield _table((name, "what it is"), [(f"`{key}`", words) for key, words in choices.items()])
    yield "`material`:"
    rows = [
        (
            f"`{name}`",
            f"{m.E / 1e9:g}",
            f"{m.density:g}",
            "" if m.yield_stress is None else f"{m.yield_stress / 1e6:g}",
            f"{m.poisson:g}",
            "" if m.expansion is None else f"{m.expansion * 1e6:g}",
        )
        for name, m in MATERIALS.items()
    ]
    head = ("material", "E [GPa]", "density [kg/m^3]", "yield_stress [MPa]", "poisson", "expansion [1e-6/K]")
    yield _table(head, rows)


def _tables() -> Iterator[str]:
    yield (
        "The path of a CSV file is relative to the study file. The first line names each column with its "
        "unit; any unit of the right kind will do. The first instant is 0, the others increase. Lines that "
        "begin with # are comments. Between its instants a motion is a quintic spline that rests at both "
        "ends; accelerations, loads and forces are linear, the last two held at the end."
    )
    yield _table(
        ("Read by", "First line", "Columns"),
        [
            (where, f"`{header(columns, 'frequency' if 'spectrum' in where else 'time')}`", needed)
            for where, (columns, needed) in _TABLES.items()
        ],
    )
    yield f"```csv\n{reference().files['path.csv'].strip()}\n```"


def _table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    lines = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)


_INTRODUCTION = """# The study file

A study is one TOML file: what is analysed, how it moves, how it is computed. `flexapod new NAME.toml`
writes one to start from, `flexapod check NAME.toml` reads and describes it. Keys that are not named here are
refused, with the right form.

`flexapod keys --schema study.schema.json` writes the same for editors: with `#:schema study.schema.json` as its first
line a file is completed and marked as you type, by those that know JSON schemas for TOML.

This page is written by `flexapod keys --markdown docs/study-file.md` from the readers, the model and
`src/flexapod/common/tables/keys.toml`; `flexapod keys leg.drive` shows a part of it in the terminal. All examples
load."""
