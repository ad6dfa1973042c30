"""`flexapod converge`: how results depend on step and shapes, and the cheapest setting for an accuracy."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.app.failures import INTERRUPTED, guarded, print_parts
from flexapod.app.options import Json, NoFigures, Out, Quiet, StudyFile, as_options
from flexapod.app.stopping import stopped

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.surveys.convergence import Trials

__all__ = ["add"]

Accuracy = Annotated[
    float, typer.Option("--accuracy", metavar="ERROR", help="Relative error that the recommended setting keeps.")
]
Ladder = Annotated[bool, typer.Option("--ladder", help="Also every fidelity, rigid to solid-fem: error against cost.")]


def add(app: typer.Typer) -> None:
    """Give `app` the command."""
    app.command("converge")(converge)


@guarded
def converge(
    file: StudyFile, accuracy: Accuracy = 1e-2, ladder: Ladder = False, out: Out = None,
    no_figures: NoFigures = False, json: Json = False, quiet: Quiet = False,
) -> None:  # fmt: skip
    """Vary step, shapes and elements of a study: errors, orders, cost, and the cheapest setting that will do."""
    from flexapod.app.outputs import results_folder
    from flexapod.app.terminal import print_text
    from flexapod.model import load
    from flexapod.surveys.convergence.plan import checked_trials, estimate

    trials = checked_trials(load(file), None)
    folder = results_folder(file, "converge", out)
    with as_options(accuracy="--accuracy"):
        count, seconds = estimate(trials, accuracy)
    if not (json or quiet):
        print_text(
            f"About {count} settings, {_rough(seconds)}; the first time a few seconds more for each number of "
            "shapes that is compiled."
        )
    tables, interrupted = _computed(trials, accuracy, ladder=ladder, quiet=quiet or json)
    files = [path for name, data in tables.items() for path in _write(data, folder, name, figure=not no_figures)]
    _say(tables, folder, files, json=json)
    if interrupted:
        _stopped(tables, json=json)
        raise typer.Exit(INTERRUPTED)


def _computed(trials: Trials, accuracy: float, *, ladder: bool, quiet: bool) -> tuple[dict[str, Dataset], bool]:
    """Tables by the names of their files, and whether the user stopped."""
    from flexapod.app.terminal import progress_bar
    from flexapod.surveys.convergence import ConvergenceStopped
    from flexapod.surveys.convergence import converge as compute
    from flexapod.surveys.convergence.ladder import ladder as climb

    tables: dict[str, Dataset] = {}
    name = "convergence"
    with progress_bar(quiet=quiet) as report:
        try:
            tables[name] = compute(trials.study, accuracy=accuracy, progress=report, trials=trials)
            if ladder:
                name, step = "ladder", float(tables[name].attrs["shape_step"])
                tables[name] = climb(trials.study, step=step, progress=report, trials=trials)
        except ConvergenceStopped as stop:
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


def _write(data: Dataset, folder: Path, name: str, *, figure: bool) -> list[Path]:
    """The table as NetCDF and CSV, and its figure where it is wanted."""
    from flexapod import plot
    from flexapod.plot.convergence import convergence, ladder
    from flexapod.study.store import save
    from flexapod.surveys.convergence.table import save_table

    draw = {"convergence": convergence, "ladder": ladder}[name]
    files = [save(data, folder / f"{name}.nc"), save_table(data, folder / f"{name}.csv")]
    return [*files, *(plot.save(draw(data), folder / name) if figure else ())]


def _say(tables: dict[str, Dataset], folder: Path, files: list[Path], *, json: bool) -> None:
    from flexapod.app.converge_words import as_dict, show, show_ladder
    from flexapod.app.terminal import print_json, print_text

    if json:
        found = {name: as_dict(data) for name, data in tables.items()}
        print_json({**found.get("convergence", {}), "ladder": found.get("ladder"), "folder": folder, "files": files})
        return
    for name, data in tables.items():
        {"convergence": show, "ladder": show_ladder}[name](data)
    print_text()
    print_text(f"In {folder}: {', '.join(path.name for path in files)}.")


def _stopped(tables: dict[str, Dataset], *, json: bool) -> None:
    count = sum(data.sizes["setting"] for data in tables.values())
    what = f"{stopped()} after {count} settings; what was computed is kept and marked as partial"
    print_parts({"kind": "interrupt", "what": what}, INTERRUPTED, as_json=json)
