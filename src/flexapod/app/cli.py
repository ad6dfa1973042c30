"""The command `flexapod`: each command lives in its own module and imports what it needs when it runs."""

from __future__ import annotations

import io
import os
import sys
from typing import Annotated

import typer

from flexapod import __version__
from flexapod.app import (
    commands_cache,
    commands_check,
    commands_converge,
    commands_export,
    commands_later,
    commands_modes,
    commands_new,
    commands_replicate,
    commands_run,
    commands_verify,
)

__all__ = ["app", "main"]

app = typer.Typer(
    name="flexapod",
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    epilog="Exit codes: 0 done, 1 a computation failed, 2 bad input, 130 stopped by Ctrl-C. "
    "Later releases bring sweep and view.",
)


def _version(wanted: bool) -> None:
    if wanted:
        print(f"flexapod {__version__}")
        raise typer.Exit


@app.callback()
def flexapod(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and stop.")
    ] = False,
    debug: Annotated[
        bool, typer.Option("--debug", help="Show where in the code an error arose (also FLEXAPOD_DEBUG=1).")
    ] = False,
) -> None:
    """How far a parallel robot's payload misses its path because the legs bend, stretch and vibrate, and why."""
    if debug:
        os.environ["FLEXAPOD_DEBUG"] = "1"


for part in (
    commands_replicate,
    commands_new,
    commands_check,
    commands_run,
    commands_modes,
    commands_converge,
    commands_verify,
    commands_export,
    commands_cache,
    commands_later,
):
    part.add(app)


def main() -> None:
    """Entry point of the command."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # our matrices are small: threads only cost, a factor of six
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without the letter µ shows ? and goes on
    app()
