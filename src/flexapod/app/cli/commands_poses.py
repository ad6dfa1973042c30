"""A command at a pose of the locked robot: `modes` lists its modes."""

from __future__ import annotations

from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.app.cli.failures import guarded
from flexapod.app.cli.options import Json, NoFigures, Pose, StudyFile, as_options, check_writable
from flexapod.output.text.terminal import tell

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


@guarded
def modes(
    file: StudyFile, pose: Pose = None, out: Folder = None, count: Count = 12, no_figures: NoFigures = False,
    json: Json = False,
) -> None:  # fmt: skip
    """Frequencies, damping and shapes at a pose, commands of the drives held, about the static equilibrium.

    Of a single actuator those of its straight beam at t = 0.
    """
    from flexapod import model
    from flexapod.analysis import modes as compute
    from flexapod.app.cli.map_options import parse_pose
    from flexapod.output.text.modes import modes_as_dict, modes_items

    study = model.load(file)
    check_writable(out)
    with as_options(pose="--pose"):
        data = compute(study, parse_pose(pose))
    of_robot = isinstance(study, model.Study)
    shaken, sentences = _shaken(study, parse_pose(pose)) if of_robot else (None, ())
    files = [] if out is None else _write_modes(data, shaken, out, figure=of_robot and not no_figures)
    items = chain(modes_items(study, data, pose, count, sentences), map("Written: {}".format, files))
    tell(items, lambda: modes_as_dict(data, shaken, files), json=json)


def _shaken(study: Study, pose: dict[str, float] | None) -> tuple[Dataset | None, tuple[str, ...]]:
    """Vibration by the study's disturbances, and in words, or why it has none."""
    from flexapod.analysis import vibration
    from flexapod.analysis.pose_errors.disturbances import words_of
    from flexapod.common.errors import FlexapodError

    if study.disturbance is None:
        return None, ()
    try:
        data = vibration(study, pose)
    except FlexapodError as error:
        return None, (f"vibration by disturbances cannot be said: {error}",)
    return data, words_of(data, "there")


def _write_modes(data: Dataset, shaken: Dataset | None, folder: Path, *, figure: bool) -> list[Path]:
    from flexapod.analysis.store import save
    from flexapod.output import figures

    files = [save(data, folder / "modes.nc")]
    files += figures.save(figures.modes_3d(data), folder / "modes") if figure else ()
    if shaken is not None:
        files.append(save(shaken, folder / "vibration.nc"))
        files += figures.save(figures.vibration(shaken), folder / "vibration") if figure else ()
    return files
