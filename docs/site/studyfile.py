"""The study file: a page for each of its tables, from the rows that `flexapod keys` shows."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

from flexapod.model.file import page

FOLDER = Path("reference/study-file")
#: First tables that are a page for each table in them.
LONG = ("leg",)


def pages() -> dict[Path, str]:
    """Pages by place."""
    made, contents = {}, {}
    for item in page.list_entries():
        made.setdefault((item.entry.study, _of(item.entry.table)), []).append(item)
    for (study, name), items in made.items():
        of = "" if study == "robot" or name == "actuator" else " of a single actuator"
        items.sort(key=lambda item: item.entry.table != name)  # its own first
        parts = [_levelled("\n\n".join(page.entry_text(item)), name) for item in items]
        contents[_place(study, name)] = "\n\n".join([f"# `[{name}]`{of}", *parts]) + "\n"
    contents[FOLDER / "keys.md"] = _keys(made)
    contents[FOLDER / "choices.md"] = _part("What the choices mean")
    contents[FOLDER / "units.md"] = _part("Numbers and units")
    contents[FOLDER / "tables-over-time.md"] = _part("Tables over time")
    contents[FOLDER / "index.md"] = _index(list(contents))
    return contents


def _of(table: str) -> str:
    """The table whose page has one: its first, or the first two where that would be too long a page."""
    names = table.split(".")
    return ".".join(names[:2] if names[0] in LONG else names[:1])


def _place(study: str, name: str) -> Path:
    before = "" if study == "robot" or name == "actuator" else "actuator-"
    return FOLDER / f"{before}{name.replace('.', '-')}.md"


def _keys(made: dict[tuple[str, str], list[page.ListedEntry]]) -> str:
    """All keys: whoever has one, as of a message, finds its table."""
    rows = {
        (f"{item.entry.table}.{row.key}", study): f"{row.what} | [`{name}`]({_place(study, name).name})"
        for (study, name), items in made.items()
        for item in items
        for row in item.rows
    }
    lines = "\n".join(f"| `{key}` | {words} |" for (key, _), words in sorted(rows.items()))
    return f"""# All keys

What a message refuses is named by its key: here is its table. Legs in a list are counted from 1 in a message,
`leg[2].drive.stiffness`; here they have no number.

| Key | What it is | Table |
| --- | --- | --- |
{lines}
"""


@cache
def _long() -> str:
    return page.study_file_page()


def _levelled(text: str, name: str) -> str:
    """Headings under the page's own, which the first of a table needs no second time."""
    found = re.match(r"#+ `\[?([\w.]+)\]?`(.*)", text)
    if found is None:
        return text
    rest = text.split("\n", 1)[1]
    if found[1] == name and not found[2]:
        return rest.strip()
    return f"## `{found[1]}`{found[2]}\n{rest}"


def _part(title: str) -> str:
    """A chapter of the long page that is no table of the file."""
    text = _long()
    start = text.index(f"## {title}")
    end = text.find("\n## ", start)
    return text[start + 1 : end if end >= 0 else None].rstrip() + "\n"


def _index(places: list[Path]) -> str:
    text = _long()
    introduction = text[: text.index("This page is written")].rstrip()
    names = "\n".join(place.stem for place in places)
    return f"""{introduction}

`flexapod keys leg.drive` shows a part of this in the terminal. All examples load. What a key of a message means is on
the page of its table: `leg.drive.stiffness` on that of [`[leg.drive]`](leg-drive.md); [all keys](keys.md) are
in one list, with their tables.

```{{toctree}}
:maxdepth: 2

{names}
```
"""
