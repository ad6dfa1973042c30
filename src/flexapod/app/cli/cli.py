"""The command `flexapod`: each command lives in a module that is imported, and imports what it needs, when it runs."""

from __future__ import annotations

import gc
import io
import os
import sys
from collections.abc import Iterable, Sequence
from contextlib import suppress
from importlib import import_module
from typing import TYPE_CHECKING, Annotated, Any, TextIO

import typer
from typer.core import TyperGroup

from flexapod.app.cli.failures import INTERRUPTED, install_signal_handlers, print_parts, report_output_error, stop_code
from flexapod.common.version import __version__

if TYPE_CHECKING:
    app: typer.Typer

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


def _version(wanted: bool) -> None:
    if wanted:
        print(f"flexapod {__version__}")
        raise typer.Exit


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


#: Commands in the order of the help, and the modules that they live in.
HOMES = {
    "replicate": "proof",
    "new": "study",
    "keys": "study",
    "check": "study",
    "run": "run",
    "actuator": "run",
    "modes": "poses",
    "frf": "linear",
    "damp": "linear",
    "budget": "poses",
    "map": "map",
    "sensitivity": "design",
    "optimise": "design",
    "converge": "surveys",
    "sweep": "surveys",
    "verify": "proof",
    "export": "export",
    "cache": "run",
    "view": "view",
}
_FUNCTIONS = {"map": "workspace_map"}  # where they are not named after the command


def program(names: Iterable[str] = HOMES) -> typer.Typer:
    """The command with these commands of its own; the modules of others are not imported."""
    made = typer.Typer(
        name="flexapod",
        cls=_Commands,
        add_completion=False,
        no_args_is_help=True,
        pretty_exceptions_enable=False,
        rich_markup_mode="rich",
        epilog="Exit codes: 0 done, 1 a computation failed, 2 bad input, 130 stopped by Ctrl-C, 143 by SIGTERM.",
    )
    made.callback()(flexapod)
    for name in names:
        home = import_module(f"flexapod.app.cli.commands_{HOMES[name]}")
        made.command(name)(getattr(home, _FUNCTIONS.get(name, name)))
    return made


def __getattr__(name: str) -> typer.Typer:
    """`app`: the command with all of its commands."""
    if name != "app":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = program()
    return globals()[name]


def _asked_for() -> Iterable[str]:
    """The command that the words of this process begin with; all where they begin otherwise, as for their help."""
    return sys.argv[1:2] if sys.argv[1:2] and sys.argv[1] in HOMES else HOMES


def main() -> None:
    """Entry point of the command."""
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # it would look for some in all packages that are here
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # our matrices are small: threads only cost, a factor of six
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without the letter µ shows ? and goes on
    install_signal_handlers()
    gc.set_threshold(20_000)  # a search for each 700 new objects takes a tenth of the time that figures need
    try:
        code = _whole()
    except OSError as error:
        report_output_error(error)
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
        program(_asked_for())()
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
    """Give up what could not be written to a stream, so that the end of the process does not try again."""
    with suppress(OSError, ValueError):
        nothing = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, stream.fileno())
        os.close(nothing)
