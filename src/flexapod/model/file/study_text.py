"""The text of a study file: where its tables stand, and its legs spelled out one by one, comments kept."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from flexapod.common.lazy_imports import LazyModule
from flexapod.model.file.key_paths import each_leg, leg_count

if TYPE_CHECKING:
    import tomlkit
    from tomlkit import items
    from tomlkit.container import Container
else:
    tomlkit = LazyModule("tomlkit")
    items = LazyModule("tomlkit.items")

_HEADING = re.compile(r"^\s*\[\[?\s*([^\[\]\"']+?)\s*\]\]?\s*(#.*)?$")


def table_spans(text: str, name: str) -> list[tuple[int, int]]:
    """Lines (first, after the last) of each table with a heading ``[name]`` or ``[[name]]``, its inner tables included.

    Comments directly above a heading belong to it, blank lines before them to nobody.
    """
    lines = text.splitlines()
    headings = [(i, found[1]) for i, line in enumerate(lines) if (found := _HEADING.match(line))]
    headings = [(i, path) for i, path in headings if not path.startswith(f"{name}.")]
    ends = [_start(lines, i) for i, _ in headings[1:]] + [len(lines)]
    found = []
    for (i, path), end in zip(headings, ends, strict=True):
        if path == name:
            while not lines[end - 1].strip():
                end -= 1
            found.append((_start(lines, i), end))
    return found


def replace_lines(text: str, first: int, after: int, lines: Sequence[str]) -> str:
    """The text with other lines in place of some."""
    old = text.splitlines()
    end = "\r\n" if "\r\n" in text else "\n"
    return end.join([*old[:first], *lines, *old[after:]]) + end


def rename_table(lines: Sequence[str], name: str, heading: str) -> list[str]:
    """The lines of a table with another heading, ``[[leg]]`` for ``[leg]``."""
    pattern = re.compile(rf"^\s*\[\[?\s*{re.escape(name)}\s*\]\]?")
    return [pattern.sub(heading, line) for line in lines]


def strip_comments(lines: Sequence[str]) -> list[str]:
    """The lines of a table without comments."""
    tree = tomlkit.parse("\n".join(lines) + "\n")
    _strip(tree)
    return [line for line in tree.as_string().splitlines() if line.strip() and not line.lstrip().startswith("#")]


def with_each_leg(text: str) -> str:
    """The text with a ``[[leg]]`` for each leg; the comments stay with the first of those that were one table."""
    data = tomllib.loads(text)
    legs = each_leg(data)
    if legs is data.get("leg"):
        return text
    given = data["leg"] if isinstance(data["leg"], list) else [{**data["leg"], "count": leg_count(data)}]
    spans = table_spans(text, "leg")
    if len(spans) == len(given):
        found = text
        for (first, after), table in zip(reversed(spans), reversed(given), strict=True):
            lines = rename_table(_without_count(text.splitlines()[first:after]), "leg", "[[leg]]")
            copies = [line for _ in range(table.get("count", 1) - 1) for line in ("", *strip_comments(lines))]
            found = replace_lines(found, first, after, [*lines, *copies])
        if tomllib.loads(found).get("leg") == legs:
            return found
    tree: Any = tomlkit.parse(text)
    tree["leg"] = legs  # written in another way: without its comments
    return tree.as_string()


def _without_count(lines: Sequence[str]) -> list[str]:
    return [line for line in lines if not re.match(r"^\s*count\s*=", line)]


def _start(lines: Sequence[str], heading: int) -> int:
    while heading and lines[heading - 1].lstrip().startswith("#"):
        heading -= 1
    return heading


def _strip(container: Container) -> None:
    for _, item in container.body:
        for part in item.body if isinstance(item, items.AoT) else [item]:
            if not isinstance(part, items.Whitespace):
                part.trivia.comment = part.trivia.comment_ws = ""
            if isinstance(part, items.Table):
                _strip(part.value)
