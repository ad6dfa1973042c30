"""Reference of study files with an example for everything: the source of the page and of messages about keys."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

from flexapod.common.errors import closest_word
from flexapod.common.tables.toml import toml_value

_VARIANT = ("type", "law")


@dataclass(frozen=True, kw_only=True)
class Entry:
    """An example of a table: for which `study` ("robot", "actuator"), of which variant (`title`), what it is for."""

    table: str
    example: str
    words: str
    title: str = ""
    study: str = "robot"

    @property
    def data(self) -> dict[str, Any]:
        """Data that the example has at its table; of a list of tables the keys of all, the first ones first."""
        found = [tomllib.loads(self.example)]
        for name in self.table.split("."):
            inner = [table[name] for table in found if name in table]
            found = [item for value in inner for item in (value if isinstance(value, list) else [value])]
        return {name: value for table in reversed(found) for name, value in table.items()}


@dataclass(frozen=True, kw_only=True)
class Reference:
    """All entries; words by table and key; defaults by key path; words by choice; tables in CSV by file name."""

    entries: tuple[Entry, ...]
    words: Mapping[str, Mapping[str, str]]
    defaults: Mapping[str, str]
    choices: Mapping[str, Mapping[str, str]]
    files: Mapping[str, str]


@cache
def reference() -> Reference:
    """The content of ``keys.toml``."""
    found = tomllib.loads(files("flexapod.common.tables").joinpath("keys.toml").read_text(encoding="utf-8"))
    return Reference(
        entries=tuple(Entry(**entry) for entry in found["entry"]),
        words=found["words"],
        defaults=found["defaults"],
        choices=found["choices"],
        files=found["files"],
    )


def plain_path(path: str) -> str:
    """A key path without the numbers of list items."""
    return re.sub(r"\[\d+\]", "", path)


def example_line(table: str, name: str, like: Mapping[str, Any] | None = None) -> str | None:
    """``name = value`` from an example of the table; of the variant that the tables `like` have, if there is one."""
    like = like or {}
    fitting = [entry.data for entry in reference().entries if entry.table == plain_path(table)]
    found = [data for data in fitting if name in data]
    alike = [data for data in found if all(data[key] == like[key] for key in _VARIANT if key in data and key in like)]
    for data in (*alike, *found):
        return f"{name} = {toml_value(data[name])}"
    return None


def advice(table: str, wrong: str, allowed: Iterable[str], data: Mapping[str, Any]) -> str | None:
    """Advice for a wrong key: the nearest right one, the one that takes it inside, or a missing one."""
    allowed = tuple(allowed)
    lines = {name: line for name in allowed if (line := example_line(table, name, data))}
    if near := closest_word(wrong, allowed):
        return f"Did you mean {near!r}?" + (f" For example: {lines[near]}" if near in lines else "")
    inside = [name for name, line in lines.items() if re.search(rf"\b{re.escape(wrong)}\b", line)]
    for name in (*inside, *(name for name in lines if name not in data)):
        return f"For example: {lines[name]}"
    return None
