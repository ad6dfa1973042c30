"""`flexapod export`: the locked robot at a pose as a deck for Abaqus and CalculiX."""

from __future__ import annotations

import string
from pathlib import Path
from typing import Annotated

import typer

from flexapod.app.commands_modes import parse_pose
from flexapod.app.failures import guarded
from flexapod.app.options import Json, StudyFile, as_options

__all__ = ["add"]

NAMES = frozenset(string.ascii_letters + string.digits + "-_")

Format = Annotated[str, typer.Option("--format", metavar="FORMAT", help="abaqus, which CalculiX reads as well.")]
Pose = Annotated[
    str | None,
    typer.Option("--pose", metavar='"roll=20deg,heave=10mm"', help="From home; numbers without unit in m and rad."),
]
Elements = Annotated[int, typer.Option("--elements", help="Solid elements along the free part of each piston.")]
Count = Annotated[int, typer.Option("--count", help="How many frequencies the deck asks for.")]
File = Annotated[
    Path | None, typer.Option("--out", metavar="FILE.inp", help="File to write; default: beside the study, FILE.inp.")
]
Force = Annotated[bool, typer.Option("--force", help="Replace the file if it exists.")]


def add(app: typer.Typer) -> None:
    """Give `app` the command."""
    app.command("export")(export)


@guarded
def export(
    file: StudyFile,
    format: Format = "abaqus",
    pose: Pose = None,
    elements: Elements = 20,
    count: Count = 24,
    out: File = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Write the robot with locked drives as a deck for Abaqus and CalculiX: sag under gravity, frequencies."""
    from flexapod import model
    from flexapod.app.terminal import print_json
    from flexapod.errors import InputError
    from flexapod.exchange.export import FORMATS, abaqus_deck
    from flexapod.files import replacing

    if format not in FORMATS:
        words = "abaqus, a deck that CalculiX reads as well"
        raise InputError("is not a format", key="--format", value=format, allowed=words)
    study = model.load(file)
    if isinstance(study, model.ActuatorStudy):
        raise InputError("is the study of a single actuator", file=file, allowed="the study of a robot")
    path = file.with_name(file.stem + ".inp") if out is None else out
    _check_file(path, force)
    title = f"{file.stem}: robot with locked drives"
    with as_options(elements="--elements", modes="--count", pose="--pose"):
        text = abaqus_deck(study, parse_pose(pose), elements=elements, modes=count, title=title)
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="ascii", errors="replace")
    if json:
        print_json({"file": path, "format": format, "elements": elements, "modes": count})
    else:
        _show(path, file, pose)


def _check_file(path: Path, force: bool) -> None:
    from flexapod.errors import InputError

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
    if path.exists() and not force:
        raise InputError("exists already", file=path, next_step="Choose another name, or replace it with --force")


def _show(path: Path, file: Path, pose: str | None) -> None:
    from flexapod.app.terminal import print_text

    at = f' --pose "{pose}"' if pose else ""
    print_text(f"Written: {path}")
    print_text(f"Run it with `ccx -i {path.with_suffix('')}` (CalculiX) or `abaqus job={path.stem}` (Abaqus).")
    print_text(f"Compare its frequencies and its sag with `flexapod modes {file}{at}`.")
    print_text("Bending of slender pistons lies parts in ten thousand lower: a solid has shear and rotary inertia.")
