"""Commands at a pose of the locked robot: `modes` lists its modes, `export` writes it as a deck."""

from __future__ import annotations

import string
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.cli.failures import guarded
from flexapod.cli.options import (
    Force,
    Json,
    NoFigures,
    Pose,
    StudyFile,
    as_options,
    check_writable,
    refuse_existing,
    robot_study,
)
from flexapod.document.terminal import tell
from flexapod.errors import InputError
from flexapod.runtime.files import write_text

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
    from flexapod.cli.map_options import parse_pose
    from flexapod.document.modes import modes_as_dict, modes_items
    from flexapod.study import modes as compute

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
    from flexapod.errors import FlexapodError
    from flexapod.pose_errors.disturbances import words_of
    from flexapod.study import vibration

    if study.disturbance is None:
        return None, ()
    try:
        data = vibration(study, pose)
    except FlexapodError as error:
        return None, (f"vibration by disturbances cannot be said: {error}",)
    return data, words_of(data, "there")


def _write_modes(data: Dataset, shaken: Dataset | None, folder: Path, *, figure: bool) -> list[Path]:
    from flexapod import plot
    from flexapod.study.store import save

    files = [save(data, folder / "modes.nc")]
    files += plot.save(plot.modes_3d(data), folder / "modes") if figure else ()
    if shaken is not None:
        files.append(save(shaken, folder / "vibration.nc"))
        files += plot.save(plot.vibration(shaken), folder / "vibration") if figure else ()
    return files


NAMES = frozenset(string.ascii_letters + string.digits + "-_")

Format = Annotated[str, typer.Option("--format", metavar="FORMAT", help="abaqus, which CalculiX reads as well.")]
Elements = Annotated[int, typer.Option("--elements", help="Solid elements along the free part of each piston.")]
Wanted = Annotated[int, typer.Option("--count", help="How many frequencies the deck asks for.")]
Deck = Annotated[
    Path | None, typer.Option("--out", metavar="FILE.inp", help="File to write; default: beside the study, FILE.inp.")
]


@guarded
def export(
    file: StudyFile,
    format: Format = "abaqus",
    pose: Pose = None,
    elements: Elements = 20,
    count: Wanted = 24,
    out: Deck = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Write the robot with locked drives as a deck for Abaqus and CalculiX: sag under gravity, frequencies."""
    from flexapod.cli.map_options import parse_pose
    from flexapod.exchange.export import FORMATS, abaqus_deck

    if format not in FORMATS:
        words = "abaqus, a deck that CalculiX reads as well"
        raise InputError("is not a format", key="--format", value=format, allowed=words)
    study = robot_study(file)
    path = file.with_name(file.stem + ".inp") if out is None else out
    _check_file(path, force)
    title = f"{file.stem}: robot with locked drives"
    with as_options(elements="--elements", modes="--count", pose="--pose"):
        text = abaqus_deck(study, parse_pose(pose), elements=elements, modes=count, title=title)
    write_text(path, text, encoding="ascii", errors="replace")
    at = f' --pose "{pose}"' if pose else ""
    items = [
        f"Written: {path}",
        f"Run it with `ccx -i {path.with_suffix('')}` (CalculiX) or `abaqus job={path.stem}` (Abaqus).",
        f"Compare its frequencies and its sag with `flexapod modes {file}{at}`.",
        "Bending of slender pistons lies parts in ten thousand lower: a solid has shear and rotary inertia.",
    ]
    tell(items, lambda: {"file": path, "format": format, "elements": elements, "modes": count}, json=json)


def _check_file(path: Path, force: bool) -> None:
    if path.is_dir():
        raise InputError("is a folder", key="--out", value=str(path), next_step="Give the name of a file")
    if path.suffix.lower() != ".inp":
        raise InputError(
            "is not named as a deck", key="--out", value=str(path), allowed="FILE.inp: both programs ask for it"
        )
    if not set(path.stem) <= NAMES:
        raise InputError(
            "has a name that CalculiX or Abaqus do not read",
            key="--out",
            value=path.name,
            allowed="letters without accents, digits, - and _",
            next_step="Name the deck with --out NAME.inp",
        )
    refuse_existing(path, force)
