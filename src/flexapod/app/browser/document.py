"""The text of a study that is being changed: values replaced in place, whole tables, each change validated."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import tomlkit

from flexapod import model
from flexapod.app.browser.text_fields import plain
from flexapod.common.errors import InputError
from flexapod.common.tables.named_files import NamedFiles
from flexapod.common.units import DIMENSIONS, number_and_unit, to_si
from flexapod.model.file.fields import NotedField
from flexapod.model.file.files import loads_among

NOWHERE = NamedFiles(Path(), closed=True)
_STEP = re.compile(r"([^.\[\]]+)|\[(\d+)\]")


@dataclass(frozen=True)
class Document:
    """A study file being changed: its `text`, its `path` (for its name), and the `files` that it may name.

    Without `files` it may name none: whoever changes it is not the one whose files lie around the server.
    """

    text: str
    path: str | None
    files: NamedFiles = NOWHERE

    def with_value(self, key: str, value: object) -> Document:
        """Document with another value at a key path such as ``payload.com[2]``; a key that is absent is added."""
        tree = tomlkit.parse(self.text)
        table, last = _holder(tree, key)
        table[last] = value
        return self.with_text(tree.as_string())

    def without_key(self, key: str) -> Document:
        """Document without the value at a key path."""
        tree = tomlkit.parse(self.text)
        table, last = _holder(tree, key)
        del table[last]
        return self.with_text(tree.as_string())

    def with_text(self, text: str) -> Document:
        """Document with another text and the same files."""
        return replace(self, text=text)

    def with_folder(self, folder: Path) -> Document:
        """Document that may also name the tables in a folder, besides those that it has."""
        return replace(self, files=NamedFiles(folder, closed=True, stored=self.files.stored))

    def value(self, key: str) -> object:
        """The value at a key path, as written; None where there is none."""
        return _value(tomllib.loads(self.text), key)

    def present_keys(self, keys: Iterable[str]) -> set[str]:
        """Subset of the key paths at which the document has a value."""
        data = tomllib.loads(self.text)
        return {key for key in keys if _value(data, key) is not None}


@dataclass(frozen=True)
class TypedQuantity:
    """A number as written in a study file: `number` in `unit`; the unit is "" where none is written (SI)."""

    number: float
    unit: str

    def shown_unit(self, dimension: str) -> str:
        """The unit to show beside the number."""
        return (self.unit or DIMENSIONS[dimension].unit).replace("^2", "²").replace("^3", "³").replace("um", "µm")

    def in_unit(self, unit: str, dimension: str) -> TypedQuantity:
        """The same quantity in another unit."""
        if unit == self.unit:
            return self
        here, there = (to_si(f"1 {u}", dimension) if u else 1.0 for u in (self.unit, unit))
        return TypedQuantity(self.number * here / there, unit)

    def toml_value(self) -> object:
        """Value to write into the file: a number, or a text with the unit."""
        text = plain(self.number)
        if self.unit:
            return f"{text} {self.unit}"
        return int(text) if re.fullmatch(r"[-+]?\d+", text) else float(text)


def quantity(value: object) -> TypedQuantity | None:
    """The number and unit of a written value; None where it is neither a number nor a text that is read as one."""
    if isinstance(value, bool):
        return None
    if isinstance(value, int | float):
        return TypedQuantity(float(value), "")
    read = number_and_unit(value) if isinstance(value, str) else None
    return TypedQuantity(float(read[0]), read[1]) if read else None


def _value(data: Any, key: str) -> object:
    for name, index in _STEP.findall(key):
        try:
            data = data[int(index) - 1 if index else name]
        except (LookupError, TypeError):
            return None
    return data


def _holder(tree: Any, key: str) -> tuple[Any, str | int]:
    """The table or list that holds `key`, and the name or index in it; tables on the way are made."""
    steps = [int(index) - 1 if index else name for name, index in _STEP.findall(key)]
    for step in steps[:-1]:
        if isinstance(step, str) and step not in tree:
            tree[step] = tomlkit.table()
        tree = tree[step]
    return tree, steps[-1]


def check_toml(text: str, expected: object, key: str) -> str:
    """The text where it reads as it should, else InputError: it is written in a way that the form does not change."""
    try:
        same = tomllib.loads(text) == expected
    except tomllib.TOMLDecodeError:
        same = False
    if not same:
        raise InputError(
            "is written in a way that cannot be changed here",
            key=key,
            next_step="Download the study, change it in an editor, upload it again",
        )
    return text


@dataclass(frozen=True, kw_only=True)
class Edit:
    """A document and what reading it gives: a `study`, or the `error` that refuses it; `removed`: keys taken out."""

    document: Document
    study: model.Study | model.ActuatorStudy | None = None
    error: InputError | None = None
    removed: tuple[str, ...] = ()


def read(document: Document, removed: tuple[str, ...] = ()) -> Edit:
    """Read a document as `flexapod.load` reads a file."""
    try:
        study = loads_among(document.text, document.path, document.files)
    except InputError as error:
        return Edit(document=document, error=error, removed=removed)
    return Edit(document=document, study=study, removed=removed)


def edit_values(document: Document, changes: Mapping[str, object]) -> Edit:
    """The document with other values at some key paths."""
    for key, value in changes.items():
        document = document.with_value(key, value)
    return read(document)


def edit_choice(document: Document, field: NotedField, value: str) -> Edit:
    """The document with another choice; keys of the same table that belonged to the choice before are taken out."""
    found, removed = read(document.with_value(field.key, value)), []
    while (key := _refused(found, field.table)) is not None:
        removed.append(key)
        found = read(found.document.without_key(key), tuple(removed))
    return found


def first_value(field: NotedField) -> object:
    """A value to start from where an absent one is wanted: the model's default, else an example."""
    if field.kind == "text":
        return field.choices[0] if field.choices else ""
    if field.kind == "whole":
        return int(field.default or 1)
    if field.kind == "flag":
        return False
    if field.kind == "words":
        return list(field.choices or ())
    if field.kind == "rows":
        return [[0.0] * len(field.dimensions) for _ in range(3)]
    if field.kind == "vector":
        return [1, 0, 0] if field.dimensions[0] == "number" else [0] * len(field.dimensions)
    example = DIMENSIONS[field.dimensions[0]].example
    if field.default is not None:
        return field.default
    return float(example) if field.dimensions[0] == "number" else example


def _refused(found: Edit, table: str) -> str | None:
    error = found.error
    if error is None or error.what != "unknown key" or not (error.key or "").startswith(f"{table}."):
        return None
    return error.key
