"""Commands on study files: `new` writes one, `keys` says what it may contain, `check` describes it as text.

`new --example` also writes the examples of the gallery and the notebooks, which `--list` names. Names of tables
and keys are read without the model: answers about wrong ones come at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from importlib.resources import files
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.app.cli.failures import report_failures
from flexapod.app.cli.options import (
    Force,
    Json,
    Settings,
    Strict,
    StudyFile,
    Verbose,
    as_options,
    exit_strictly,
    load_study,
    refuse_existing,
    refuse_unrequired,
)
from flexapod.common.errors import InputError, closest_word, suggest_word
from flexapod.common.files import check_name, write_text
from flexapod.common.lazy_imports import LazyModule
from flexapod.output.text import parts
from flexapod.output.text.terminal import print_answer

if TYPE_CHECKING:
    from flexapod import model
    from flexapod.analysis import predicted_damping
    from flexapod.analysis.description import robot_description
    from flexapod.common.tables import key_rows, reference
    from flexapod.common.tables.key_rows import ListedEntry
    from flexapod.common.tables.reference import Entry
    from flexapod.design import first_robot
    from flexapod.model.file import json_schema, page
    from flexapod.output.text import answers, description, first_robot_verdict
    from flexapod.output.text import check as text_check
    from flexapod.output.text import verdict as text_verdict
else:
    key_rows = LazyModule("flexapod.common.tables.key_rows")
    robot_description = LazyModule("flexapod.analysis.description.robot_description")
    predicted_damping = LazyModule("flexapod.analysis.predicted_damping")
    first_robot = LazyModule("flexapod.design.first_robot")
    model = LazyModule("flexapod.model")
    json_schema = LazyModule("flexapod.model.file.json_schema")
    page = LazyModule("flexapod.model.file.page")
    answers = LazyModule("flexapod.output.text.answers")
    first_robot_verdict = LazyModule("flexapod.output.text.first_robot_verdict")
    text_check = LazyModule("flexapod.output.text.check")
    description = LazyModule("flexapod.output.text.description")
    text_verdict = LazyModule("flexapod.output.text.verdict")
    reference = LazyModule("flexapod.common.tables.reference")

Name = Annotated[Path | None, typer.Argument(metavar="NAME.toml", help="File to write.")]
Preset = Annotated[
    str | None,
    typer.Option(
        "--preset",
        metavar="P",
        help="paper-robot (the default), paper-robot-radii, paper-actuator, tripod, flight-simulator, "
        "machine-hexapod, small-hexapod, nano-hexapod or motion-base.",
    ),
]
From = Annotated[
    str | None,
    typer.Option(
        "--from",
        metavar='"home=300 mm, payload=20 kg, stroke=60 mm"',
        help="A first robot of catalogue parts that fit: electric cylinders, or drive=hydraulic; also base, platform "
        "(radii), diameter (of pistons), material, motion (surge to yaw), duration. Or what it must do, as of "
        '[requirement]: "travel=15 mm, tilt=3 deg, payload=25 kg, accuracy=1 um"; then home and stroke follow.',
    ),
]
Ideal = Annotated[
    bool,
    typer.Option("--ideal", help="With --from: joints and drives that do not give way, pistons that stretch and bend."),
]


Example = Annotated[
    str | None, typer.Option("--example", metavar="E", help="An example of the gallery, in Python: E.py here.")
]
Notebook = Annotated[
    str | None, typer.Option("--notebook", metavar="N", help="A notebook, as N.py for Jupyter with jupytext.")
]
List = Annotated[bool, typer.Option("--list", help="Name all presets, examples and notebooks.")]


@report_failures
def new(
    name: Name = None, preset: Preset = None, request: From = None, ideal: Ideal = False, example: Example = None,
    notebook: Notebook = None, listed: List = False, force: Force = False, json: Json = False,
) -> None:  # fmt: skip
    """Write a commented study file to edit, or an example in Python; --list names what there is."""
    if listed:
        told = {"NAME": name, "--preset": preset, "--from": request, "--ideal": ideal, "--example": example}
        told |= {"--notebook": notebook, "--force": force}
        for option, value in told.items():
            if value:
                raise InputError("is given together with --list", key=option, value=value, allowed="one of the two")
        return _list(json=json)
    given = {"--preset": preset, "--from": request, "--example": example, "--notebook": notebook}
    chosen = [option for option in ("--example", "--notebook") if given[option] is not None]
    if chosen:
        others = [option for option in given if given[option] is not None and option != chosen[0]]
        others += ["--ideal"] if ideal else []
        if others:
            raise InputError(f"is given together with {others[0]}", key=chosen[0], allowed="one of the two")
        return _example(chosen[0], given[chosen[0]] or "", name, force=force, json=json)
    if name is None:
        raise InputError("is missing", key="NAME.toml", next_step="Give the name of the file to write: robot.toml")
    check_name(name)
    path = name if name.suffix or name.is_dir() else name.with_suffix(".toml")
    if path.is_dir():
        raise InputError("is a folder", file=path, next_step="Give the name of a file")
    refuse_existing(path, force)
    if ideal and request is None:
        raise InputError("is given without --from", key="--ideal", next_step='Add --from "home=300 mm, payload=20 kg"')
    if request is None:
        text, source, remarks = _preset(preset or "paper-robot")
    else:
        text, source, remarks = _first_robot(request, preset, ideal=ideal)
    write_text(path, text)
    words = f", from the preset {source['preset']}" if "preset" in source else ""
    data = {"file": path, **source, **({} if request is None else {"remarks": remarks})}
    print_answer([*remarks, f"{path} written{words}. Edit it, then: flexapod check {path}"], lambda: data, json=json)


def _list(*, json: bool) -> None:
    found = {
        "--preset": dict.fromkeys(model.PRESETS, ""),
        **{option: titles(option) for option in ("--example", "--notebook")},
    }
    items = [f"{option} {name}".ljust(40) + title for option, names in found.items() for name, title in names.items()]
    print_answer(items, lambda: {option.strip("-"): names for option, names in found.items()}, json=json)


def _example(option: str, wanted: str, name: Path | None, *, force: bool, json: bool) -> None:
    written, path = text(option, wanted), example_path(option, wanted, name)
    refuse_existing(path, force)
    write_text(path, written)
    run = f"python {path}" if option == "--example" else f"jupytext --to ipynb {path}, or open it in Jupyter"
    print_answer([f"{path} written. Run it: {run}"], lambda: {"file": path, option.strip("-"): wanted}, json=json)


def _preset(name: str) -> tuple[str, dict[str, object], list[str]]:
    with as_options(preset="--preset"):
        return model.preset_text(name), {"preset": name}, []


def _first_robot(request: str, preset: str | None, *, ideal: bool) -> tuple[str, dict[str, object], list[str]]:
    """Text of a first robot, what it is from, and what there is to say about it."""
    if preset is not None:
        raise InputError("is given together with --from", key="--preset", value=preset, allowed="one of the two")
    wanted = first_robot.parse_request(request)
    if ideal and wanted.texts.get("drive", first_robot.IDEAL) != first_robot.IDEAL:
        raise InputError(
            "is given together with --from drive", key="--ideal", value=wanted.drive, allowed="one of the two"
        )
    wanted = replace(wanted, drive=first_robot.IDEAL) if ideal else wanted
    text = first_robot.first_robot(wanted)
    data, best = first_robot.attainable(wanted, text)
    source = {"from": request, **({} if data is None else {"attainable": first_robot_verdict.attained_as_dict(best)})}
    return text, source, [*answers.first_robot_sentences(text), *first_robot_verdict.attained_sentences(data, best)]


Table = Annotated[str | None, typer.Argument(metavar="[TABLE]", help="Only this table and those in it: leg.drive")]
Markdown = Annotated[Path | None, typer.Option("--markdown", metavar="FILE", help="Write the whole page as Markdown.")]

Schema = Annotated[
    Path | None, typer.Option("--schema", metavar="FILE", help="Write a JSON schema of study files, for editors.")
]


@report_failures
def keys(table: Table = None, markdown: Markdown = None, schema: Schema = None, json: Json = False) -> None:
    """Show every key of a study file: what it is, unit, what it is if left out, what is allowed, an example."""
    from dataclasses import asdict

    if table is not None:
        check_table(table)
    files = [str(path) for path in (markdown, schema) if path is not None]
    if table is not None and files:
        words = "is given together with a file, which has all tables"
        raise InputError(words, key="TABLE", value=table, allowed="one of the two")
    if len(set(files)) < len(files):
        raise InputError("is that of --markdown, too", key="--schema", value=files[0], allowed="another file")
    if markdown is not None:
        write_text(markdown, page.study_file_page())
    if schema is not None:
        write_text(schema, json_schema.json_schema())
    found = key_rows.list_entries(table)
    written = [f"{' and '.join(files)} written."] if files else None
    told = (_key_chapter(item, key_rows.HEAD, alone=table is not None) for item in found)
    print_answer(written or told, lambda: [asdict(item) for item in found], json=json)


def _key_chapter(found: ListedEntry, head: Sequence[str], *, alone: bool) -> parts.Chapter:
    """A table of a study file: its words, its keys, an example."""
    entry = found.entry
    title = f"[{entry.table}] {entry.title}".rstrip() + ("" if alone else f" ({entry.study})")
    rows = [[row.key, row.what, row.unit, row.default, row.allowed] for row in found.rows]
    keys = [parts.TextTable(head, rows, left=range(len(head)))] if rows else []
    keys += [parts.Text(found.further)] if found.further else []
    return parts.Chapter(
        title, [parts.Text(entry.words), *keys, "", parts.Lines(entry.example.strip()), ""], close=True
    )


@report_failures
def check(
    file: StudyFile, settings: Settings = None, strict: Strict = False, verbose: Verbose = False, json: Json = False
) -> None:
    """Validate a study and say in words what it asks of its legs: lengths, strokes, loads, stiffness, frequencies."""
    refuse_unrequired(study := load_study(file, settings), strict=strict)
    verdict = text_verdict.study_verdict(study)
    found, control = robot_description.describe(study), ()
    if isinstance(study, model.Study) and study.control is not None:
        control = description.control_words(predicted_damping.control_effect(study))
    data = lambda: description.description_as_dict(found) | ({"control": control} if control else {})  # noqa: E731
    items = chain(text_verdict.verdict_items(verdict), text_check.check_items(found, control))
    print_answer(items, lambda: data() | text_verdict.verdict_as_dict(verdict), json=json, verbose=verbose)
    exit_strictly(verdict, strict=strict)


_FOLDERS = {"--example": "examples/gallery", "--notebook": "examples/notebooks"}


def titles(option: str) -> dict[str, str]:
    """Title of each example, or of each notebook, by name."""
    found = {x.name.removesuffix(".py"): x for x in files("flexapod").joinpath(_FOLDERS[option]).iterdir()}
    return {name: _title(x.read_text(encoding="utf-8")) for name, x in sorted(found.items()) if x.name.endswith(".py")}


def text(option: str, name: str) -> str:
    """The file of an example.

    Raises
    ------
    InputError
        A name that is not known.
    """
    known = titles(option)
    if name not in known:
        next_step = suggest_word(name, known) or "flexapod new --list names them"
        raise InputError("is not known", key=option, value=name, allowed=", ".join(known), next_step=next_step)
    return files("flexapod").joinpath(_FOLDERS[option], f"{name}.py").read_text(encoding="utf-8")


def example_path(option: str, name: str, given: Path | None) -> Path:
    """Path at which an example is written: NAME.py here, unless another place is given."""
    if given is not None and (given.is_dir() or given.suffix not in ("", ".py")):
        words = "is a folder" if given.is_dir() else "is no name of a Python file"
        raise InputError(words, file=given, allowed="FILE.py", next_step=f"{option} {name} alone writes {name}.py")
    return (given or Path(name)).with_suffix(".py")


def _title(written: str) -> str:
    """The first line of words: of an example its heading, of a notebook that of its first cell."""
    lines = (line for line in written.splitlines() if not line.startswith(("# %%", "# ---", "# jupyter:", "#   ")))
    words = (line.removeprefix('r"""').strip('"# ') for line in lines)
    return next(line for line in words if line)


MOST = 3  # names that are suggested


def check_table(wanted: str) -> None:
    """Refuse what is not a table of a study file, nor above one.

    Raises
    ------
    InputError
        With the table that is meant: of that last name, with a key of that name, or of a similar name.
    """
    entries = reference.reference().entries
    tables = list(dict.fromkeys(entry.table for entry in entries))
    if any(f"{table}.".startswith(f"{wanted}.") for table in tables):
        return
    raise InputError(
        "is not a table of a study file",
        key="TABLE",
        value=wanted,
        allowed=f"{', '.join(dict.fromkeys(table.split('.')[0] for table in tables))}, or a table in one of them",
        next_step=_meant(wanted, tables, entries),
    )


def _meant(wanted: str, tables: list[str], entries: tuple[Entry, ...]) -> str:
    table, _, last = wanted.rpartition(".")
    ends = [name for name in tables if name.rpartition(".")[2] == last]
    if ends:
        return f"Did you mean {' or '.join(map(repr, ends[:MOST]))}?"
    named = [name for name in tables if table in (name, "")]
    holders = [name for name in named if any(last in entry.data for entry in entries if entry.table == name)]
    if holders:
        which = " or ".join(f"`flexapod keys {name}`" for name in holders[:MOST])
        return f"{last} is a key of a table: {which}"
    lasts = {name.rpartition(".")[2]: name for name in reversed(tables)}
    keys = {f"{entry.table}.{key}": entry.table for entry in entries for key in entry.data}
    keys = {name: table for name, table in keys.items() if name not in tables}
    close = closest_word(wanted, [*tables, *keys])
    if close in keys:
        return f"Did you mean the key {close}? `flexapod keys {keys[close]}`"
    close = close or lasts.get(closest_word(last, lasts) or "")
    return f"Did you mean {close!r}?" if close else "`flexapod keys` lists all tables with their keys"
