"""The text of a study that is being changed: values replaced in place, comments and layout kept."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import tomlkit

from flexapod.app.view.typed import plain
from flexapod.units import DIMENSIONS, number_and_unit, to_si

__all__ = ["Document", "Quantity", "quantity"]

_STEP = re.compile(r"([^.\[\]]+)|\[(\d+)\]")


@dataclass(frozen=True)
class Document:
    """A study file being changed: its `text` and its `path` (where it was read; None for one that was sent)."""

    text: str
    path: str | None

    def changed(self, key: str, value: object) -> Document:
        """With another value at a key path such as ``payload.com[2]``; a key that is not there is added."""
        tree = tomlkit.parse(self.text)
        table, last = _holder(tree, key)
        table[last] = value
        return Document(tree.as_string(), self.path)

    def without(self, key: str) -> Document:
        """Without the value at a key path."""
        tree = tomlkit.parse(self.text)
        table, last = _holder(tree, key)
        del table[last]
        return Document(tree.as_string(), self.path)

    def value(self, key: str) -> object:
        """The value at a key path, as written; None where there is none."""
        return _value(tomllib.loads(self.text), key)

    def having(self, keys: Iterable[str]) -> set[str]:
        """Those of the key paths at which there is a value."""
        data = tomllib.loads(self.text)
        return {key for key in keys if _value(data, key) is not None}


@dataclass(frozen=True)
class Quantity:
    """A number as written in a study file: `number` in `unit`; the unit is "" where none is written (SI)."""

    number: float
    unit: str

    def shown_unit(self, dimension: str) -> str:
        """The unit to show beside the number."""
        return (self.unit or DIMENSIONS[dimension].unit).replace("^2", "²").replace("^3", "³").replace("um", "µm")

    def in_unit(self, unit: str, dimension: str) -> Quantity:
        """The same in another unit."""
        if unit == self.unit:
            return self
        here, there = (to_si(f"1 {u}", dimension) if u else 1.0 for u in (self.unit, unit))
        return Quantity(self.number * here / there, unit)

    def written(self) -> object:
        """What to write into the file: a number, or a text with the unit."""
        text = plain(self.number)
        if self.unit:
            return f"{text} {self.unit}"
        return int(text) if re.fullmatch(r"[-+]?\d+", text) else float(text)


def quantity(value: object) -> Quantity | None:
    """The number and unit of a written value; None where it is neither a number nor a text that is read as one."""
    if isinstance(value, bool):
        return None
    if isinstance(value, int | float):
        return Quantity(float(value), "")
    read = number_and_unit(value) if isinstance(value, str) else None
    return Quantity(float(read[0]), read[1]) if read else None


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
