"""The command `flexapod`: each command lives in its own module and imports what it needs when it runs."""

from __future__ import annotations

import gc
import io
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from typing import Annotated, Any, TextIO

import typer
from typer.core import TyperGroup

from flexapod.cli.commands_budget import budget
from flexapod.cli.commands_export import export
from flexapod.cli.commands_linear import damp, frf
from flexapod.cli.commands_map import workspace_map
from flexapod.cli.commands_poses import modes
from flexapod.cli.commands_proof import replicate, verify
from flexapod.cli.commands_run import actuator, cache, run
from flexapod.cli.commands_study import check, keys, new
from flexapod.cli.commands_surveys import converge, sweep
from flexapod.cli.commands_view import view
from flexapod.cli.failures import INTERRUPTED, heed_signals, print_parts, say_full, stop_code
from flexapod.version import __version__

_USAGE: Any = typer.BadParameter.__mro__[1]  # its base, click's UsageError, of which typer may have a copy of its own


class _Commands(TyperGroup):
    """The commands; where JSON is asked for, what is wrong with the command line is told in JSON as well."""

    def main(
        self,
        args: Sequence[str] | None = None,
        prog_name: str | None = None,
        complete_var: str | None = None,
        standalone_mode: bool = True,
        windows_expand_args: bool = True,
        **extra: Any,
    ) -> Any:
        words = list(sys.argv[1:] if args is None else args)
        as_json = standalone_mode and "--json" in words
        try:
            code = super().main(
                args, prog_name, complete_var, standalone_mode and not as_json, windows_expand_args, **extra
            )
        except _USAGE as error:
            if not as_json:
                raise
            help_words = f"`{error.ctx.command_path if error.ctx else 'flexapod'} --help` lists what there is"
            parts = {"kind": "input", "what": error.format_message(), "next_step": help_words}
            print_parts(parts, error.exit_code, as_json=True)
            sys.exit(error.exit_code)
        if as_json:
            sys.exit(code or 0)
        return code


app: typer.Typer = typer.Typer(
    name="flexapod",
    cls=_Commands,
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    epilog="Exit codes: 0 done, 1 a computation failed, 2 bad input, 130 stopped by Ctrl-C, 143 by SIGTERM.",
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


_ALL = (
    replicate,
    new,
    keys,
    check,
    run,
    actuator,
    modes,
    frf,
    damp,
    budget,
    workspace_map,
    converge,
    sweep,
    verify,
    export,
    cache,
    view,
)
for _command in _ALL:
    app.command("map" if _command is workspace_map else None)(_command)


def main() -> None:
    """Entry point of the command."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # our matrices are small: threads only cost, a factor of six
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without the letter µ shows ? and goes on
    heed_signals()
    gc.set_threshold(20_000)  # a search for each 700 new objects takes a tenth of the time that figures need
    try:
        code = _whole()
    except OSError as error:
        say_full(error)
        _let_go(sys.stdout)
        code = 1
    try:
        _flushed(sys.stderr)
    except OSError:  # the exit code says it
        _let_go(sys.stderr)
    sys.exit(stop_code(code) if code == INTERRUPTED else code)


def _whole() -> int:
    """Run the command, and wait until what it says is out; its exit code."""
    try:
        app()
    except SystemExit as end:
        code = end.code
    except KeyboardInterrupt:  # before the command itself began
        code = INTERRUPTED
    else:
        code = 0
    _flushed(sys.stdout)
    return code if isinstance(code, int) else int(code is not None)


def _flushed(stream: TextIO | None) -> None:
    if stream is not None:
        stream.flush()


def _let_go(stream: TextIO) -> None:
    """What could not be written is given up, so that the end of the process does not try again."""
    with suppress(OSError, ValueError):
        nothing = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, stream.fileno())
        os.close(nothing)
