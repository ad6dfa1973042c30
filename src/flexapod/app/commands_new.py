"""`flexapod new`: a commented study file to edit."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from flexapod.app.failures import guarded
from flexapod.app.options import Json, as_options

__all__ = ["add"]

Name = Annotated[Path, typer.Argument(metavar="NAME.toml", help="File to write.")]
Preset = Annotated[
    str | None,
    typer.Option(
        "--preset",
        metavar="P",
        help="paper-robot (the default), paper-robot-radii, paper-actuator, tripod, flight-simulator, "
        "machine-hexapod, small-hexapod or nano-hexapod.",
    ),
]
From = Annotated[
    str | None,
    typer.Option(
        "--from",
        metavar='"home=300 mm, payload=20 kg, stroke=60 mm"',
        help="A first robot with sizes computed to fit; also base, platform (radii), diameter (of pistons), material, "
        "motion (surge to yaw), duration.",
    ),
]
Force = Annotated[bool, typer.Option("--force", help="Replace the file if it exists.")]


def add(app: typer.Typer) -> None:
    """Give `app` the command."""
    app.command("new")(new)


@guarded
def new(name: Name, preset: Preset = None, request: From = None, force: Force = False, json: Json = False) -> None:
    """Write a commented study file to edit."""
    from flexapod.app.terminal import print_json, print_text
    from flexapod.errors import InputError
    from flexapod.files import replacing

    path = name if name.suffix or name.is_dir() else name.with_suffix(".toml")
    if path.is_dir():
        raise InputError("is a folder", file=path, next_step="Give the name of a file")
    if path.exists() and not force:
        raise InputError("exists already", file=path, next_step="Choose another name, or replace it with --force")
    text, source, remarks = _first_robot(request, preset) if request is not None else _preset(preset or "paper-robot")
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
    if json:
        print_json({"file": path, **source, **({} if request is None else {"remarks": remarks})})
        return
    for line in remarks:
        print_text(line)
    words = f", from the preset {source['preset']}" if "preset" in source else ""
    print_text(f"{path} written{words}. Edit it, then: flexapod check {path}")


def _preset(name: str) -> tuple[str, dict[str, object], list[str]]:
    from flexapod.model import preset_text

    with as_options(preset="--preset"):
        return preset_text(name), {"preset": name}, []


def _first_robot(request: str, preset: str | None) -> tuple[str, dict[str, object], list[str]]:
    """Text of a first robot, what it is from, and what there is to say about it."""
    from flexapod.app.first_words import first_words
    from flexapod.errors import InputError
    from flexapod.study.first import first_robot, parse_request

    if preset is not None:
        raise InputError("is given together with --from", key="--preset", value=preset, allowed="one of the two")
    text = first_robot(parse_request(request))
    return text, {"from": request}, first_words(text)
