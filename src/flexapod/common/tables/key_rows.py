"""Keys of a study file in rows: of each example of the reference, as `flexapod keys` and the page show them.

They follow from trial studies, ``model/file/key_trials.py``, which writes them into ``key_rows.json``.
"""

from __future__ import annotations

import json
from dataclasses import astuple, dataclass
from importlib.resources import files

from flexapod.common.tables.reference import Entry, reference

HEAD = ("Key", "What it is", "Unit", "Default", "Allowed")


@dataclass(frozen=True)
class PageRow:
    """A key in words."""

    key: str
    what: str
    unit: str
    default: str
    allowed: str


@dataclass(frozen=True)
class ListedEntry:
    """An entry with its rows; `besides`: its keys that an entry of the same table before it has listed already."""

    entry: Entry
    rows: tuple[PageRow, ...]
    besides: tuple[str, ...]

    @property
    def further(self) -> str:
        """Words for its keys that are listed above; nothing where there are none or it has no others."""
        return (
            f"Further keys, as above: {', '.join(f'`{key}`' for key in self.besides)}."
            if self.besides and self.rows
            else ""
        )


def list_entries(table: str | None = None) -> list[ListedEntry]:
    """All entries with their rows, or those of a table and of tables in it."""
    stored = json.loads(files("flexapod.common.tables").joinpath("key_rows.json").read_text(encoding="utf-8"))
    return [
        ListedEntry(entry, tuple(PageRow(*row) for row in found["rows"]), tuple(found["besides"]))
        for entry, found in zip(reference().entries, stored, strict=True)
        if table is None or f"{entry.table}.".startswith(f"{table}.")
    ]


def stored_text(entries: list[ListedEntry]) -> str:
    """The content of ``key_rows.json``, a line for each row."""
    return "[\n" + ",\n".join(_stored(item) for item in entries) + "\n]\n"


def _stored(item: ListedEntry) -> str:
    name = json.dumps(f"{item.entry.study} {item.entry.table} {item.entry.title}".rstrip(), ensure_ascii=False)
    rows = ",".join("\n  " + json.dumps(astuple(row), ensure_ascii=False) for row in item.rows)
    return f'{{"entry": {name}, "besides": {json.dumps(item.besides)}, "rows": [{rows}]}}'
