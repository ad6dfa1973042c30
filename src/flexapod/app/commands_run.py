"""`flexapod run` and `flexapod actuator`: simulate, write everything, say the answer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.app.failures import INTERRUPTED, guarded, print_parts, show
from flexapod.app.options import Json, NoFigures, Out, Quiet, StudyFile
from flexapod.app.stopping import stopped

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.model import ActuatorStudy, Study
    from flexapod.study.record import Report
    from flexapod.surveys.convergence.quicker import Quicker

__all__ = ["add"]

COMPUTING = 0.88  # share of the bar for the simulation; the rest is for files
Format = Annotated[
    str, typer.Option("--format", metavar="FORMATS", help="Of the figures: one or more of png,svg,pdf, with commas.")
]
USUAL = "png,svg"


def add(app: typer.Typer) -> None:
    """Give `app` the commands."""
    app.command("run")(run)
    app.command("actuator")(actuator)


@guarded
def run(
    file: StudyFile, out: Out = None, formats: Format = USUAL, no_figures: NoFigures = False, json: Json = False,
    quiet: Quiet = False,
) -> None:  # fmt: skip
    """Simulate a study, rigid and flexible: results.nc, results.csv, figures, report.html."""
    from flexapod.app.outputs import parse_formats, results_folder
    from flexapod.model import load

    drawn = () if no_figures else parse_formats(formats)
    _run(load(file), results_folder(file, "run", out), drawn, json=json, quiet=quiet)


@guarded
def actuator(
    file: StudyFile, out: Out = None, formats: Format = USUAL, no_figures: NoFigures = False, json: Json = False,
    quiet: Quiet = False,
) -> None:  # fmt: skip
    """Simulate the study of a single actuator; writes what `run` writes."""
    from flexapod.app.outputs import parse_formats, results_folder
    from flexapod.errors import InputError
    from flexapod.model import ActuatorStudy, load

    study = load(file)
    if not isinstance(study, ActuatorStudy):
        raise InputError(
            "is the study of a robot",
            file=file,
            allowed="a study with [actuator]",
            next_step=f"Use `flexapod run {file}`",
        )
    drawn = () if no_figures else parse_formats(formats)
    _run(study, results_folder(file, "run", out), drawn, json=json, quiet=quiet)


def _run(study: Study | ActuatorStudy, folder: Path, formats: Sequence[str], *, json: bool, quiet: bool) -> None:
    from flexapod.app.outputs import write_all, write_data
    from flexapod.app.terminal import progress_bar
    from flexapod.study import Interrupted
    from flexapod.study import run as simulate
    from flexapod.study.before.room import check_disk

    check_disk(study, folder)
    interrupted, faster = False, None
    with progress_bar(quiet=quiet or json) as report:
        try:
            data = simulate(study, progress=lambda time, end: report("simulating", COMPUTING * time / end))
        except Interrupted as stop:
            data, interrupted = stop.dataset, True
        try:
            files = write_data(data, folder) if interrupted else write_all(data, folder, report, formats)
            faster = None if interrupted else _quicker(study, data, report)
        except KeyboardInterrupt:  # a second one ends it
            files, interrupted = write_data(data, folder), True
    _say(data, folder, files, faster, json=json)
    if interrupted:
        _stopped(data, json=json)
        raise typer.Exit(INTERRUPTED)
    if data.attrs["partial"]:
        _failed(data, json=json)
        raise typer.Exit(1)


def _quicker(study: Study | ActuatorStudy, data: Dataset, report: Report) -> Quicker | None:
    """A step that would have done, where the tolerance made the run slow; all files are written by now."""
    from flexapod.surveys.convergence.quicker import quicker

    try:
        return quicker(study, data, progress=lambda time, end: report("trying a fixed step", 0.99))
    except KeyboardInterrupt:
        return None


def _say(data: Dataset, folder: Path, files: list[Path], faster: Quicker | None, *, json: bool) -> None:
    from flexapod.app.run_words import show_run
    from flexapod.app.terminal import print_json, print_text
    from flexapod.study.after.summary import summary

    warnings = [line for line in data.attrs["warnings"].splitlines() if line]
    if not json:
        show_run(data, folder, files, warnings)
        if faster is not None:
            print_text(f"Slow? In [simulation], {faster.words}.")
        return
    state = {name: data.attrs[name] for name in ("failure", "time_reached") if name in data.attrs}
    print_json(
        {
            "summary": summary(data).as_dict(),
            "partial": bool(data.attrs["partial"]),
            **state,
            "warnings": warnings,
            "wall_time": data.attrs["wall_time"],
            "steps": int(data.attrs["steps"]),
            "quicker": None if faster is None else asdict(faster),
            "folder": folder,
            "files": files,
        }
    )


def _stopped(data: Dataset, *, json: bool) -> None:
    kept = "what was computed is kept and marked as partial" if data.attrs["partial"] else "the whole result is kept"
    what = f"{stopped()} at t = {float(data.time[-1]):.6g} s; {kept}"
    print_parts({"kind": "interrupt", "what": what}, INTERRUPTED, as_json=json)


def _failed(data: Dataset, *, json: bool) -> None:
    from flexapod.errors import ComputationError

    what = f"the simulation stopped at t = {float(data.time[-1]):.6g} s: {data.attrs['failure']}"
    show(ComputationError(what, next_step="What was computed is kept and marked as partial"), as_json=json)
