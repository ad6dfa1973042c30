"""Options and arguments that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["Json", "Out", "Quiet", "StudyFile"]

StudyFile = Annotated[Path, typer.Argument(metavar="FILE", help="Study file (TOML); `flexapod new` writes one.")]
Json = Annotated[bool, typer.Option("--json", help="Print JSON on stdout and nothing else; errors as JSON on stderr.")]
Out = Annotated[
    Path | None, typer.Option("--out", metavar="DIR", help="Folder for the results; default: the file's name.")
]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="No progress bar.")]
