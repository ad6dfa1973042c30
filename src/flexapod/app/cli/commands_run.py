"""Commands that simulate: `run` and `actuator`; `cache` of the kernels that they compile."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.app.cli.failures import INTERRUPTED, print_error, print_parts, report_failures, stop_words
from flexapod.app.cli.options import (
    FORMATS,
    USUAL,
    Format,
    Json,
    NoFigures,
    Out,
    Quiet,
    Settings,
    Strict,
    StudyFile,
    Verbose,
    exit_strictly,
    load_study,
    parse_formats,
    refuse_unrequired,
    results_folder,
    write_all,
    write_data,
)
from flexapod.common.errors import ComputationError, InputError
from flexapod.common.lazy_imports import LazyModule, hide_package
from flexapod.output.text import terminal

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod import analysis, model
    from flexapod.analysis.checks import resource_limits
    from flexapod.analysis.requirements import record
    from flexapod.mechanics.symbolic import cache as symbolic_cache
    from flexapod.mechanics.symbolic.cache import CacheContent
    from flexapod.model import ActuatorStudy, Study
    from flexapod.output.text import answers
    from flexapod.output.text import verdict as text_verdict
else:
    analysis = LazyModule("flexapod.analysis")
    resource_limits = LazyModule("flexapod.analysis.checks.resource_limits")
    record = LazyModule("flexapod.analysis.requirements.record")
    symbolic_cache = LazyModule("flexapod.mechanics.symbolic.cache")
    model = LazyModule("flexapod.model")
    answers = LazyModule("flexapod.output.text.answers")
    text_verdict = LazyModule("flexapod.output.text.verdict")

COMPUTING = 0.88  # share of the bar for the simulation; the rest is for files


@report_failures
def run(
    file: StudyFile, settings: Settings = None, out: Out = None, formats: Format = USUAL,
    no_figures: NoFigures = False, strict: Strict = False, json: Json = False, quiet: Quiet = False,
    verbose: Verbose = False,
) -> None:  # fmt: skip
    """Simulate a study, rigid and flexible: results.nc, results.csv, figures, report.html."""
    drawn = parse_formats(formats, no_figures)
    refuse_unrequired(study := load_study(file, settings), strict=strict)
    found = _run(study, results_folder(file, "run", out), drawn, json=json, quiet=quiet, verbose=verbose)
    exit_strictly(found, strict=strict)


@report_failures
def actuator(
    file: StudyFile, settings: Settings = None, out: Out = None, formats: Format = USUAL,
    no_figures: NoFigures = False, json: Json = False, quiet: Quiet = False, verbose: Verbose = False,
) -> None:  # fmt: skip
    """Simulate the study of a single actuator; writes what `run` writes."""
    study = load_study(file, settings)
    if not isinstance(study, model.ActuatorStudy):
        raise InputError(
            "is the study of a robot",
            file=file,
            allowed="a study with [actuator]",
            next_step=f"Use `flexapod run {file}`",
        )
    drawn = parse_formats(formats, no_figures)
    _run(study, results_folder(file, "run", out), drawn, json=json, quiet=quiet, verbose=verbose)


def _run(
    study: Study | ActuatorStudy, folder: Path, formats: Sequence[str], *, json: bool, quiet: bool, verbose: bool
) -> Dataset | None:
    """Simulate, write and say; the verdict on the requirement of the study, if it has one."""
    resource_limits.check_disk(study, folder)
    verdict, interrupted = text_verdict.study_verdict(study), False
    with hide_package("dask"), hide_package("pint"), terminal.progress_bar(quiet=quiet or json) as report:
        try:
            data = analysis.run(study, progress=lambda time, end: report("simulating", COMPUTING * time / end))
        except analysis.Interrupted as stop:
            data, interrupted = stop.dataset, True
        if verdict is not None:
            verdict = record.with_record(verdict, study, data)  # type: ignore[arg-type]
        try:
            files = write_data(data, folder) if interrupted else write_all(data, folder, report, formats, verdict)
        except KeyboardInterrupt:  # a second one ends it
            files, interrupted = write_data(data, folder), True
    _say(study, data, folder, files, verdict, json=json, verbose=verbose)
    if interrupted:
        _stopped(data, json=json)
        raise typer.Exit(INTERRUPTED)
    if data.attrs["partial"]:
        _failed(data, json=json)
        raise typer.Exit(1)
    return verdict


def _say(
    study: Study | ActuatorStudy, data: Dataset, folder: Path, files: list[Path], verdict: Dataset | None, *,
    json: bool, verbose: bool,
) -> None:  # fmt: skip
    told = answers.run_items(study, data)
    items = chain(text_verdict.verdict_items(verdict), told, ["", _where(data, folder, files)])
    places = {"folder": folder, "files": files} | text_verdict.verdict_as_dict(verdict)
    terminal.print_answer(items, lambda: answers.run_as_dict(study, data) | places, json=json, verbose=verbose)


def _where(data: Dataset, folder: Path, files: Sequence[Path]) -> str:
    """Sentence on the files of a run, and on the steps and the time that it took."""
    formats = list(dict.fromkeys(path.suffix for path in files if path.suffix[1:] in FORMATS))
    names = ", ".join(path.name for path in files if path.suffix not in formats)
    names = names.replace("report.html", "report.html (open it in a browser)")
    figures = sum(path.suffix in formats for path in files) // max(len(formats), 1)
    kinds = " and ".join(suffix[1:].upper() for suffix in formats)
    drawn = f", {figures} figure{'s' * (figures > 1)} ({kinds})" if figures else ""
    seconds = f"{data.attrs['steps']} steps, {data.attrs['wall_time']:.2g} s"
    return f"In {folder}: {names}{drawn}. ({seconds} of time integration)"


def _stopped(data: Dataset, *, json: bool) -> None:
    kept = "what was computed is kept and marked as partial" if data.attrs["partial"] else "the whole result is kept"
    what = f"{stop_words()} at t = {float(data.time[-1]):.6g} s; {kept}"
    print_parts({"kind": "interrupt", "what": what}, INTERRUPTED, as_json=json)


def _failed(data: Dataset, *, json: bool) -> None:
    what = f"the simulation stopped at t = {float(data.time[-1]):.6g} s: {data.attrs['failure']}"
    print_error(ComputationError(what, next_step="What was computed is kept and marked as partial"), as_json=json)


Clear = Annotated[bool, typer.Option("--clear", help="Remove all kernels; each is compiled again when needed.")]


@report_failures
def cache(clear: Clear = False, json: Json = False) -> None:
    """Show where compiled kernels are stored, how many there are and their size, or remove them.

    FLEXAPOD_CACHE chooses another folder, FLEXAPOD_CACHE_MEGABYTES another bound.
    """
    found = symbolic_cache.clear_cache() if clear else symbolic_cache.cache_content()
    kernels = f"{found.kernels} compiled kernel{'s' * (found.kernels != 1)}"
    if clear:
        items = [f"Removed {kernels} ({_megabytes(found.size)}) from {found.folder}."]
    else:
        items = [f"Folder: {found.folder}", f"{kernels}, {_megabytes(found.size)} of at most {_megabytes(found.limit)}"]
        if found.unused_because:
            items += [f"Not used: {found.unused_because}. Each run compiles its own kernels."]
    terminal.print_answer(items, lambda: _as_dict(found, cleared=clear), json=json)


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


def _megabytes(size: int) -> str:
    return f"{size / 1e6:.4g} MB"
