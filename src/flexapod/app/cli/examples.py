"""The examples of the gallery, and the notebooks: files that `flexapod new --example` writes and `--list` names."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from flexapod.common.errors import InputError, closest

_FOLDERS = {"--example": "examples/gallery", "--notebook": "examples/notebooks"}


def titles(option: str) -> dict[str, str]:
    """Title of each example, or of each notebook, by name."""
    found = {x.name.removesuffix(".py"): x for x in files("flexapod").joinpath(_FOLDERS[option]).iterdir()}
    return {name: _title(x.read_text(encoding="utf-8")) for name, x in sorted(found.items()) if x.name.endswith(".py")}


def text(option: str, name: str) -> str:
    """The file of an example.

    Raises
    ------
    InputError
        A name that is not known.
    """
    known = titles(option)
    if name not in known:
        next_step = closest(name, known) or "flexapod new --list names them"
        raise InputError("is not known", key=option, value=name, allowed=", ".join(known), next_step=next_step)
    return files("flexapod").joinpath(_FOLDERS[option], f"{name}.py").read_text(encoding="utf-8")


def place(option: str, name: str, given: Path | None) -> Path:
    """Where an example is written: NAME.py here, unless another place is given."""
    if given is not None and (given.is_dir() or given.suffix not in ("", ".py")):
        words = "is a folder" if given.is_dir() else "is no name of a Python file"
        raise InputError(words, file=given, allowed="FILE.py", next_step=f"{option} {name} alone writes {name}.py")
    return (given or Path(name)).with_suffix(".py")


def _title(written: str) -> str:
    """The first line of words: of an example its heading, of a notebook that of its first cell."""
    lines = (line for line in written.splitlines() if not line.startswith(("# %%", "# ---", "# jupyter:", "#   ")))
    words = (line.removeprefix('r"""').strip('"# ') for line in lines)
    return next(line for line in words if line)
