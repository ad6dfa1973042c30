"""Text on the terminal: JSON, sentences, tables, progress."""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flexapod.study.record import Report


def print_json(data: object) -> None:
    """One JSON document on stdout, at once; numbers that are not finite become null, paths text."""
    print(json.dumps(_plain(data), indent=2, ensure_ascii=False), flush=True)


def _plain(data: object) -> object:
    if isinstance(data, dict):
        return {str(key): _plain(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_plain(value) for value in data]
    if isinstance(data, float) and not math.isfinite(data):
        return None
    return str(data) if isinstance(data, Path) else data


def print_text(text: str = "", *, indent: int = 0) -> None:
    """A paragraph that wraps at words on a terminal and is one line elsewhere."""
    from rich.console import Console
    from rich.padding import Padding

    console = Console(highlight=False, markup=False, emoji=False)
    if console.is_terminal:
        console.print(Padding(text, (0, 0, 0, indent)))
    else:
        console.print(" " * indent + text, soft_wrap=True)


def print_remarks(remarks: Sequence[str], *, verbose: bool, indent: int = 0, title: str = "") -> None:
    """A line for each remark; its explanation with `verbose`, and otherwise how to get it, once."""
    from flexapod.study.words import brief

    parts = [brief(remark) for remark in remarks]
    for remark, (first, _) in zip(remarks, parts, strict=True):
        print_text(f"{title}{remark if verbose else first}", indent=indent)
    if not verbose and any(rest for _, rest in parts):
        print_text("More about these remarks: --verbose.", indent=indent)


def print_table(header: Sequence[str], rows: Sequence[Sequence[str]], left: Collection[int] = (0,)) -> None:
    """A table; the columns `left` are aligned to the left, the others, of numbers, to the right."""
    from rich.console import Console
    from rich.table import Table

    console = Console(highlight=False, markup=False, emoji=False)
    if not console.is_terminal:
        console.width = 200
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold")
    for i, name in enumerate(header):
        table.add_column(name, justify="left" if i in left else "right", no_wrap=i not in left)
    for row in rows:
        table.add_row(*row)
    console.print(table)


@contextmanager
def progress_bar(*, quiet: bool) -> Iterator[Report]:
    """A bar with the remaining time on stderr; silent if `quiet` or where stderr is not a terminal."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeRemainingColumn())
    console = Console(stderr=True)
    hidden = quiet or not console.is_terminal
    with Progress(*columns, console=console, transient=True, disable=hidden, refresh_per_second=5) as bar:
        task = bar.add_task("preparing", total=1.0)

        def report(words: str, share: float) -> None:
            bar.update(task, description=words, completed=share)

        yield report
