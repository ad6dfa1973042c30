"""One table of a study file, with its key path: numbers with units, choices, errors that say where."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from flexapod.errors import InputError, closest
from flexapod.model.base import Frozen
from flexapod.model.reference import advice, example_line
from flexapod.units import to_si

__all__ = ["Section"]

M = TypeVar("M", bound=Frozen)


class Section:
    """Reader of one TOML table.

    Parameters
    ----------
    data : object
        What the file holds under `path`.
    path : str
        Key path, e.g. ``leg.piston``; empty for the whole file.
    file : str, optional
        File name for messages.
    folder : Path
        Files named in the study are relative to it.
    """

    def __init__(self, data: object, path: str, file: str | None, folder: Path) -> None:
        self.path, self.file, self.folder = path, file, folder
        if not isinstance(data, Mapping):
            table, _, name = path.rpartition(".")
            raise InputError(
                "is not a table",
                file=file,
                key=path,
                value=data,
                allowed="[section] or { key = value }",
                next_step=_such_as(table, name),
            )
        self.data: Mapping[str, Any] = data

    def key(self, name: str) -> str:
        """Full key path of `name` in this section."""
        return f"{self.path}.{name}" if self.path else name

    def error(self, what: str, name: str, *, allowed: str | None = None, next_step: str | None = None) -> InputError:
        """An error about the value of `name`."""
        return InputError(
            what, file=self.file, key=self.key(name), value=self.data.get(name), allowed=allowed, next_step=next_step
        )

    def only(self, *names: str) -> None:
        """Refuse every key that is not in `names`."""
        for name in self.data:
            if name not in names:
                raise InputError(
                    "unknown key",
                    file=self.file,
                    key=self.key(name),
                    allowed=", ".join(names),
                    next_step=advice(self.path, name, names, self.data),
                )

    def need(self, *names: str) -> None:
        """Refuse a section without these keys."""
        for name in names:
            if name not in self.data:
                raise InputError("is missing", file=self.file, key=self.key(name), next_step=self._add(name))

    def __contains__(self, name: str) -> bool:
        return name in self.data

    def number(self, name: str, dimension: str) -> float | None:
        """Value in SI, or None if absent."""
        return None if name not in self.data else self._si(self.data[name], dimension, self.key(name))

    def whole(self, name: str) -> int | None:
        """A whole number, or None if absent."""
        value = self.data.get(name)
        if value is None or (isinstance(value, int) and not isinstance(value, bool)):
            return value
        raise self.error("is not a whole number", name)

    def text(self, name: str, allowed: tuple[str, ...] | None = None) -> str | None:
        """A text, one of `allowed` if given, or None if absent."""
        value = self.data.get(name)
        if value is None:
            return None
        words = ", ".join(allowed) if allowed else "a text in quotes"
        if not isinstance(value, str):
            raise self.error("is not a text", name, allowed=words)
        if allowed and value not in allowed:
            raise self.error("is not known", name, allowed=words, next_step=closest(value, allowed))
        return value

    def vector(self, name: str, *dimensions: str) -> list[float] | None:
        """As many numbers in SI as `dimensions`, or None if absent."""
        if name not in self.data:
            return None
        return self._vector(self.data[name], dimensions, self.key(name))

    def rows(self, name: str, count: int, *dimensions: str) -> list[list[float]]:
        """`count` rows of numbers in SI."""
        value = self.data[name]
        if not isinstance(value, list) or len(value) != count:
            raise self.error(
                f"is not a list of {count} rows", name, allowed=f"{count} rows of {len(dimensions)} numbers"
            )
        return [self._vector(row, dimensions, f"{self.key(name)}[{i}]") for i, row in enumerate(value, start=1)]

    def section(self, name: str) -> Section | None:
        """The table under `name`, or None if absent."""
        return None if name not in self.data else self.child(self.data[name], name)

    def child(self, data: object, name: str) -> Section:
        """A section for `data` found under `name`."""
        return Section(data, self.key(name), self.file, self.folder)

    def build(self, model: Callable[..., M], **fields: object) -> M:
        """A model from this section's values; absent ones (None) take the model's default."""
        try:
            return model(**{name: value for name, value in fields.items() if value is not None})
        except InputError as error:
            raise self.locate(error) from None

    def locate(self, error: InputError) -> InputError:
        """The error with this section's path and file, and the value as the user wrote it."""
        if error.key is not None and error.key in self.data:
            error.value = self.data[error.key]
        if error.what == "is missing" and error.key:
            error.next_step = self._add(error.key)
        return error.located(file=self.file, prefix=self.path)

    def _add(self, name: str) -> str:
        line = example_line(self.path, name, self.data)
        return f"Add {self.key(name)}" + (f", for example: {line}" if line else "")

    def _vector(self, value: object, dimensions: tuple[str, ...], key: str) -> list[float]:
        if not isinstance(value, list) or len(value) != len(dimensions):
            raise InputError(
                "is not a vector",
                file=self.file,
                key=key,
                value=value,
                allowed=f"{len(dimensions)} numbers",
                next_step=_such_as(self.path, key.rpartition(".")[2], self.data),
            )
        return [
            self._si(item, dimension, f"{key}[{i}]")
            for i, (item, dimension) in enumerate(zip(value, dimensions, strict=True), start=1)
        ]

    def _si(self, value: object, dimension: str, key: str) -> float:
        try:
            return to_si(value, dimension, key=key)
        except InputError as error:
            raise error.located(file=self.file) from None


def _such_as(table: str, name: str, like: Mapping[str, Any] | None = None) -> str | None:
    line = example_line(table, name, like)
    return f"For example: {line}" if line else None
