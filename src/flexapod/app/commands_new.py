"""`flexapod new`: a commented study file to edit."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from flexapod.app.failures import guarded
from flexapod.app.options import Json, as_options

__all__ = ["add"]

Name = Annotated[Path, typer.Argument(metavar="NAME.toml", help="File to write.")]
Preset = Annotated[str, typer.Option("--preset", metavar="P", help="paper-robot, paper-robot-radii or paper-actuator.")]
Force = Annotated[bool, typer.Option("--force", help="Replace the file if it exists.")]


def add(app: typer.Typer) -> None:
    """Give `app` the command."""
    app.command("new")(new)


@guarded
def new(name: Name, preset: Preset = "paper-robot", force: Force = False, json: Json = False) -> None:
    """Write a commented study file to edit."""
    from flexapod.app.terminal import print_json, print_text
    from flexapod.errors import InputError
    from flexapod.model import preset_text
    from flexapod.study.store import replacing

    with as_options(preset="--preset"):
        text = preset_text(preset)
    path = name if name.suffix else name.with_suffix(".toml")
    if path.is_dir():
        raise InputError("is a folder", file=path, next_step="Give the name of a file")
    if path.exists() and not force:
        raise InputError("exists already", file=path, next_step="Choose another name, or replace it with --force")
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
    if json:
        print_json({"file": path, "preset": preset})
    else:
        print_text(f"{path} written, from the preset {preset}. Edit it, then: flexapod check {path}")
