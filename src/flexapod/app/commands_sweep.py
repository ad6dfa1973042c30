"""`flexapod sweep`: many variants of a study, on local cores or a Dask cluster, into a store that can be continued."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.app.failures import INTERRUPTED, guarded, print_parts
from flexapod.app.options import Json, NoFigures, Quiet, StudyFile, as_options
from flexapod.app.stopping import stopped

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["add"]

SweepFile = Annotated[Path, typer.Argument(metavar="SWEEP", help="Sweep file (TOML): what varies, what is kept.")]
Out = Annotated[
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


def add(app: typer.Typer) -> None:
    """Give `app` the command."""
    app.command("sweep")(sweep)


@guarded
def sweep(
    file: StudyFile, sweep_file: SweepFile, out: Out = None, scheduler: Scheduler = None, workers: Workers = None,
    retry_failed: RetryFailed = False, no_figures: NoFigures = False, json: Json = False, quiet: Quiet = False,
) -> None:  # fmt: skip
    """Compute many variants of a study: grids, lists, Latin hypercubes, random tolerances. Run again, it continues."""
    from flexapod.app.outputs import results_folder
    from flexapod.app.terminal import progress_bar
    from flexapod.surveys.sweeps import SweepStopped
    from flexapod.surveys.sweeps import sweep as compute

    folder = results_folder(file, sweep_file.stem, out)
    with as_options(workers="--workers", scheduler="--scheduler"), progress_bar(quiet=quiet or json) as report:
        try:
            data = compute(
                file, sweep_file, store=folder / "sweep.zarr", scheduler=scheduler, workers=workers,
                retry_failed=retry_failed, progress=report,
            )  # fmt: skip
            interrupted = False
        except SweepStopped as stop:
            data, interrupted = stop.dataset, True
        files = _write(data, folder, figure=not no_figures)
    _say(data, folder, files, json=json)
    if interrupted:
        _stopped(data, json=json)
        raise typer.Exit(INTERRUPTED)
    if not (data.status == "computed").any():
        raise typer.Exit(1)


def _write(data: Dataset, folder: Path, *, figure: bool) -> list[Path]:
    """The table, and the figure where it is wanted and there is something to see."""
    from flexapod import plot
    from flexapod.plot.sweep import sweep as draw
    from flexapod.surveys.sweeps import save_table, scalar_names

    files = [save_table(data, folder / "sweep.csv")]
    if figure and any(data[name].notnull().any() for name in scalar_names(data)):
        files += plot.save(draw(data), folder / "sweep")
    return files


def _say(data: Dataset, folder: Path, files: list[Path], *, json: bool) -> None:
    from flexapod.app.sweep_words import as_dict, show
    from flexapod.app.terminal import print_json, print_text

    if json:
        print_json({**as_dict(data), "folder": folder, "files": [folder / "sweep.zarr", *files]})
        return
    show(data)
    print_text()
    print_text(f"In {folder}: sweep.zarr, {', '.join(path.name for path in files)}.")


def _stopped(data: Dataset, *, json: bool) -> None:
    done = int((data.status != "pending").sum())
    print_parts(
        {
            "kind": "interrupt",
            "what": f"{stopped()} after {done} of {data.sizes['point']} points, which are stored",
            "next_step": f"To continue, run the same command again: {shlex.join(['flexapod', *sys.argv[1:]])}",
        },
        INTERRUPTED,
        as_json=json,
    )
