"""Parts of what is told: sentences, tables, remarks, sections. They say what; `terminal` and `html` say how it looks.

A plain text stands for a sentence or a paragraph, an empty one for a gap on a terminal.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

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
    """What stands together below a title; one with nothing in it is left out.

    `close`: the title is a sentence of what stands before, and there in any case.
    """

    title: str
    items: Iterable[Item]
    close: bool = False


Item = str | Text | TextTable | Bullets | Remarks | Lines | Chapter


def warnings_of(data: Dataset) -> list[str]:
    """What is doubtful about a result, a line each."""
    return [line for line in str(data.attrs.get("warnings", "")).splitlines() if line]
