"""Files that a study names: where they are looked for, and tables that stand for them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

from flexapod.common.errors import InputError

#: Columns of a table, or parts of a linear system, by name: dimension (see `flexapod.common.units`) and values in SI
Content = Mapping[str, tuple[str, Any]]
LONGEST = 100  # letters of a name in a folder that is all there is


class UnreadableFile(InputError):
    """A file that cannot be read as a table, whatever is in it."""


@dataclass(frozen=True)
class Stored:
    """Table that stands for a file: the `name` that its key holds, "" of arrays given in Python, and its `content`."""

    name: str
    content: Content


@dataclass(frozen=True)
class NamedFiles:
    """Places of the files that a study names.

    Parameters
    ----------
    folder : Path
        Names are relative to it.
    closed : bool
        The folder is all there is: a name is that of a regular file in it, and leads nowhere else. An empty path is no
        folder then, and no file is there.
    stored : Mapping
        `Stored` in place of files, by the key that names them, ``leg[3].drive.file``: nothing is read for these.
    """

    folder: Path
    closed: bool = False
    stored: Mapping[str, Stored] = field(default_factory=lambda: MappingProxyType({}))

    def content(self, key: str, name: str) -> Content | None:
        """Content that stands for the file that a key names; None where it is to be read."""
        found = self.stored.get(key)
        return None if found is None or found.name != name else found.content

    def place(self, name: str) -> Path:
        """Place of a file.

        Raises
        ------
        Unreadable
            There is no name, or it leads out of a folder that is all there is.
        """
        path = self.folder / name
        if self.closed and not self._holds(name):
            raise UnreadableFile(
                "is a table that was not sent",
                allowed="the plain name of a table that was uploaded before; no other file is read",
                next_step="Upload the table first, then the study",
            )
        if not name:
            raise UnreadableFile(
                "names no file: its table was given in Python, and is not here",
                next_step="Take the study out of its results with `flexapod.load`, or write the table into a file",
            )
        return path

    def _holds(self, name: str) -> bool:
        """Tell whether a name is that of a regular file in the folder itself."""
        path = self.folder / name
        return self.folder != Path() and _is_plain(name) and not path.is_symlink() and path.is_file()


def _is_plain(name: str) -> bool:
    """Tell whether a name is that of a file in a folder, on any system."""
    return 0 < len(name) <= LONGEST and name.isprintable() and name[0] not in ".~" and not {*name} & {*'/\\:*?"<>|'}


def columns_of_table(columns: Mapping[str, str], along: Any, values: Any, first: str = "time") -> Content:
    """The content of a CSV file: its first column, and those of `values` (n, len(columns)), with their dimensions."""
    named = {name: (columns[name], values[:, i]) for i, name in enumerate(columns)}
    return {first: (first, along), **named}
