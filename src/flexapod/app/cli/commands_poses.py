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
    Settings,
    Strict,
    StudyFile,
    Verbose,
    as_options,
    check_writable,
    exit_strictly,
    load_study,
    parse_formats,
    refuse_unrequired,
    robot_study,
)
from flexapod.common.lazy_imports import LazyModule
from flexapod.output.text.terminal import print_answer, progress_bar

if TYPE_CHECKING:
    from xarray import Dataset

    from flexapod import analysis, model
    from flexapod.analysis import store
    from flexapod.analysis.pose_errors import disturbances
    from flexapod.analysis.results import idealizations
    from flexapod.app.cli import pose_options
    from flexapod.common import errors
    from flexapod.model import Study
    from flexapod.output import figures
    from flexapod.output.text import answers, description
    from flexapod.output.text import budget as text_budget
    from flexapod.output.text import verdict as text_verdict
else:
    analysis = LazyModule("flexapod.analysis")
    disturbances = LazyModule("flexapod.analysis.pose_errors.disturbances")
    idealizations = LazyModule("flexapod.analysis.results.idealizations")
    store = LazyModule("flexapod.analysis.store")
    pose_options = LazyModule("flexapod.app.cli.pose_options")
    errors = LazyModule("flexapod.common.errors")
    model = LazyModule("flexapod.model")
    figures = LazyModule("flexapod.output.figures")
    answers = LazyModule("flexapod.output.text.answers")
    text_budget = LazyModule("flexapod.output.text.budget")
    description = LazyModule("flexapod.output.text.description")
    text_verdict = LazyModule("flexapod.output.text.verdict")

Folder = Annotated[
    Path | None,
    typer.Option(
        "--out", metavar="DIR", help="Write modes.nc and figures, with disturbances vibration.nc; default: not."
    ),
]
Count = Annotated[int, typer.Option("--count", min=1, help="How many of the lowest modes to show.")]


@report_failures
def modes(
    file: StudyFile, settings: Settings = None, pose: Pose = None, out: Folder = None, count: Count = 12,
    formats: Format = USUAL,
    no_figures: NoFigures = False, json: Json = False,
) -> None:  # fmt: skip
    """Frequencies, damping and shapes at a pose, commands of the drives held, about the static equilibrium.

    Of a single actuator those of its straight beam at t = 0.
    """
    study, drawn = load_study(file, settings), parse_formats(formats, no_figures)
    check_writable(out)
    with as_options(pose="--pose"):
        data = analysis.modes(study, pose_options.parse_pose(pose))
    of_robot = isinstance(study, model.Study)
    shaken, sentences = _shaken(study, pose_options.parse_pose(pose)) if of_robot else (None, ())
    files = [] if out is None else _write_modes(data, shaken, out, drawn if of_robot else ())
    items = chain(answers.modes_items(study, data, pose, count, sentences), map("Written: {}".format, files))
    print_answer(items, lambda: answers.modes_as_dict(data, shaken, files), json=json)


def _shaken(study: Study, pose: dict[str, float] | None) -> tuple[Dataset | None, tuple[str, ...]]:
    """Vibration by the study's disturbances, and in words, or why it has none."""
    if study.disturbance is None:
        return None, ()
    try:
        data = analysis.vibration(study, pose)
    except errors.FlexapodError as error:
        return None, (f"vibration by disturbances cannot be said: {error}",)
    return data, description.vibration_words(disturbances.shaking(data), "there")


def _write_modes(data: Dataset, shaken: Dataset | None, folder: Path, formats: Sequence[str]) -> list[Path]:
    files = [store.save(data, folder / "modes.nc")]
    files += figures.save(figures.modes_3d(data), folder / "modes", formats=formats) if formats else ()
    if shaken is not None:
        files.append(store.save(shaken, folder / "vibration.nc"))
        files += figures.save(figures.vibration(shaken), folder / "vibration", formats=formats) if formats else ()
    return files


Motion = Annotated[bool, typer.Option("--motion", help="Along the motion in place of a pose: with what is dynamic.")]
BudgetFolder = Annotated[
    Path | None, typer.Option("--out", metavar="DIR", help="Write budget.nc and the chart; default: not.")
]


@report_failures
def budget(
    file: StudyFile, settings: Settings = None, pose: Pose = None, motion: Motion = False,
    out: BudgetFolder = None, formats: Format = USUAL, no_figures: NoFigures = False, quiet: Quiet = False,
    strict: Strict = False, verbose: Verbose = False, json: Json = False,
) -> None:  # fmt: skip
    """Error budget of the tool: which part adds what, and what halving the largest error would bring."""
    study, drawn = robot_study(file, settings), parse_formats(formats, no_figures)
    check_writable(out)
    refuse_unrequired(study, strict=strict)
    verdict = text_verdict.study_verdict(study)
    with as_options(pose="--pose"), progress_bar(quiet=quiet or json) as report:
        data = analysis.budget(
            study,
            pose_options.parse_pose(pose),
            motion=motion,
            progress=lambda now, end: report("simulating", now / end),
        )
    files = [] if out is None else _write(data, out, drawn)
    ideal, counts = (
        description.ideal_words(idealizations.idealization(study.robot)),
        None if motion else text_budget.budget_counts(study.robot),
    )
    told = text_budget.budget_items(data, (ideal, counts))
    items = chain(text_verdict.verdict_items(verdict), told, map("Written: {}".format, files))
    print_answer(
        items,
        lambda: (
            {**text_budget.budget_as_dict(data, files), "ideal": ideal, "counts": counts}
            | text_verdict.verdict_as_dict(verdict)
        ),
        json=json,
        verbose=verbose,
    )
    exit_strictly(verdict, strict=strict)


def _write(data: Dataset, folder: Path, formats: Sequence[str]) -> list[Path]:
    files = [store.save(data, folder / "budget.nc")]
    return [*files, *(figures.save(figures.budget(data), folder / "budget", formats=formats) if formats else ())]
