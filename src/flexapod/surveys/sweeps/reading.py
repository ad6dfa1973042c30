"""From the tables of a study file with other values in them to a study, and the dimension of every number read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import isfinite
from pathlib import Path
from typing import Any, TypeVar

from flexapod.errors import InputError
from flexapod.model import ActuatorStudy, Study
from flexapod.model.files import read_study
from flexapod.model.section import Section
from flexapod.surveys.sweeps.keys import Step, key_text

__all__ = ["Malformed", "dimension_of", "read_with_dimensions", "study_of"]

T = TypeVar("T")


class Malformed(InputError):
    """What no study file may hold, whatever its other values: unknown key, wrong unit, no number, no such choice."""


def study_of(data: Mapping[str, Any], folder: Path) -> Study | ActuatorStudy:
    """The study of these tables.

    Raises
    ------
    Malformed
        A key or a value is none of a study file.
    InputError
        The values are not allowed together, or not physical.
    """
    return read_with_dimensions(data, folder, {})


def read_with_dimensions(data: Mapping[str, Any], folder: Path, dimensions: dict[str, str]) -> Study | ActuatorStudy:
    """As `study_of`; `dimensions` receives the dimension of every number that is read, by key path."""
    return read_study(_Recorder(data, "", folder, dimensions), "a point of a sweep")


def dimension_of(key: tuple[Step, ...], dimensions: Mapping[str, str]) -> str | None:
    """Dimension of a number, or of those of a list or of all legs; None of a choice or a whole number."""
    text = key_text(key)
    first_leg = "leg[1]" + text[3:] if text.startswith("leg.") else text
    for candidate in (text, first_leg):
        for inner in ("", "[1]", "[1][1]"):
            if candidate + inner in dimensions:
                return dimensions[candidate + inner]
    return None


class _Recorder(Section):
    """A section that notes dimensions and tells malformed values from unphysical ones."""

    def __init__(self, data: object, path: str, folder: Path, dimensions: dict[str, str]) -> None:
        super().__init__(data, path, None, folder)
        self.dimensions = dimensions

    def child(self, data: object, name: str) -> Section:
        if isinstance(data, dict):
            return _Recorder(data, self.key(name), self.folder, self.dimensions)
        return _marked(lambda: _Recorder(data, self.key(name), self.folder, self.dimensions))

    def only(self, *names: str) -> None:
        if not self.data.keys() <= {*names}:
            _marked(lambda: super(_Recorder, self).only(*names))

    def whole(self, name: str) -> int | None:
        return _marked(lambda: super(_Recorder, self).whole(name))

    def text(self, name: str, allowed: tuple[str, ...] | None = None) -> str | None:
        return _marked(lambda: super(_Recorder, self).text(name, allowed))

    def rows(self, name: str, count: int, *dimensions: str) -> list[list[float]]:
        return _marked(lambda: super(_Recorder, self).rows(name, count, *dimensions))

    def vector(self, name: str, *dimensions: str) -> list[float] | None:
        return _marked(lambda: super(_Recorder, self).vector(name, *dimensions))

    def _si(self, value: object, dimension: str, key: str) -> float:
        self.dimensions[key] = dimension
        if isinstance(value, float) and isfinite(value):
            return value
        return _marked(lambda: super(_Recorder, self)._si(value, dimension, key))


def _marked(read: Callable[[], T]) -> T:
    try:
        return read()
    except Malformed:
        raise
    except InputError as e:
        raise Malformed(e.what, key=e.key, value=e.value, allowed=e.allowed, next_step=e.next_step) from None
