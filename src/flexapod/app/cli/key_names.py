"""Names of tables and keys of a study file, read without the model: answers about wrong ones come at once."""

from __future__ import annotations

from flexapod.common.errors import InputError, nearest
from flexapod.common.tables.reference import Entry, reference

__all__ = ["check_table"]

MOST = 3  # names that are suggested


def check_table(wanted: str) -> None:
    """Refuse what is not a table of a study file, nor above one.

    Raises
    ------
    InputError
        With the table that is meant: of that last name, with a key of that name, or of a similar name.
    """
    entries = reference().entries
    tables = list(dict.fromkeys(entry.table for entry in entries))
    if any(f"{table}.".startswith(f"{wanted}.") for table in tables):
        return
    raise InputError(
        "is not a table of a study file",
        key="TABLE",
        value=wanted,
        allowed=f"{', '.join(dict.fromkeys(table.split('.')[0] for table in tables))}, or a table in one of them",
        next_step=_meant(wanted, tables, entries),
    )


def _meant(wanted: str, tables: list[str], entries: tuple[Entry, ...]) -> str:
    table, _, last = wanted.rpartition(".")
    ends = [name for name in tables if name.rpartition(".")[2] == last]
    if ends:
        return f"Did you mean {' or '.join(map(repr, ends[:MOST]))}?"
    named = [name for name in tables if table in (name, "")]
    holders = [name for name in named if any(last in entry.data for entry in entries if entry.table == name)]
    if holders:
        which = " or ".join(f"`flexapod keys {name}`" for name in holders[:MOST])
        return f"{last} is a key of a table: {which}"
    lasts = {name.rpartition(".")[2]: name for name in reversed(tables)}
    keys = {f"{entry.table}.{key}": entry.table for entry in entries for key in entry.data}
    keys = {name: table for name, table in keys.items() if name not in tables}
    close = nearest(wanted, [*tables, *keys])
    if close in keys:
        return f"Did you mean the key {close}? `flexapod keys {keys[close]}`"
    close = close or lasts.get(nearest(last, lasts) or "")
    return f"Did you mean {close!r}?" if close else "`flexapod keys` lists all tables with their keys"
