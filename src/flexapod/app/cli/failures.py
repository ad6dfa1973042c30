"""Errors and signals of commands: text or JSON on stderr, and an exit code; a traceback only if it is asked for."""

from __future__ import annotations

import errno
import functools
import json as _json
import logging
import os
import re
import signal
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import NoReturn, ParamSpec

import typer

from flexapod.common.errors import FlexapodError, InputError
from flexapod.common.version import __version__
from flexapod.output.text.parts import error_lines, error_parts

_received: list[int] = []


def install_signal_handlers() -> None:
    """Make SIGTERM and SIGHUP raise KeyboardInterrupt; one that is ignored, as after nohup, stays so."""
    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, _stop)


def _stop(number: int, _: FrameType | None) -> NoReturn:
    _received.append(number)
    raise KeyboardInterrupt


def stop_words() -> str:
    """Text on what stops the command: a signal, or Ctrl-C."""
    return f"stopped by {signal.Signals(_received[0]).name if _received else 'Ctrl-C'}"


def stop_code(usual: int) -> int:
    """The exit code that shells give to a process ended by the signal that came, else the `usual` one."""
    return 128 + _received[0] if _received else usual


P = ParamSpec("P")
INTERRUPTED = 130
#: What says that there is no more room for what is written, wherever it goes.
_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)
#: Tables of study files: what is below one of them stands in the file that the command was given.
_TABLES = {
    "robot", "payload", "leg", "motion", "simulation", "load", "initial", "geometry", "heat", "tolerances",
    "disturbance", "control", "requirement", "actuator",
}  # fmt: skip


def report_failures(command: Callable[P, None]) -> Callable[P, None]:
    """Turn what a command raises into a message on stderr and an exit code; its ``json`` argument says in which form.

    2: bad input; 1: a failed computation, or a fault of ours; 130: stopped by Ctrl-C.
    """

    @functools.wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> None:
        as_json = bool(kwargs.get("json", False))
        try:
            with _warnings(as_json=as_json, quiet=bool(kwargs.get("quiet", False))):
                command(*args, **kwargs)
        except (typer.Exit, typer.Abort, BrokenPipeError):
            raise
        except FlexapodError as error:
            _trace()
            print_error(_placed(error, kwargs), as_json=as_json)
            raise typer.Exit(error.exit_code) from None
        except (KeyboardInterrupt, Exception) as error:
            _trace()
            parts, code = (
                ({"kind": "interrupt", "what": f"{stop_words()}; files already written are whole"}, INTERRUPTED)
                if _by_ctrl_c(error)
                else (_no_room(error) or _fault(error), 1)
            )
            print_parts(parts, code, as_json=as_json)
            raise typer.Exit(code) from None

    return run


def _placed(error: FlexapodError, given: Mapping[str, object]) -> FlexapodError:
    """The error with the command's study file, where its key is one of that file and no file is named."""
    file = given.get("file")
    if not isinstance(error, InputError) or error.file or not isinstance(file, Path) or "sweep_file" in given:
        return error
    return error.with_location(file=file) if re.split(r"[.\[]", error.key or "")[0] in _TABLES else error


def print_error(error: FlexapodError, *, as_json: bool) -> None:
    """An error on stderr: a line each for file, key, value, what is allowed and the next step; or one JSON object."""
    print_parts(error_parts(error), error.exit_code, as_json=as_json)


@contextmanager
def _warnings(*, as_json: bool, quiet: bool) -> Iterator[None]:
    """Warnings of the package on stderr, in the form of the errors; and, in words only, what takes its time."""
    handler, logger = _Warnings(as_json), logging.getLogger("flexapod")
    level = logger.level
    logger.addHandler(handler)
    logger.setLevel(logging.WARNING if as_json or quiet else logging.INFO)
    try:
        yield
    finally:
        logger.setLevel(level)
        logger.removeHandler(handler)


class _Warnings(logging.Handler):
    def __init__(self, as_json: bool) -> None:
        super().__init__()
        self.as_json = as_json

    def emit(self, record: logging.LogRecord) -> None:
        if record.module == "attributes":
            return  # the command says itself that a result is partial
        text = record.getMessage()
        words = f"{text} ..." if record.levelno < logging.WARNING else f"Warning: {text}"
        print(_json.dumps({"warning": text}) if self.as_json else words, file=sys.stderr)


def print_parts(parts: Mapping[str, str | None], exit_code: int, *, as_json: bool) -> None:
    """Print `kind`, `what`, `file`, `key`, `value`, `allowed`, `next_step`, where given, on stderr."""
    if as_json:
        text = _json.dumps({"error": {**parts, "exit_code": exit_code}}, ensure_ascii=False)
    else:
        text = "\n".join(error_lines(parts))
    with suppress(OSError):  # where stderr takes no more, the exit code says it
        print(text, file=sys.stderr, flush=True)


def _by_ctrl_c(error: BaseException | None) -> bool:
    """Test whether Ctrl-C is at the root of an error: a library may turn it into one of its own."""
    while error is not None:
        if isinstance(error, KeyboardInterrupt) or KeyboardInterrupt.__name__ in str(error):
            return True
        error = error.__cause__ or error.__context__
    return False


def _no_room(error: BaseException) -> dict[str, str | None] | None:
    """A disk or a terminal that takes no more, in words; None for other errors."""
    if not isinstance(error, OSError) or error.errno not in _FULL:
        return None
    what = f"{error.filename or 'the output'} cannot be written: {error.strerror}"
    return {"kind": "computation", "what": what, "next_step": "Make space, or write to another place"}


def report_output_error(error: OSError) -> None:
    """Say on stderr that stdout takes no more; who has closed it wants nothing said."""
    if not isinstance(error, BrokenPipeError):
        print_parts(_no_room(error) or _fault(error), 1, as_json=False)


def _fault(error: BaseException) -> dict[str, str | None]:
    return {
        "kind": "fault",
        "what": f"unexpected {type(error).__name__}: {error} (flexapod {__version__})",
        "next_step": "This is a fault of flexapod, not yours. Please report it with your file and what the same "
        "command prints with FLEXAPOD_DEBUG=1",
    }


def _trace() -> None:
    """Print where the error being handled arose, if asked for."""
    if os.environ.get("FLEXAPOD_DEBUG", "") not in ("", "0"):
        traceback.print_exc()
