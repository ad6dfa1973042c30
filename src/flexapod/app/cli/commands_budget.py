"""`flexapod budget`: what every part adds to the error of the tool, at a pose or along the motion."""

from __future__ import annotations

from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.app.cli.failures import guarded
from flexapod.app.cli.options import Json, NoFigures, Pose, Quiet, StudyFile, Verbose, as_options, check_writable

if TYPE_CHECKING:
    from xarray import Dataset

Motion = Annotated[bool, typer.Option("--motion", help="Along the motion in place of a pose: with what is dynamic.")]
Folder = Annotated[
    Path | None, typer.Option("--out", metavar="DIR", help="Write budget.nc and the chart; default: not.")
]


@guarded
def budget(
    file: StudyFile, pose: Pose = None, motion: Motion = False, out: Folder = None, no_figures: NoFigures = False,
    quiet: Quiet = False, verbose: Verbose = False, json: Json = False,
) -> None:  # fmt: skip
    """Error budget of the tool: which part adds what, and what halving the largest error would bring."""
    from flexapod import model
    from flexapod.analysis import budget as compute
    from flexapod.analysis.error_budget.counted import budget_counts
    from flexapod.analysis.results.idealizations import ideal_words
    from flexapod.app.cli.map_options import parse_pose
    from flexapod.common.errors import InputError
    from flexapod.output.text.budget import budget_as_dict, budget_items
    from flexapod.output.text.terminal import progress_bar, tell

    study = model.load(file)
    if isinstance(study, model.ActuatorStudy):
        raise InputError("is the study of a single actuator", file=file, allowed="the study of a robot")
    check_writable(out)
    with as_options(pose="--pose"), progress_bar(quiet=quiet or json) as report:
        data = compute(
            study, parse_pose(pose), motion=motion, progress=lambda now, end: report("simulating", now / end)
        )
    files = [] if out is None else _write(data, out, figure=not no_figures)
    ideal, counts = ideal_words(study.robot), None if motion else budget_counts(study.robot)
    items = chain(budget_items(data, (ideal, counts)), map("Written: {}".format, files))
    tell(items, lambda: {**budget_as_dict(data, files), "ideal": ideal, "counts": counts}, json=json, verbose=verbose)


def _write(data: Dataset, folder: Path, *, figure: bool) -> list[Path]:
    from flexapod.analysis.store import save
    from flexapod.output import figures

    files = [save(data, folder / "budget.nc")]
    return [*files, *(figures.save(figures.budget(data), folder / "budget") if figure else ())]
