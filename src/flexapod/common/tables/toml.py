"""TOML text to data, refused in words where it is not valid or where reading it would take for ever; and back.

What a table of a study file says letter for letter, kept beside its values for as long as it stands for them.
"""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexapod.common.errors import InputError


class Letters(float):
    """A number in other letters than Python's: ``1e3``, ``0.10``."""

    text: str

    def __new__(cls, text: str) -> Letters:
        """Make it of its letters in a file."""
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
class SourceTable:
    """A table as it was written: `data`, keys in their order; `changed`: fields of its object that are others now."""

    data: Mapping[str, Any]
    changed: frozenset[str] = frozenset()


def merge_source(fields: Mapping[str, object], order: Iterable[str], kept: Mapping[str, Any]) -> dict[str, object]:
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
    """Tell whether a text has as many numbers: one of two in a plane, or of one for all, says more elsewhere."""
    if not isinstance(value, np.ndarray):
        return True
    return isinstance(text, list) and np.shape(np.array(text, dtype=object)) == value.shape


DEEPEST = 32
"""Most names in a dotted key and most levels of tables and lists; a study has six. Reading takes the square of it."""
MOST_DIGITS = 1000
"""Longest whole number that is handed on; Python writes none of more than 4300 digits, not even into a message."""

_BARE = re.compile(r"[A-Za-z0-9_-]+")

# Texts and comments, which are passed over, and what separates keys; no piece fails to match once it has begun, so
# that the time stays proportional to the length of the text.
_PIECES = re.compile(
    r'"""(?:\\.|[^\\])*?(?:"{3,5}|\\?\Z)'
    r"|'''.*?(?:'{3,5}|\Z)"
    r'|"(?:\\.|[^"\\\n])*\\?"?'
    r"|'[^'\n]*'?"
    r"|#[^\n]*"
    r"|[.=,\n\[\]{}]",
    re.DOTALL,
)


def parse_toml(text: str, file: str) -> dict[str, Any]:
    """The data of a TOML text.

    Parameters
    ----------
    text : str
    file : str
        Name of the file for messages.

    Raises
    ------
    InputError
        It is not TOML; a key has too many dots, tables or lists lie too deep in each other, or a whole number has
        thousands of digits.
    """
    _refuse_long_keys(text, file)
    try:
        data = tomllib.loads(text, parse_float=as_float)
    except (ValueError, RecursionError) as error:  # ValueError: no TOML, or a number of thousands of digits
        raise InputError(f"is not valid TOML: {_reason(error)}", file=file) from None
    refuse_excess(data, file)
    return data


def _reason(error: Exception) -> str:
    if isinstance(error, RecursionError):
        return "lists or tables lie too deep in each other"
    if isinstance(error, tomllib.TOMLDecodeError):
        return str(error)
    return "a number has too many digits, or a date does not exist"


def _refuse_long_keys(text: str, file: str) -> None:
    """Refuse a dotted key of more than `DEEPEST` names before it is read."""
    dots = 0
    for piece in _PIECES.finditer(text):
        if piece[0] == ".":
            dots += 1
        elif piece[0] in "=,\n[]{}":
            dots = 0
        if dots >= DEEPEST:
            line = text.count("\n", 0, piece.start()) + 1
            raise InputError(f"has a key of too many parts in line {line}", file=file, allowed=f"at most {DEEPEST}")


def refuse_excess(data: dict[str, Any], file: str | None) -> None:
    """Refuse what lies too deep, and whole numbers of too many digits; without recursion, however deep it is.

    Raises
    ------
    InputError
        With the key, and the file if there is one.
    """
    waiting: list[tuple[str, int, object]] = [("", 0, data)]
    while waiting:
        path, depth, value = waiting.pop()
        if depth > DEEPEST:
            raise InputError("lies too deep", file=file, key=path, allowed=f"at most {DEEPEST} levels")
        if isinstance(value, dict):
            waiting += [(f"{path}.{name}" if path else name, depth + 1, item) for name, item in value.items()]
        elif isinstance(value, list):
            waiting += [(f"{path}[{i}]", depth + 1, item) for i, item in enumerate(value, start=1)]
        elif isinstance(value, int) and abs(value) >= 10**MOST_DIGITS:
            raise InputError("has too many digits", file=file, key=path, allowed=f"at most {MOST_DIGITS}")


def toml_text(tables: Mapping[str, Any]) -> str:
    """The text of a study file: its tables, or lists of tables, one after the other."""
    lines: list[str] = []
    for name, table in tables.items():
        head, items = (f"[[{name}]]", table) if isinstance(table, list) else (f"[{name}]", [table])
        for item in items:
            lines += ["", head, *_lines(item)]
    return "\n".join(lines) + "\n"


def _lines(table: Mapping[str, object]) -> list[str]:
    return [f"{toml_name(name)} = {toml_value(value)}" for name, value in table.items()]


def toml_name(name: str) -> str:
    """A key as it stands in a study file."""
    return name if _BARE.fullmatch(name) else _quoted(name)


def toml_value(value: object) -> str:
    """A value as it stands in a study file."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(_lines(value)) + " }"
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(toml_value(item) for item in value) + "]"
    if isinstance(value, str):
        return _quoted(value)
    return value.text if isinstance(value, Letters) else repr(value)


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
