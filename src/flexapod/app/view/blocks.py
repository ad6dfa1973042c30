"""Whole tables of a study text: where each one's lines begin and end, comments above its heading included."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Sequence

import tomlkit
from tomlkit.container import Container
from tomlkit.items import AoT, Table, Whitespace

from flexapod.errors import InputError

__all__ = ["bare", "blocks", "checked", "renamed", "replaced"]

_HEADING = re.compile(r"^\s*\[\[?\s*([^\[\]\"']+?)\s*\]\]?\s*(#.*)?$")


def blocks(text: str, name: str) -> list[tuple[int, int]]:
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


def replaced(text: str, first: int, after: int, lines: Sequence[str]) -> str:
    """The text with other lines in place of some."""
    old = text.splitlines()
    end = "\r\n" if "\r\n" in text else "\n"
    return end.join([*old[:first], *lines, *old[after:]]) + end


def renamed(lines: Sequence[str], name: str, heading: str) -> list[str]:
    """The lines of a table with another heading, ``[[leg]]`` for ``[leg]``."""
    pattern = re.compile(rf"^\s*\[\[?\s*{re.escape(name)}\s*\]\]?")
    return [pattern.sub(heading, line) for line in lines]


def bare(lines: Sequence[str]) -> list[str]:
    """The lines of a table without comments."""
    tree = tomlkit.parse("\n".join(lines) + "\n")
    _strip(tree)
    return [line for line in tree.as_string().splitlines() if line.strip() and not line.lstrip().startswith("#")]


def checked(text: str, expected: object, key: str) -> str:
    """The text where it reads as it should.

    Raises
    ------
    InputError
        The table is written in some other way, which the form does not change.
    """
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


def _start(lines: Sequence[str], heading: int) -> int:
    while heading and lines[heading - 1].lstrip().startswith("#"):
        heading -= 1
    return heading


def _strip(container: Container) -> None:
    for _, item in container.body:
        for part in item.body if isinstance(item, AoT) else [item]:
            if not isinstance(part, Whitespace):
                part.trivia.comment = part.trivia.comment_ws = ""
            if isinstance(part, Table):
                _strip(part.value)
