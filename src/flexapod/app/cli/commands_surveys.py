"""Commands of many runs: `sweep` over variants, `converge` over step and shapes."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Sequence
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.app.cli.failures import INTERRUPTED, print_parts, report_failures, stop_words
from flexapod.app.cli.options import (
    USUAL,
    Format,
    Json,
    NoFigures,
    Out,
    Quiet,
    StudyFile,
    as_options,
    parse_formats,
    results_folder,
)
from flexapod.common.lazy_imports import LazyModule, hide_package
from flexapod.output.text import terminal

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod import model
    from flexapod.analysis import store as analysis_store
    from flexapod.design import convergence, sweeps
    from flexapod.design.convergence import Trials, plan, table
    from flexapod.design.convergence import ladder as convergence_ladder
    from flexapod.output import figures
    from flexapod.output.text import surveys
else:
    analysis_store = LazyModule("flexapod.analysis.store")
    convergence = LazyModule("flexapod.design.convergence")
    convergence_ladder = LazyModule("flexapod.design.convergence.ladder")
    plan = LazyModule("flexapod.design.convergence.plan")
    table = LazyModule("flexapod.design.convergence.table")
    sweeps = LazyModule("flexapod.design.sweeps")
    model = LazyModule("flexapod.model")
    figures = LazyModule("flexapod.output.figures")
    surveys = LazyModule("flexapod.output.text.surveys")

SweepFile = Annotated[Path, typer.Argument(metavar="SWEEP", help="Sweep file (TOML): what varies, what is kept.")]
SweepOut = Annotated[
    Path | None,
    typer.Option(
        "--out", metavar="DIR", help="Folder of the results; default: beside the study, the names of both files."
    ),
]
Scheduler = Annotated[
    str | None, typer.Option("--scheduler", metavar="ADDRESS", help="A running Dask scheduler, tcp://host:8786.")
]
Workers = Annotated[
    int | None, typer.Option("--workers", metavar="N", help="Local processes; default: one a core; 0: none but this.")
]
RetryFailed = Annotated[bool, typer.Option("--retry-failed", help="Compute points again that failed before.")]
Zarr = Annotated[bool, typer.Option("--zarr", help="Write what was computed also as Zarr, for other programs.")]


@report_failures
def sweep(
    file: StudyFile, sweep_file: SweepFile, out: SweepOut = None, scheduler: Scheduler = None, workers: Workers = None,
    retry_failed: RetryFailed = False, zarr: Zarr = False, formats: Format = USUAL, no_figures: NoFigures = False,
    json: Json = False, quiet: Quiet = False,
) -> None:  # fmt: skip
    """Compute many variants of a study: grids, lists, Latin hypercubes, random tolerances. Run again, it continues."""
    folder, drawn = results_folder(file, sweep_file.stem, out), parse_formats(formats, no_figures)
    store = folder / ("sweep.zarr" if zarr else "sweep.sqlite")
    options = as_options(workers="--workers", scheduler="--scheduler")
    with hide_package("dask.array"), options, terminal.progress_bar(quiet=quiet or json) as report:
        try:
            data = sweeps.sweep(
                file, sweep_file, store=store, scheduler=scheduler, workers=workers, retry_failed=retry_failed,
                progress=report,
            )  # fmt: skip
            interrupted = False
        except sweeps.SweepStopped as stop:
            data, interrupted = stop.dataset, True
        files = [folder / "sweep.sqlite", *[store] * zarr, *_write_sweep(data, folder, drawn)]
    _say_sweep(data, folder, files, json=json)
    if interrupted:
        _stopped_sweep(data, json=json)
        raise typer.Exit(INTERRUPTED)
    if not (data.status == "computed").any():
        raise typer.Exit(1)


def _write_sweep(data: Dataset, folder: Path, formats: Sequence[str]) -> list[Path]:
    """The table, and the figure where a format is given and there is something to see."""
    files = [sweeps.save_table(data, folder / "sweep.csv")]
    if formats and any(data[name].notnull().any() for name in sweeps.scalar_names(data)):
        files += figures.save(figures.sweep(data), folder / "sweep", formats=formats)
    return files


def _say_sweep(data: Dataset, folder: Path, files: list[Path], *, json: bool) -> None:
    where = f"In {folder}: {', '.join(path.name for path in files)}."
    places = {"folder": folder, "files": files}
    terminal.print_answer(
        chain(surveys.sweep_items(data), ["", where]), lambda: surveys.sweep_as_dict(data) | places, json=json
    )


def _stopped_sweep(data: Dataset, *, json: bool) -> None:
    done = int((data.status != "pending").sum())
    print_parts(
        {
            "kind": "interrupt",
            "what": f"{stop_words()} after {done} of {data.sizes['point']} points, which are stored",
            "next_step": f"To continue, run the same command again: {shlex.join(['flexapod', *sys.argv[1:]])}",
        },
        INTERRUPTED,
        as_json=json,
    )


Accuracy = Annotated[
    float, typer.Option("--accuracy", metavar="ERROR", help="Relative error that the recommended setting keeps.")
]
Ladder = Annotated[bool, typer.Option("--ladder", help="Also every fidelity, rigid to solid-fem: error against cost.")]


@report_failures
def converge(
    file: StudyFile, accuracy: Accuracy = 1e-2, ladder: Ladder = False, out: Out = None,
    formats: Format = USUAL, no_figures: NoFigures = False, json: Json = False, quiet: Quiet = False,
) -> None:  # fmt: skip
    """Vary step, shapes and elements of a study: errors, orders, cost, and the cheapest setting that will do."""
    trials = plan.checked_trials(model.load(file), None)
    folder, drawn = results_folder(file, "converge", out), parse_formats(formats, no_figures)
    with as_options(accuracy="--accuracy"):
        count, seconds = plan.estimate(trials, accuracy)
    if not (json or quiet):
        terminal.print_text(
            f"About {count} settings, {_rough(seconds)}; the first time a few seconds more for each number of "
            "shapes that is compiled."
        )
    tables, interrupted = _computed(trials, accuracy, ladder=ladder, quiet=quiet or json)
    files = [path for name, data in tables.items() for path in _write(data, folder, name, drawn)]
    _say(tables, folder, files, json=json)
    if interrupted:
        _stopped(tables, json=json)
        raise typer.Exit(INTERRUPTED)


def _computed(trials: Trials, accuracy: float, *, ladder: bool, quiet: bool) -> tuple[dict[str, Dataset], bool]:
    """Tables by the names of their files, and whether the user stopped."""
    tables: dict[str, Dataset] = {}
    name = "convergence"
    with terminal.progress_bar(quiet=quiet) as report:
        try:
            tables[name] = convergence.converge(trials.study, accuracy=accuracy, progress=report, trials=trials)
            if ladder:
                name, step = "ladder", float(tables[name].attrs["shape_step"])
                tables[name] = convergence_ladder.ladder(trials.study, step=step, progress=report, trials=trials)
        except convergence.ConvergenceStopped as stop:
            tables[name] = stop.dataset
            return tables, True
        except KeyboardInterrupt:
            if not tables:
                raise
            return tables, True
    return tables, False


def _rough(seconds: float) -> str:
    """A duration as an estimate deserves."""
    return f"up to {max(10, 10 * round(seconds / 10 + 0.4))} s" if seconds < 90 else f"{seconds / 60:.0f} minutes"


def _write(data: Dataset, folder: Path, name: str, formats: Sequence[str]) -> list[Path]:
    """The table as NetCDF and CSV, and its figure where a format is given."""
    draw = {"convergence": figures.convergence, "ladder": figures.ladder}[name]
    files = [analysis_store.save(data, folder / f"{name}.nc"), table.save_table(data, folder / f"{name}.csv")]
    return [*files, *(figures.save(draw(data), folder / name, formats=formats) if formats else ())]


def _say(tables: dict[str, Dataset], folder: Path, files: list[Path], *, json: bool) -> None:
    def data() -> dict[str, object]:
        found = {name: surveys.convergence_as_dict(data) for name, data in tables.items()}
        return {**found.get("convergence", {}), "ladder": found.get("ladder"), "folder": folder, "files": files}

    said = {"convergence": surveys.convergence_items, "ladder": surveys.ladder_items}
    where = f"In {folder}: {', '.join(path.name for path in files)}."
    items = (item for name, data in tables.items() for item in said[name](data))
    terminal.print_answer(chain(items, ["", where]), data, json=json)


def _stopped(tables: dict[str, Dataset], *, json: bool) -> None:
    count = sum(data.sizes["setting"] for data in tables.values())
    what = f"{stop_words()} after {count} settings; what was computed is kept and marked as partial"
    print_parts({"kind": "interrupt", "what": what}, INTERRUPTED, as_json=json)
