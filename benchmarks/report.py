"""Tables of figures, printed and as Markdown."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Section", "goal"]


@dataclass(frozen=True, kw_only=True)
class Section:
    """One table with the command that repeats it, remarks and figures, by the names of their files, below."""

    title: str
    command: str
    header: Sequence[str]
    rows: Sequence[Sequence[str]]
    remarks: Sequence[str] = field(default_factory=tuple)
    pictures: Mapping[str, Figure] = field(default_factory=dict)

    def markdown(self) -> str:
        """As a chapter of a page."""
        lines = [_row(self.header), _row(["---"] * len(self.header)), *(_row(row) for row in self.rows)]
        parts = [f"## {self.title}", f"`{self.command}`", "\n".join(lines)]
        if self.remarks:
            parts.append("\n".join(f"- {remark}" for remark in self.remarks))
        parts += [f"![{self.title}]({name}.svg)" for name in self.pictures]
        return "\n\n".join(parts)

    def text(self) -> str:
        """For a terminal: columns aligned."""
        table = [self.header, *self.rows]
        widths = [max(len(row[i]) for row in table) for i in range(len(self.header))]
        lines = [
            "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in table
        ]
        return "\n".join([f"{self.title}   [{self.command}]", *lines, *(f"  {remark}" for remark in self.remarks)])


def _row(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cells) + " |"


def goal(value: float, limit: float, words: str, *, at_least: bool = False) -> str:
    """The goal and whether it is met."""
    met = value >= limit if at_least else value <= limit
    return f"{words}: {'met' if met else 'not met'}"
