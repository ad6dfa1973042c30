"""Items of `parts` on a terminal, as text or JSON; and progress."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from flexapod.common.lazy_imports import LazyModule
from flexapod.output.text.parts import Bullets, Chapter, Item, Lines, Remarks, Text, TextTable

if TYPE_CHECKING:
    from flexapod.analysis.results.time_history import Report
    from flexapod.common import quantities
else:
    quantities = LazyModule("flexapod.common.quantities")


def print_answer(items: Iterable[Item], data: Callable[[], object], *, json: bool, verbose: bool = False) -> None:
    """Print an answer: its `data` as JSON where that is asked for, else its items; `verbose`: with what explains."""
    if json:
        print_json(data())
    else:
        print_items(items, verbose=verbose)


def print_items(told: Iterable[Item], *, verbose: bool = False, indent: int = 0) -> None:
    """Print items; those of a section are below its title, indented."""
    for item in told:
        match item:
            case str():
                print_text(item, indent=indent if item else 0)
            case Text():
                print_text(item.words, indent=indent)
            case TextTable():
                print_table(item, indent=indent)
            case Bullets():
                print_items(item.lines, indent=indent)
            case Remarks():
                _print_remarks(item, verbose=verbose, indent=indent)
            case Lines():
                for line in item.text.splitlines():
                    print_text(line, indent=4)
            case Chapter():
                _print_chapter(item, verbose=verbose)


def _print_chapter(chapter: Chapter, *, verbose: bool) -> None:
    items = list(chapter.items)
    if not chapter.close:
        if not items:
            return
        print_text()
    print_text(chapter.title)
    print_items(items, verbose=verbose, indent=2)


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


def _print_remarks(remarks: Remarks, *, verbose: bool, indent: int) -> None:
    """A line for each remark; its explanation with `verbose`, and otherwise how to get it, once."""
    parts = [quantities.brief(remark) for remark in remarks.lines]
    for remark, (first, _) in zip(remarks.lines, parts, strict=True):
        print_text(f"{remarks.title}{remark if verbose else first}", indent=indent)
    if not verbose and any(rest for _, rest in parts):
        print_text("More about these remarks: --verbose.", indent=indent)


def print_table(table: TextTable, *, indent: int = 0) -> None:
    """A table; columns of words are aligned to the left, the others, of numbers, to the right."""
    from rich import table as tables
    from rich.console import Console

    console = Console(highlight=False, markup=False, emoji=False)
    if not console.is_terminal:
        console.width = 200
    shown = tables.Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold")
    before, head = " " * indent, ["", *table.head] if table.of else table.head
    for i, name in enumerate(head):
        words = before + name if name and not i else name
        shown.add_column(words, justify="left" if i in table.left else "right", no_wrap=i not in table.left)
    for first, *others in table.rows:
        shown.add_row(f"{before}{table.of and f'{table.of} '}{first}", *others)
    console.print(shown)


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
