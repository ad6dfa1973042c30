"""The study file: a page for each of its first tables, from the rows that `flexapod keys` shows."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

from flexapod.model import page

FOLDER = Path("reference/study-file")
KINDS = {"robot": "A robot", "actuator": "A single actuator"}


def pages() -> dict[Path, str]:
    """Pages by place."""
    made, contents = {}, {}
    for study in KINDS:
        for item in page.listed():
            if item.entry.study != study:
                continue
            name = item.entry.table.split(".")[0]
            made.setdefault((study, name), []).append("\n\n".join(page.entry_text(item)))
    for (study, name), parts in made.items():
        place = FOLDER / (
            f"{name}.md" if study == "robot" else f"actuator-{name}.md".replace("actuator-actuator", "actuator")
        )
        of = "" if study == "robot" or name == "actuator" else " of a single actuator"
        contents[place] = "\n\n".join([f"# `[{name}]`{of}", *map(_levelled, parts)]) + "\n"
    contents[FOLDER / "choices.md"] = _part("What the choices mean")
    contents[FOLDER / "units.md"] = _part("Numbers and units")
    contents[FOLDER / "tables-over-time.md"] = _part("Tables over time")
    contents[FOLDER / "index.md"] = _index(list(contents))
    return contents


@cache
def _long() -> str:
    return page.markdown()


def _levelled(text: str) -> str:
    """Headings under the page's own; a table's name is its anchor."""
    found = re.match(r"#+ `\[?([\w.]+)\]?`(.*)", text)
    if found is None:
        return text
    level = "##" if "." not in found[1] else "###"
    return f"{level} `{found[1]}`{found[2]}\n{text.split(chr(10), 1)[1]}"


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
the page of its table: `leg.drive.stiffness` on that of [`[leg]`](leg.md).

```{{toctree}}
:maxdepth: 2

{names}
```
"""
