"""Items of a text: sentences, tables, remarks, sections, which `terminal` and `html` lay out.

A plain text stands for a sentence or a paragraph, an empty one for a gap on a terminal.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from flexapod.common.errors import ComputationError, FlexapodError, InputError

if TYPE_CHECKING:
    from xarray import Dataset


@dataclass(frozen=True)
class Text:
    """A paragraph; its `kind` may be "soft", beside the matter, or "bad"."""

    words: str
    kind: str = ""


@dataclass(frozen=True)
class TextTable:
    """Rows of texts under those of a head, if it has one; columns `left` are words, the others numbers.

    `of`: what the rows are, "leg"; their numbers are then a first column, which the head leaves out. `marks`: what
    texts in it stand for: good, bad, open.
    """

    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    left: Collection[int] = (0,)
    of: str = ""
    marks: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Bullets:
    """Sentences of one list."""

    lines: Sequence[str]


@dataclass(frozen=True)
class Remarks:
    """Remarks: the first sentence of each says it, the others explain it; a `title` stands before each."""

    lines: Sequence[str]
    title: str = ""


@dataclass(frozen=True)
class Lines:
    """Lines of a file, as they are; on a page folded away under a `title`, if there is one."""

    text: str
    title: str = ""


@dataclass(frozen=True)
class Chapter:
    """A section: items below a title; an empty one is left out.

    `close`: the title is a sentence of what stands before, and there in any case.
    """

    title: str
    items: Iterable[Item]
    close: bool = False


Item = str | Text | TextTable | Bullets | Remarks | Lines | Chapter


def warning_lines(data: Dataset) -> list[str]:
    """Warnings of a result, a line each."""
    return [line for line in str(data.attrs.get("warnings", "")).splitlines() if line]


def error_parts(error: FlexapodError) -> dict[str, str | None]:
    """The parts of an error by name: `kind`, `what`, and where given `file`, `key`, `value`, `allowed`, `next_step`."""
    if isinstance(error, InputError):
        return {"kind": "input", **error.as_dict()}
    if isinstance(error, ComputationError):
        return {"kind": "computation", "what": error.what, "next_step": error.next_step}
    return {"kind": "computation", "what": str(error)}


def error_lines(parts: Mapping[str, str | None]) -> list[str]:
    """Lines on an error: what is wrong and with what, then one each for file, what is allowed and the next step."""
    named = ("allowed", "next_step") if not parts.get("key") else ("file", "allowed", "next_step")
    return [_headline(parts), *(f"  {name.replace('_', ' '):11s}{parts[name]}" for name in named if parts.get(name))]


def _headline(parts: Mapping[str, str | None]) -> str:
    """Key and value, else the file, and what is wrong with it."""
    place = parts.get("key") or parts.get("file")
    if parts.get("key") and parts.get("value") is not None:
        place = f"{place} = {parts['value']}"
    return f"Error: {place}: {parts['what']}" if place else f"Error: {parts['what']}"
