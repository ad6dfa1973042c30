"""Options and arguments that several commands share."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from flexapod.errors import InputError

__all__ = ["Json", "NoFigures", "Out", "Quiet", "StudyFile", "as_options"]

StudyFile = Annotated[Path, typer.Argument(metavar="FILE", help="Study file (TOML); `flexapod new` writes one.")]
Json = Annotated[bool, typer.Option("--json", help="Print JSON on stdout and nothing else; errors as JSON on stderr.")]
Out = Annotated[
    Path | None,
    typer.Option("--out", metavar="DIR", help="Folder for the results; default: beside the study, FILE-COMMAND."),
]
NoFigures = Annotated[bool, typer.Option("--no-figures", help="Draw nothing: data and words only, in less time.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No progress bar.")]

_PARTS = ("what", "file", "value", "allowed", "next_step")


@contextmanager
def as_options(**options: str) -> Iterator[None]:
    """Let errors name a keyword of a Python call as the option that the user typed: ``as_options(modes="--count")``."""
    try:
        yield
    except InputError as error:
        key = options.get(error.key or "", error.key)
        raise InputError(**{name: getattr(error, name) for name in _PARTS}, key=key) from None
