"""`flexapod keys`: what a study file may contain."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from flexapod.app.failures import guarded
from flexapod.app.options import Json

__all__ = ["add"]

Table = Annotated[str | None, typer.Argument(metavar="[TABLE]", help="Only this table and those in it: leg.drive")]
Markdown = Annotated[Path | None, typer.Option("--markdown", metavar="FILE", help="Write the whole page as Markdown.")]


def add(app: typer.Typer) -> None:
    """Give `app` the command."""
    app.command("keys")(keys)


@guarded
def keys(table: Table = None, markdown: Markdown = None, json: Json = False) -> None:
    """Show every key of a study file: what it is, unit, what it is if left out, what is allowed, an example."""
    from dataclasses import asdict

    from flexapod.app.terminal import print_json, print_table, print_text
    from flexapod.errors import InputError, closest
    from flexapod.files import replacing
    from flexapod.model import page

    if markdown is not None:
        with replacing(markdown) as file:
            file.write_text(page.markdown(), encoding="utf-8")
    found = [item for item in page.listed() if table is None or f"{item.entry.table}.".startswith(f"{table}.")]
    if not found:
        names = list(dict.fromkeys(item.entry.table for item in page.listed()))
        raise InputError(
            "is not a table of a study file", key="TABLE", value=table, allowed=", ".join(names),
            next_step=closest(str(table), names),
        )  # fmt: skip
    if json:
        print_json([asdict(item) for item in found])
    elif markdown is not None:
        print_text(f"{markdown} written.")
    else:
        for item in found:
            entry = item.entry
            print_text(f"[{entry.table}] {entry.title}".rstrip() + (f" ({entry.study})" if table is None else ""))
            print_text(entry.words, indent=2)
            if item.rows:
                print_table([f"  {page.HEAD[0]}", *page.HEAD[1:]], [
                    [f"  {row.key}", row.what, row.unit, row.default, row.allowed] for row in item.rows
                ], left=range(len(page.HEAD)))  # fmt: skip
            print_text()
            for line in entry.example.strip().splitlines():
                print_text(line, indent=4)
            print_text()
