"""The gallery: every example is run; its page has its words, its figure, what it prints, and the file."""

from __future__ import annotations

import io
import os
import re
import runpy
from contextlib import chdir, redirect_stdout
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib

FOLDER = Path("gallery")
ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "src" / "flexapod" / "examples/gallery"
#: A row of `docs/gallery.md`: title, folder, name; and a table of examples there.
ROW = re.compile(r"\| \[([^\]]+)\]\(\S+/(gallery|notebooks)/(\w+)\.py\) \| `\w+` \|")
TABLE = re.compile(r"\| Example \|.*\n\| ---.*\n((?:\|.*\n)+)")


@cache
def run(name: str) -> tuple[bytes, str]:
    """Figure (PNG) and print of an example."""
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    printed, picture = io.StringIO(), io.BytesIO()
    with TemporaryDirectory() as folder, chdir(folder), redirect_stdout(printed):
        found = runpy.run_path(os.fspath(EXAMPLES / f"{name}.py"), run_name="__main__")
        found["figure"].savefig(picture, dpi=110, bbox_inches="tight")
    plt.close("all")
    return picture.getvalue(), printed.getvalue()


def words(name: str) -> tuple[str, str]:
    """Title and words of an example, in Markdown."""
    text = (EXAMPLES / f"{name}.py").read_text(encoding="utf-8").removeprefix("r")
    title, _, rest = text.split('"""')[1].strip().split("\n", 2)
    return title, rest.strip()


def titles(folder: str) -> dict[str, str]:
    """Titles by name of what `docs/gallery.md` lists of a folder: "gallery" or "notebooks"."""
    rows = ROW.findall((ROOT / "docs" / "gallery.md").read_text(encoding="utf-8"))
    return {name: title for title, of, name in rows if of == folder}


def pages() -> dict[Path, str]:
    """Pages by place."""
    return {FOLDER / "index.md": _index(), **{FOLDER / f"{name}.md": _page(name) for name in titles("gallery")}}


def pictures(folder: Path) -> set[Path]:
    """Write the figures beside the pages."""
    (folder / FOLDER).mkdir(parents=True, exist_ok=True)
    written = set()
    for name in titles("gallery"):
        path = folder / FOLDER / f"{name}.png"
        path.write_bytes(run(name)[0])
        written.add(path)
    return written


def _page(name: str) -> str:
    title, text = words(name)
    code = (EXAMPLES / f"{name}.py").read_text(encoding="utf-8").split('"""', 2)[2].strip()
    return f"""# {title}

{text}

`flexapod new --example {name}` writes this file.

![Figure of the example: {title}]({name}.png)

```python
{code}
```

It prints

```text
{run(name)[1].rstrip()}
```
"""


def _index() -> str:
    """`docs/gallery.md` with its examples as cards."""
    text = TABLE.sub(lambda table: _cards(table[1]), (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8"))
    text = ROW.sub(r"| [\1](../\2/\3.py) | `\3` |", text)
    listed = "\n".join([*titles("gallery"), *(f"../notebooks/{name}" for name in titles("notebooks"))])
    return f"{text}\n```{{toctree}}\n:hidden:\n\n{listed}\n```\n"


def _cards(rows: str) -> str:
    cards = "\n".join(
        f":::{{grid-item-card}} {title}\n:link: {name}\n:link-type: doc\n:img-top: {name}.png\n:img-alt: {title}\n:::\n"
        for title, _, name in ROW.findall(rows)
    )
    return f"::::{{grid}} 1 2 3 3\n:gutter: 3\n\n{cards}\n::::\n"
