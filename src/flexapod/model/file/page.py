"""The page ``docs/study-file.md``: keys in rows, and what the model and the reference say beside them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import astuple
from textwrap import fill

from flexapod.common.tables.csv_tables import POSE, WRENCH, force_columns, header
from flexapod.common.tables.key_rows import HEAD, ListedEntry, list_entries
from flexapod.common.tables.reference import reference
from flexapod.common.units import COMMON_UNITS, DIMENSIONS
from flexapod.model.leg.material import MATERIALS
from flexapod.model.study.disturbance import FLOOR, FORCE_NOISE, WRENCH_NOISE
from flexapod.model.study.mount import BASE_ACCELERATION

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
