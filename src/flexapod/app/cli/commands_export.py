"""The command `export`: a study as a file for other programs."""

from __future__ import annotations

import re
import string
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.app.cli.failures import report_failures
from flexapod.app.cli.options import (
    Force,
    Json,
    Pose,
    StudyFile,
    as_options,
    check_writable,
    refuse_existing,
    robot_study,
)
from flexapod.common.errors import InputError
from flexapod.common.lazy_imports import LazyModule
from flexapod.output.text.parts import Bullets
from flexapod.output.text.terminal import print_answer

if TYPE_CHECKING:
    from flexapod.app.cli import pose_options
    from flexapod.common import units
    from flexapod.output.exchange import formats, pose_deck
    from flexapod.output.exchange.formats import Exported
else:
    pose_options = LazyModule("flexapod.app.cli.pose_options")
    units = LazyModule("flexapod.common.units")
    formats = LazyModule("flexapod.output.exchange.formats")
    pose_deck = LazyModule("flexapod.output.exchange.pose_deck")

OPTIONS = {"modes": "--count"} | {
    name: f"--{name}"
    for name in ("format", "out", "pose", "elements", "fidelity", "magnify", "commands", "step", "inputs", "outputs")
}
FEW = 4  # files that are named one by one
COMMA = re.compile(r",(?![^(\[]*[)\]])")  # none of a place, (0, 0, 0.1), or of a sensor's numbers
NAMES = frozenset(string.ascii_letters + string.digits + "-_")

Kind = Annotated[
    str,
    typer.Option(
        "--format", metavar="FORMAT", help="abaqus, which CalculiX reads as well; fmu, c, mjcf, gltf, vtk, mat."
    ),
]
Elements = Annotated[
    int | None,
    typer.Option("--elements", help="abaqus: solid elements along the free part of each piston; default: 20."),
]
Wanted = Annotated[int | None, typer.Option("--count", help="abaqus: how many frequencies are asked for; default: 24.")]
Fidelity = Annotated[
    str | None,
    typer.Option("--fidelity", metavar="NAME", help="mjcf: in place of the study's; rigid: nothing gives way."),
]
Magnify = Annotated[float | None, typer.Option("--magnify", metavar="FACTOR", help="gltf: factor on deflections.")]
Commands = Annotated[
    str | None,
    typer.Option(
        "--commands", metavar="KIND", help="fmu, c: inputs, commands of the drives come from outside, or motion."
    ),
]
Step = Annotated[
    str | None,
    typer.Option("--step", metavar="TIME", help="fmu, c: length of the fixed steps, 0.2ms; without unit in s."),
]
Inputs = Annotated[
    str | None, typer.Option("--inputs", metavar="NAMES", help="mat: channels with commas, wrench,command,floor.")
]
Outputs = Annotated[
    str | None, typer.Option("--outputs", metavar="NAMES", help="mat: channels with commas, tool,stroke,drive-force.")
]
Place = Annotated[
    Path | None,
    typer.Option("--out", metavar="FILE", help="File or folder to write; default: beside the study, named after it."),
]


@report_failures
def export(
    file: StudyFile,
    format: Kind = "abaqus",
    pose: Pose = None,
    elements: Elements = None,
    count: Wanted = None,
    fidelity: Fidelity = None,
    magnify: Magnify = None,
    commands: Commands = None,
    step: Step = None,
    inputs: Inputs = None,
    outputs: Outputs = None,
    out: Place = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Write the robot for other programs: a deck, a unit that runs, a model, its motion to look at, matrices."""
    given: dict[str, object] = {
        "pose": pose_options.parse_pose(pose),
        "elements": elements,
        "modes": count,
        "fidelity": fidelity,
        "magnify": magnify,
        "commands": commands,
        "step": None if step is None else units.quantity(step, "time", key="--step"),
    }
    channels = {"inputs": inputs, "outputs": outputs}
    given |= {name: [x.strip() for x in COMMA.split(text)] for name, text in channels.items() if text is not None}
    given = {name: value for name, value in given.items() if value is not None}
    with as_options(**OPTIONS):
        kind = formats.format_of(format)
        formats.check_options(format, given)
        study = robot_study(file)
        path = file.with_name(file.stem + (*kind.endings, "")[0]) if out is None else out
        formats.check_place(format, path)
        if format == "abaqus":
            _check_name(path)
        refuse_existing(path, force)
        check_writable(path.parent if kind.endings else path)
        if "title" in formats.FORMATS[format].options:
            given["title"] = f"{file.stem}: robot with locked drives"
        found = formats.write_format(study, format, path, given)
    print_answer(_words(file, pose, format, found), lambda: _as_dict(format, found, elements, count), json=json)


def _words(file: Path, pose: str | None, format: str, found: Exported) -> Sequence[str | Bullets]:
    path, at = found.path, f' --pose "{pose}"' if pose else ""
    if format == "abaqus":
        return [
            f"Written: {path}",
            f"Run it with `ccx -i {path.with_suffix('')}` (CalculiX) or `abaqus job={path.stem}` (Abaqus).",
            f"Compare its frequencies and its sag with `flexapod modes {file}{at}`.",
            "Bending of slender pistons lies parts in ten thousand lower: a solid has shear and rotary inertia.",
        ]
    left = [f"Left out: {'; '.join(found.left_out)}."] if found.left_out else []
    return [*_written(found), *found.remarks, *left]


def _written(found: Exported) -> list[str]:
    """Lines on an export: each of a few files, of many the one that names the others and how many there are."""
    if len(found.files) <= FEW:
        return [f"Written: {path}" for path in found.files]
    others = [path for path in found.files if path != found.path]
    kinds = " and ".join(sorted({path.suffix[1:].upper() for path in others}))
    folders = ", ".join(sorted({str(path.parent) for path in others}))
    return [f"Written: {found.path}, and in {folders}: {len(others)} files ({kinds})."]


def _as_dict(format: str, found: Exported, elements: int | None, count: int | None) -> dict[str, object]:
    if format == "abaqus":
        return {
            "file": found.path,
            "format": format,
            "elements": elements or pose_deck.ELEMENTS,
            "modes": count or pose_deck.MODES,
        }
    return {"file": found.path, "format": format, "files": list(found.files), "left_out": list(found.left_out)}


def _check_name(path: Path) -> None:
    if not set(path.stem) <= NAMES:
        raise InputError(
            "has a name that CalculiX or Abaqus do not read",
            key="--out",
            value=path.name,
            allowed="letters without accents, digits, - and _",
            next_step="Name the deck with --out NAME.inp",
        )
