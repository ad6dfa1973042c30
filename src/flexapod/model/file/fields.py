"""The numbers and choices of a study file, as they are read: key, dimension, choices, bounds."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from flexapod.common.errors import InputError
from flexapod.common.tables.field_help import NotedField, Notes
from flexapod.common.tables.named_files import NamedFiles
from flexapod.common.tables.section import Section
from flexapod.model.file.files import read_study


def read_fields(text: str, path: str | Path | None, files: NamedFiles | None = None) -> list[NotedField]:
    """Fields of a study text in the order of reading, absent optional ones included.

    A text that is refused gives the fields up to the refusal; one that is not TOML gives none.

    Parameters
    ----------
    text : str
        The study file.
    path : path or None
        Where it was read; tables it names are found relative to its folder.
    files : NamedFiles, optional
        Those that it may name, in place of all that its path leads to.
    """
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        return []
    notes, _ = read_notes(data, files or (Path(path).parent if path else Path()))
    return list(notes.fields.values())


def read_notes(data: Mapping[str, Any], files: Path | NamedFiles) -> tuple[Notes, InputError | None]:
    """Notes on what is asked of a study's tables, and why they are refused, if they are."""
    notes = Notes()
    try:
        read_study(Section(data, "", None, files, notes), "-")
    except InputError as error:
        return notes, error
    return notes, None
