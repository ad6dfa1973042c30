"""What a table of a study file says letter for letter, kept beside its values for as long as it stands for them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

__all__ = ["Letters", "Written", "as_float", "together"]


class Letters(float):
    """A number in other letters than Python's: ``1e3``, ``0.10``."""

    text: str

    def __new__(cls, text: str) -> Letters:
        """Of its letters in a file."""
        found = super().__new__(cls, text)
        found.text = text
        return found

    def __getnewargs__(self) -> tuple[Any, ...]:
        return (self.text,)


def as_float(text: str) -> float:
    """The number of a text, with its letters where Python would write others."""
    value = float(text)
    return value if repr(value) == text else Letters(text)


@dataclass(frozen=True, slots=True)
class Written:
    """A table as it was written: `data`, keys in their order; `changed`: fields of its object that are others now."""

    data: Mapping[str, Any]
    changed: frozenset[str] = frozenset()


def together(fields: Mapping[str, object], order: Iterable[str], kept: Mapping[str, Any]) -> dict[str, object]:
    """The keys of a table, as they were written where that still holds.

    Parameters
    ----------
    fields : Mapping
        All that the table has to say, in SI.
    order : iterable of str
        Keys in the order in which they were written; the others follow.
    kept : Mapping
        Of those, what still says the same.
    """
    first = dict.fromkeys(name for name in order if name in fields)
    said = {name: kept[name] for name in kept if name in fields and _fits(kept[name], fields[name])}
    return {name: said.get(name, fields[name]) for name in (first | dict(fields))}


def _fits(text: object, value: object) -> bool:
    """Whether what was written has as many numbers: one of two in a plane, or of one for all, says more elsewhere."""
    if not isinstance(value, np.ndarray):
        return True
    return isinstance(text, list) and np.shape(np.array(text, dtype=object)) == value.shape
