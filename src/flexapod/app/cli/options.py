"""Options and arguments that several commands share, what they refuse, and what is written where they say."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.common.errors import InputError
from flexapod.common.files import check_name, temporary_folder
from flexapod.common.lazy_imports import LazyModule

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod import model
    from flexapod.analysis import store
    from flexapod.analysis.results.time_history import Report
    from flexapod.common.tables import toml
    from flexapod.model import ActuatorStudy, Study
    from flexapod.output.report import figures as report_figures
    from flexapod.output.report import report as report_report
    from flexapod.output.text import html
    from flexapod.output.text import verdict as text_verdict
else:
    store = LazyModule("flexapod.analysis.store")
    toml = LazyModule("flexapod.common.tables.toml")
    model = LazyModule("flexapod.model")
    report_figures = LazyModule("flexapod.output.report.figures")
    report_report = LazyModule("flexapod.output.report.report")
    html = LazyModule("flexapod.output.text.html")
    text_verdict = LazyModule("flexapod.output.text.verdict")

StudyFile = Annotated[Path, typer.Argument(metavar="FILE", help="Study file (TOML); `flexapod new` writes one.")]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Another value at a key of the study: leg.piston.diameter=70 mm; once for each key.",
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print JSON on stdout and nothing else; errors as JSON on stderr.")]
Out = Annotated[
    Path | None,
    typer.Option("--out", metavar="DIR", help="Folder for the results; default: beside the study, FILE-COMMAND."),
]
Format = Annotated[
    str, typer.Option("--format", metavar="FORMATS", help="Of the figures: one or more of png,svg,pdf, with commas.")
]
NoFigures = Annotated[bool, typer.Option("--no-figures", help="Draw nothing: data and words only, in less time.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No progress bar.")]

Verbose = Annotated[bool, typer.Option("--verbose", help="Explain each remark, not only say it.")]

Pose = Annotated[
    str | None,
    typer.Option("--pose", metavar='"roll=20deg,heave=10mm"', help="From home; numbers without unit in m and rad."),
]
Strict = Annotated[
    bool,
    typer.Option("--strict", help="Exit code 3 if a requirement of the study is not kept, or not judged."),
]
NOT_KEPT = 3  # exit code of --strict
Force = Annotated[bool, typer.Option("--force", help="Replace the file if it exists.")]
_PARTS = ("what", "file", "value", "allowed", "next_step")


@contextmanager
def as_options(**options: str) -> Iterator[None]:
    """Let errors name a keyword of a Python call as the option that the user typed: ``as_options(modes="--count")``."""
    try:
        yield
    except InputError as error:
        key = options.get(error.key or "", error.key)
        raise InputError(**{name: getattr(error, name) for name in _PARTS}, key=key) from None


def refuse_unrequired(study: Study | ActuatorStudy, *, strict: bool) -> None:
    """Refuse --strict of a study that requires nothing."""
    if strict and getattr(study, "requirement", None) is None:
        raise InputError(
            "has nothing to be strict about: the study has no [requirement]", key="--strict",
            next_step='Add a table [requirement] (`flexapod keys requirement`), or leave --strict out',
        )  # fmt: skip


def exit_strictly(found: Dataset | None, *, strict: bool) -> None:
    """Exit code 3 where it is asked for and a requirement is not kept or not judged."""
    if strict and not text_verdict.all_kept(found):
        raise typer.Exit(NOT_KEPT)


def load_study(file: Path, settings: Sequence[str] | None = None) -> Study | ActuatorStudy:
    """The study of a file, with the values of ``--set KEY=VALUE`` in place of its own."""
    values: dict[str, object] = {}
    for key, value in map(parse_setting, settings or ()):
        if key in values:
            raise InputError("is given twice", key=f"--set {key}", value=value, next_step="Give each key once")
        values[key] = value
    study = model.load(file)
    try:
        return study.with_values(values) if values else study
    except InputError as error:
        raise InputError(**{name: getattr(error, name) for name in _PARTS}, key=f"--set {error.key}") from None


def parse_setting(text: str) -> tuple[str, object]:
    """Key and value of ``KEY=VALUE``: a value of TOML, or else a text, which needs no quotes."""
    key, equals, value = (part.strip() for part in text.partition("="))
    if len(text) > LONGEST_SETTING:
        raise InputError("is too long", key="--set", value=f"{text[:40]}...", allowed=f"{LONGEST_SETTING} letters")
    if not equals or not key or not value:
        raise InputError(
            "is no key with a value",
            key="--set",
            value=text,
            allowed="KEY=VALUE",
            next_step='For example --set "leg.piston.diameter=70 mm"',
        )
    try:
        tables = toml.parse_toml(f"value = {value}", "--set")
    except InputError as error:
        if error.what.startswith("is not valid TOML"):
            return key, value
        raise InputError(error.what, key=f"--set {key}", allowed=error.allowed) from None
    return key, tables["value"] if len(tables) == 1 else value  # lines after the first are no value


def robot_study(file: Path, settings: Sequence[str] | None = None) -> Study:
    """The study of a robot, as `load_study`; refuses that of a single actuator."""
    study = load_study(file, settings)
    if isinstance(study, model.ActuatorStudy):
        raise InputError("is the study of a single actuator", file=file, allowed="the study of a robot")
    return study


def refuse_existing(file: Path, force: bool) -> None:
    """Refuse to replace a file unasked."""
    if file.exists() and not force:
        raise InputError("exists already", file=file, next_step="Choose another name, or replace it with --force")


LONGEST_SETTING = 2000  # letters of a key and its value
FORMATS = ("png", "svg", "pdf")  # of figures
USUAL = "png"
PROCESSES = min(os.cpu_count() or 1, 4)  # that draw them, where there are
MANY = 10_000  # instants: with fewer, a copy of this process costs a third of what it takes off


def parse_formats(text: str, no_figures: bool) -> tuple[str, ...]:
    """Formats of figures, each once, ``"png, PDF"`` gives ``("png", "pdf")``; unknown ones, and none, are refused.

    Without figures there are none.
    """
    if no_figures:
        return ()
    names = tuple(dict.fromkeys(name.strip().lower() for name in text.split(",") if name.strip()))
    unknown = [name for name in names if name not in FORMATS]
    if unknown or not names:
        raise InputError(
            "is not a format of figures",
            key="--format",
            value=unknown[0] if unknown else text,
            allowed=f"{', '.join(FORMATS)}, or several with commas",
            next_step="For example --format png,pdf",
        )
    return names


def results_folder(file: Path, command: str, out: Path | None) -> Path:
    """Folder of the results: `out`, else beside the study file, ``robot-run``; refused if it cannot be written to."""
    folder = file.with_name(f"{file.stem}-{command}") if out is None else out
    check_writable(folder)
    return folder


def check_writable(folder: Path | None, key: str = "--out") -> None:
    """Refuse a folder that could not be made or written to, before anything is computed; it is not made yet."""
    if folder is None:
        return
    check_name(folder.absolute(), key)
    existing = next(place for place in (folder.absolute(), *folder.absolute().parents) if os.path.lexists(place))
    try:
        with temporary_folder(existing):
            pass
    except OSError as error:
        what = (
            f"cannot be made: {existing} is a file" if existing.is_file() else f"cannot be written to: {error.strerror}"
        )
        raise InputError(what, key=key, value=str(folder), next_step=f"Choose another place with {key}") from None


def write_data(data: Dataset, folder: Path) -> list[Path]:
    """``results.nc`` and ``results.csv``, each whole or not at all."""
    return [store.save(data, folder / "results.nc"), store.save_csv(data, folder / "results.csv")]


def write_all(
    data: Dataset, folder: Path, report: Report, formats: Sequence[str], verdict: Dataset | None = None
) -> list[Path]:
    """Data, figures in the formats asked for (none: no figures), ``report.html``; `report` is told what is written.

    ``verdict``: on the requirement of the study, for the report.
    """
    data.load()  # what nobody has asked for yet each copy of this process would make for itself
    figures: list[report_figures.StoredFigure] = []
    processes = PROCESSES if data.sizes["time"] >= MANY else 1
    with (
        report_figures.concurrent_drawing(data, folder, formats, processes)
        if formats
        else nullcontext(list[report_figures.StoredFigure]) as drawn
    ):
        report("writing results", 0.90)
        files = write_data(data, folder)

        def finish_figures() -> list[report_figures.StoredFigure]:
            if formats:
                html.library()  # while others draw
            report("drawing figures", 0.94)
            figures.extend(drawn())
            return figures

        page = report_report.write_report(data, folder, finish_figures, verdict)
    return [*files, *(path for figure in figures for path in figure.files), page]
