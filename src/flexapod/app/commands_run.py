"""Commands that simulate: `run` and `actuator`; `cache` of the kernels that they compile."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.app import terminal
from flexapod.app.failures import INTERRUPTED, guarded, print_parts, show, stopped
from flexapod.app.options import (
    FORMATS,
    Json,
    NoFigures,
    Out,
    Quiet,
    StudyFile,
    Verbose,
    parse_formats,
    results_folder,
    write_all,
    write_data,
)
from flexapod.app.terminal import print_json, print_remarks, print_table, print_text
from flexapod.errors import ComputationError, InputError
from flexapod.loading import without

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.model import ActuatorStudy, Study
    from flexapod.study.after.summary import RobotSummary
    from flexapod.symbolic.cache import CacheContent

COMPUTING = 0.88  # share of the bar for the simulation; the rest is for files
Format = Annotated[
    str, typer.Option("--format", metavar="FORMATS", help="Of the figures: one or more of png,svg,pdf, with commas.")
]
USUAL = "png,svg"


@guarded
def run(
    file: StudyFile, out: Out = None, formats: Format = USUAL, no_figures: NoFigures = False, json: Json = False,
    quiet: Quiet = False, verbose: Verbose = False,
) -> None:  # fmt: skip
    """Simulate a study, rigid and flexible: results.nc, results.csv, figures, report.html."""
    from flexapod.model import load

    drawn = () if no_figures else parse_formats(formats)
    _run(load(file), results_folder(file, "run", out), drawn, json=json, quiet=quiet, verbose=verbose)


@guarded
def actuator(
    file: StudyFile, out: Out = None, formats: Format = USUAL, no_figures: NoFigures = False, json: Json = False,
    quiet: Quiet = False, verbose: Verbose = False,
) -> None:  # fmt: skip
    """Simulate the study of a single actuator; writes what `run` writes."""
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
    _run(study, results_folder(file, "run", out), drawn, json=json, quiet=quiet, verbose=verbose)


def _run(
    study: Study | ActuatorStudy, folder: Path, formats: Sequence[str], *, json: bool, quiet: bool, verbose: bool
) -> None:
    from flexapod.study import Interrupted
    from flexapod.study import run as simulate
    from flexapod.study.before.room import check_disk

    check_disk(study, folder)
    interrupted = False
    with without("dask"), without("pint"), terminal.progress_bar(quiet=quiet or json) as report:
        try:
            data = simulate(study, progress=lambda time, end: report("simulating", COMPUTING * time / end))
        except Interrupted as stop:
            data, interrupted = stop.dataset, True
        try:
            files = write_data(data, folder) if interrupted else write_all(data, folder, report, formats)
        except KeyboardInterrupt:  # a second one ends it
            files, interrupted = write_data(data, folder), True
    _say(study, data, folder, files, json=json, verbose=verbose)
    if interrupted:
        _stopped(data, json=json)
        raise typer.Exit(INTERRUPTED)
    if data.attrs["partial"]:
        _failed(data, json=json)
        raise typer.Exit(1)


def _say(
    study: Study | ActuatorStudy, data: Dataset, folder: Path, files: list[Path], *, json: bool, verbose: bool
) -> None:
    from flexapod.model import Study
    from flexapod.study.after.summary import summary
    from flexapod.study.counted import run_counts
    from flexapod.study.ideal import ideal_words

    warnings = [line for line in data.attrs["warnings"].splitlines() if line]
    ideal, counts = (say(study.robot) if isinstance(study, Study) else None for say in (ideal_words, run_counts))
    if not json:
        show_run(data, folder, files, warnings, (ideal, counts), verbose=verbose)
        return
    state = {name: data.attrs[name] for name in ("failure", "time_reached") if name in data.attrs}
    print_json(
        {
            "summary": summary(data).as_dict(),
            "partial": bool(data.attrs["partial"]),
            **state,
            "ideal": ideal,
            "counts": counts,
            "warnings": warnings,
            "wall_time": data.attrs["wall_time"],
            "steps": int(data.attrs["steps"]),
            "folder": folder,
            "files": files,
        }
    )


def _stopped(data: Dataset, *, json: bool) -> None:
    kept = "what was computed is kept and marked as partial" if data.attrs["partial"] else "the whole result is kept"
    what = f"{stopped()} at t = {float(data.time[-1]):.6g} s; {kept}"
    print_parts({"kind": "interrupt", "what": what}, INTERRUPTED, as_json=json)


def _failed(data: Dataset, *, json: bool) -> None:
    what = f"the simulation stopped at t = {float(data.time[-1]):.6g} s: {data.attrs['failure']}"
    show(ComputationError(what, next_step="What was computed is kept and marked as partial"), as_json=json)


def show_run(
    data: Dataset, folder: Path, files: Sequence[Path], warnings: Sequence[str], also: Sequence[str | None] = (), *,
    verbose: bool = False,
) -> None:  # fmt: skip
    """Print what a run found, sentences that are told `also`, and where it is."""
    from flexapod.study.after.summary import POINT_WORDS, RobotSummary, summaries
    from flexapod.study.bodies import bodies_words

    told = summaries(data)
    for sentence in (*(found.sentence for found in told), *bodies_words(data)):
        print_text(sentence)
    for found in told:
        if isinstance(found, RobotSummary):
            print_text()
            _axes(found, POINT_WORDS[found.point])
    for sentence in filter(None, also):
        print_text(sentence)
    print_remarks(warnings, verbose=verbose, title="Warning: ")
    print_text()
    formats = list(dict.fromkeys(path.suffix for path in files if path.suffix[1:] in FORMATS))
    names = ", ".join(path.name for path in files if path.suffix not in formats)
    names = names.replace("report.html", "report.html (open it in a browser)")
    figures = sum(path.suffix in formats for path in files) // max(len(formats), 1)
    kinds = " and ".join(suffix[1:].upper() for suffix in formats)
    drawn = f", {figures} figure{'s' * (figures > 1)} ({kinds})" if figures else ""
    seconds = f"{data.attrs['steps']} steps, {data.attrs['wall_time']:.2g} s"
    print_text(f"In {folder}: {names}{drawn}. ({seconds} of time integration)")


def _axes(found: RobotSummary, name: str) -> None:
    from flexapod.study.words import column, number

    axes = found.shown_axes
    length, peaks_and_rms = column([*(a.peak for a in axes), *(a.rms for a in axes)], "m")
    count = len(axes)
    travel_unit, travels = column([a.excursion for a in axes], "m")
    rows = zip(
        (a.axis for a in axes),
        peaks_and_rms[:count],
        ("n/a" if a.time is None else f"{a.time:.3f}" for a in axes),
        peaks_and_rms[count:],
        travels,
        ("n/a" if a.per_cent is None else number(a.per_cent, 2) for a in axes),
        strict=True,
    )
    head = [name, f"peak [{length}]", "at [s]", f"rms [{length}]", f"rigid travel [{travel_unit}]", "peak / travel [%]"]
    print_table(head, [list(row) for row in rows])


Clear = Annotated[bool, typer.Option("--clear", help="Remove all kernels; each is compiled again when needed.")]


@guarded
def cache(clear: Clear = False, json: Json = False) -> None:
    """Where compiled kernels are kept, how many there are, and how to remove them.

    FLEXAPOD_CACHE chooses another folder, FLEXAPOD_CACHE_MEGABYTES another bound.
    """
    from flexapod.symbolic.cache import cache_content, clear_cache

    found = clear_cache() if clear else cache_content()
    if json:
        print_json(_as_dict(found, cleared=clear))
    elif clear:
        print_text(f"Removed {_kernels(found)} ({_megabytes(found.size)}) from {found.folder}.")
    else:
        print_text(f"Folder: {found.folder}")
        print_text(f"{_kernels(found)}, {_megabytes(found.size)} of at most {_megabytes(found.limit)}")
        if found.unused_because:
            print_text(f"Not used: {found.unused_because}. Each run compiles its own kernels.")


def _as_dict(found: CacheContent, *, cleared: bool) -> dict[str, object]:
    if cleared:
        return {"folder": found.folder, "removed": found.kernels, "bytes": found.size}
    return {
        "folder": found.folder,
        "kernels": found.kernels,
        "bytes": found.size,
        "limit_bytes": found.limit,
        "unused_because": found.unused_because,
    }


def _kernels(found: CacheContent) -> str:
    return "1 compiled kernel" if found.kernels == 1 else f"{found.kernels} compiled kernels"


def _megabytes(size: int) -> str:
    return f"{size / 1e6:.4g} MB"
