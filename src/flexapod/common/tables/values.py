"""Values of one table of a study file: numbers with units, choices, vectors; errors that say where."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import isfinite
from pathlib import Path
from typing import Any, Self, TypeVar

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError, Malformed, suggest_word
from flexapod.common.tables.axes import plane_order
from flexapod.common.tables.columns import Kind
from flexapod.common.tables.field_help import Notes
from flexapod.common.tables.named_files import NamedFiles
from flexapod.common.tables.reference import advice, example_line
from flexapod.common.tables.table import Table
from flexapod.common.tables.toml import SourceTable
from flexapod.common.units import to_si

M = TypeVar("M", bound=Table)


class Values:
    """Reader of one TOML table.

    Parameters
    ----------
    data : object
        What the file holds under `path`.
    path : str
        Key path, e.g. ``leg.piston``; empty for the whole file.
    file : str, optional
        File name for messages.
    files : Path or NamedFiles
        Where the files are that the study names: a folder, or more.
    notes : Notes, optional
        Takes down what is asked.
    plane : {"xy", "yz", "zx"}, optional
        Vectors may have two numbers, along the axes of this plane.
    leg : tuple of int
        Number of the leg whose table it is, of how many.
    """

    def __init__(
        self,
        data: object,
        path: str,
        file: str | None,
        files: Path | NamedFiles,
        notes: Notes | None = None,
        plane: str | None = None,
        leg: tuple[int, int] = (1, 1),
    ) -> None:
        self.path: str = path
        self.file: str | None = file
        self.files: NamedFiles = files if isinstance(files, NamedFiles) else NamedFiles(files)
        self.notes: Notes | None = notes
        self.plane: str | None = plane
        self.leg: tuple[int, int] = leg
        if not isinstance(data, Mapping):
            table, _, name = path.rpartition(".")
            raise Malformed(
                "is not a table",
                file=file,
                key=path,
                value=data,
                allowed="[section] or { key = value }",
                next_step=_such_as(table, name),
            )
        self.data: Mapping[str, Any] = data

    @property
    def source_table(self) -> SourceTable:
        """The table, for the object that is read from it."""
        return SourceTable(self.data)

    def key(self, name: str) -> str:
        """Full key path of `name` in this section."""
        return f"{self.path}.{name}" if self.path else name

    def error(self, what: str, name: str, *, allowed: str | None = None, next_step: str | None = None) -> InputError:
        """An error about the value of `name`."""
        return InputError(
            what, file=self.file, key=self.key(name), value=self.data.get(name), allowed=allowed, next_step=next_step
        )

    def malformed_error(
        self, what: str, name: str, *, allowed: str | None = None, next_step: str | None = None
    ) -> Malformed:
        """An error about the value of `name` that no study file may have."""
        return Malformed(
            what, file=self.file, key=self.key(name), value=self.data.get(name), allowed=allowed, next_step=next_step
        )

    def check_keys(self, *names: str) -> None:
        """Refuse every key that is not in `names`."""
        if self.notes is not None:
            self.notes.allow(self.path, names)
        for name in self.data:
            if name not in names:
                raise Malformed(
                    "unknown key",
                    file=self.file,
                    key=self.key(name),
                    allowed=", ".join(names),
                    next_step=advice(self.path, name, names, self.data),
                )

    def accept_any_keys(self) -> None:
        """Take every key: they are names."""
        self.check_keys(*self.data)
        if self.notes is not None:
            self.notes.named.add(self.path)

    def require_keys(self, *names: str) -> None:
        """Refuse a section without these keys."""
        for name in names:
            if name not in self.data:
                raise InputError("is missing", file=self.file, key=self.key(name), next_step=self._add(name))

    def __contains__(self, name: str) -> bool:
        return name in self.data

    def number(self, name: str, dimension: str) -> float | None:
        """Value in SI, or None if absent."""
        self._note(name, "number", (dimension,))
        return None if name not in self.data else self._si(self.data[name], dimension, self.key(name))

    def integer(self, name: str) -> int | None:
        """A whole number, or None if absent."""
        self._note(name, "whole", ("number",))
        value = self.data.get(name)
        if value is None or (isinstance(value, int) and not isinstance(value, bool)):
            return value
        raise self.malformed_error("is not a whole number", name)

    def flag(self, name: str) -> bool | None:
        """True or false, or None if absent."""
        self._note(name, "flag")
        value = self.data.get(name)
        if value is None or isinstance(value, bool):
            return value
        raise self.malformed_error("is neither true nor false", name, allowed="true, false")

    def words(self, name: str, allowed: tuple[str, ...]) -> tuple[str, ...] | None:
        """A list of texts, each one of `allowed`, or None if absent."""
        self._note(name, "words", choices=allowed)
        value = self.data.get(name)
        if value is None:
            return None
        if not isinstance(value, list) or any(word not in allowed for word in value):
            raise self.malformed_error("is not a list of these words", name, allowed=", ".join(allowed))
        return tuple(value)

    def text(self, name: str, allowed: tuple[str, ...] | None = None) -> str | None:
        """A text, one of `allowed` if given, or None if absent."""
        self._note(name, "text", choices=allowed)
        value = self.data.get(name)
        if value is None:
            return None
        words = ", ".join(allowed) if allowed else "a text in quotes"
        if not isinstance(value, str):
            raise self.malformed_error("is not a text", name, allowed=words)
        if allowed and value not in allowed:
            raise self.malformed_error("is not known", name, allowed=words, next_step=suggest_word(value, allowed))
        return value

    def vector(self, name: str, *dimensions: str) -> list[float] | None:
        """Numbers in SI, as many as `dimensions`, or None if absent."""
        value = self.data.get(name)
        self._note(name, "vector", self._in_plane(value, dimensions))
        return None if value is None else self._vector(value, dimensions, self.key(name))

    def rows(self, name: str, *rows: tuple[str, ...]) -> list[list[float]]:
        """Rows of numbers in SI, of these dimensions."""
        value = self.data.get(name)
        first = value[0] if isinstance(value, list) and value else None
        self._note(name, "rows", self._in_plane(first, rows[0]))
        if not isinstance(value, list) or len(value) != len(rows):
            raise self.malformed_error(
                f"is not a list of {len(rows)} rows", name, allowed=f"{len(rows)} rows of {len(rows[0])} numbers"
            )
        places = enumerate(zip(value, rows, strict=True), start=1)
        return [self._vector(row, dimensions, f"{self.key(name)}[{i}]") for i, (row, dimensions) in places]

    def matrix(self, name: str, along: str, mixed: str = "", about: str = "") -> list[list[float]] | Array | None:
        """A matrix by its diagonal or by its rows, None if absent: (6, 6), of one dimension (3, 3)."""
        value, three = self.data.get(name), (along,) * 3
        if isinstance(value, list) and any(isinstance(row, list) for row in value):
            halves = (three + (mixed,) * 3, (mixed,) * 3 + (about,) * 3) if mixed else (three,)
            return self.rows(name, *(row for row in halves for _ in range(3)))
        diagonal = self.vector(name, *three, *(about,) * 3 * bool(about))
        return None if diagonal is None else np.diag(diagonal)

    def section(self, name: str) -> Self | None:
        """The table under `name`, or None if absent."""
        return None if name not in self.data else self.child(self.data[name], name)

    def child(self, data: object, name: str) -> Self:
        """A section for `data` found under `name`."""
        return type(self)(data, self.key(name), self.file, self.files, self.notes, self.plane, self.leg)

    def build(self, model: Callable[..., M], /, **fields: object) -> M:
        """A model from this section's values; absent ones (None) take the model's default."""
        given = {name: value for name, value in fields.items() if value is not None}
        if self.notes is not None:
            self.notes.fill(self.path, model, given)
        try:
            built = model(**given)
        except InputError as error:
            raise self.locate(error) from None
        if self.notes is not None:
            self.notes.record_defaults(self.path, built)
        return built

    def locate(self, error: InputError) -> InputError:
        """The error with this section's path and file, and the value as the user wrote it."""
        if error.key is not None and error.key in self.data:
            error.value = self.data[error.key]
        if error.what == "is missing" and error.key:
            error.next_step = self._add(error.key)
        return error.with_location(file=self.file, prefix=self.path)

    def _add(self, name: str) -> str:
        line = example_line(self.path, name, self.data)
        return f"Add {self.key(name)}" + (f", for example: {line}" if line else "")

    def _note(
        self, name: str, kind: Kind, dimensions: tuple[str, ...] = (), choices: tuple[str, ...] | None = None
    ) -> None:
        if self.notes is not None:
            self.notes.ask(self.key(name), kind, dimensions, choices, self.data.get(name))

    def _in_plane(self, value: object, dimensions: tuple[str, ...]) -> tuple[str, ...]:
        """Dimensions of a vector as it is written: of two numbers in the plane of a planar robot."""
        short = self.plane is not None and isinstance(value, list) and len(value) == 2 and len(dimensions) == 3
        return dimensions[:2] if short else dimensions

    def _vector(self, value: object, dimensions: tuple[str, ...], key: str) -> list[float]:
        written = self._in_plane(value, dimensions)
        if not isinstance(value, list) or len(value) != len(written):
            raise Malformed(
                "is not a vector",
                file=self.file,
                key=key,
                value=value,
                allowed=f"{len(dimensions)} numbers" + (f", or two in the plane {self.plane}" if self.plane else ""),
                next_step=_such_as(self.path, key.rpartition(".")[2], self.data),
            )
        numbers = [
            self._si(item, dimension, f"{key}[{i}]")
            for i, (item, dimension) in enumerate(zip(value, written, strict=True), start=1)
        ]
        if len(written) == len(dimensions):
            return numbers
        found = [0.0] * 3
        for axis, number in zip(plane_order(self.plane)[:2], numbers, strict=True):
            found[axis] = number
        return found

    def _si(self, value: object, dimension: str, key: str) -> float:
        if isinstance(value, float) and isfinite(value):
            return float(value)
        try:
            return to_si(value, dimension, key=key)
        except InputError as error:
            raise Malformed(
                error.what, file=self.file, key=key, value=error.value, allowed=error.allowed, next_step=error.next_step
            ) from None


def _such_as(table: str, name: str, like: Mapping[str, Any] | None = None) -> str | None:
    line = example_line(table, name, like)
    return f"For example: {line}" if line else None
