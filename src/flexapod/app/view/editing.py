"""A study that is being changed: each change is validated by the reader of study files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from flexapod import model
from flexapod.app.view.document import Document
from flexapod.errors import InputError
from flexapod.model.fields import Field
from flexapod.units import DIMENSIONS

__all__ = ["Edit", "chosen", "edited", "first_value", "read"]


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
        study = model.loads(document.text, path=document.path)
    except InputError as error:
        return Edit(document=document, error=error, removed=removed)
    return Edit(document=document, study=study, removed=removed)


def edited(document: Document, changes: Mapping[str, object]) -> Edit:
    """The document with other values at some key paths."""
    for key, value in changes.items():
        document = document.changed(key, value)
    return read(document)


def chosen(document: Document, field: Field, value: str) -> Edit:
    """The document with another choice; keys of the same table that belonged to the choice before are taken out."""
    found, removed = read(document.changed(field.key, value)), []
    while (key := _refused(found, field.table)) is not None:
        removed.append(key)
        found = read(found.document.without(key), tuple(removed))
    return found


def first_value(field: Field) -> object:
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
