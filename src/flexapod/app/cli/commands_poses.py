"""Commands at a pose of the locked robot: `modes` lists its modes, `budget` the error of the tool by part.

The budget is at a pose or along the motion.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.app.cli.failures import report_failures
from flexapod.app.cli.options import (
    USUAL,
    Format,
    Json,
    NoFigures,
    Pose,
    Quiet,
    StudyFile,
    Verbose,
    as_options,
    check_writable,
    parse_formats,
)
from flexapod.output.text.terminal import print_answer

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod.model import Study

Folder = Annotated[
    Path | None,
    typer.Option(
        "--out", metavar="DIR", help="Write modes.nc and figures, with disturbances vibration.nc; default: not."
    ),
]
Count = Annotated[int, typer.Option("--count", min=1, help="How many of the lowest modes to show.")]


@report_failures
def modes(
    file: StudyFile, pose: Pose = None, out: Folder = None, count: Count = 12, formats: Format = USUAL,
    no_figures: NoFigures = False, json: Json = False,
) -> None:  # fmt: skip
    """Frequencies, damping and shapes at a pose, commands of the drives held, about the static equilibrium.

    Of a single actuator those of its straight beam at t = 0.
    """
    from flexapod import model
    from flexapod.analysis import modes as compute
    from flexapod.app.cli.pose_options import parse_pose
    from flexapod.output.text.answers import modes_as_dict, modes_items

    study, drawn = model.load(file), parse_formats(formats, no_figures)
    check_writable(out)
    with as_options(pose="--pose"):
        data = compute(study, parse_pose(pose))
    of_robot = isinstance(study, model.Study)
    shaken, sentences = _shaken(study, parse_pose(pose)) if of_robot else (None, ())
    files = [] if out is None else _write_modes(data, shaken, out, drawn if of_robot else ())
    items = chain(modes_items(study, data, pose, count, sentences), map("Written: {}".format, files))
    print_answer(items, lambda: modes_as_dict(data, shaken, files), json=json)


def _shaken(study: Study, pose: dict[str, float] | None) -> tuple[Dataset | None, tuple[str, ...]]:
    """Vibration by the study's disturbances, and in words, or why it has none."""
    from flexapod.analysis import vibration
    from flexapod.analysis.pose_errors.disturbances import shaking
    from flexapod.common.errors import FlexapodError
    from flexapod.output.text.description import vibration_words

    if study.disturbance is None:
        return None, ()
    try:
        data = vibration(study, pose)
    except FlexapodError as error:
        return None, (f"vibration by disturbances cannot be said: {error}",)
    return data, vibration_words(shaking(data), "there")


def _write_modes(data: Dataset, shaken: Dataset | None, folder: Path, formats: Sequence[str]) -> list[Path]:
    from flexapod.analysis.store import save
    from flexapod.output import figures

    files = [save(data, folder / "modes.nc")]
    files += figures.save(figures.modes_3d(data), folder / "modes", formats=formats) if formats else ()
    if shaken is not None:
        files.append(save(shaken, folder / "vibration.nc"))
        files += figures.save(figures.vibration(shaken), folder / "vibration", formats=formats) if formats else ()
    return files


Motion = Annotated[bool, typer.Option("--motion", help="Along the motion in place of a pose: with what is dynamic.")]
BudgetFolder = Annotated[
    Path | None, typer.Option("--out", metavar="DIR", help="Write budget.nc and the chart; default: not.")
]


@report_failures
def budget(
    file: StudyFile, pose: Pose = None, motion: Motion = False, out: BudgetFolder = None, formats: Format = USUAL,
    no_figures: NoFigures = False, quiet: Quiet = False, verbose: Verbose = False, json: Json = False,
) -> None:  # fmt: skip
    """Error budget of the tool: which part adds what, and what halving the largest error would bring."""
    from flexapod import model
    from flexapod.analysis import budget as compute
    from flexapod.analysis.results.idealizations import idealization
    from flexapod.app.cli.pose_options import parse_pose
    from flexapod.common.errors import InputError
    from flexapod.output.text.budget import budget_as_dict, budget_counts, budget_items
    from flexapod.output.text.description import ideal_words
    from flexapod.output.text.terminal import print_answer, progress_bar

    study, drawn = model.load(file), parse_formats(formats, no_figures)
    if isinstance(study, model.ActuatorStudy):
        raise InputError("is the study of a single actuator", file=file, allowed="the study of a robot")
    check_writable(out)
    with as_options(pose="--pose"), progress_bar(quiet=quiet or json) as report:
        data = compute(
            study, parse_pose(pose), motion=motion, progress=lambda now, end: report("simulating", now / end)
        )
    files = [] if out is None else _write(data, out, drawn)
    ideal, counts = ideal_words(idealization(study.robot)), None if motion else budget_counts(study.robot)
    items = chain(budget_items(data, (ideal, counts)), map("Written: {}".format, files))
    print_answer(
        items, lambda: {**budget_as_dict(data, files), "ideal": ideal, "counts": counts}, json=json, verbose=verbose
    )


def _write(data: Dataset, folder: Path, formats: Sequence[str]) -> list[Path]:
    from flexapod.analysis.store import save
    from flexapod.output import figures

    files = [save(data, folder / "budget.nc")]
    return [*files, *(figures.save(figures.budget(data), folder / "budget", formats=formats) if formats else ())]
