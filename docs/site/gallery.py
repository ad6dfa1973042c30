"""The gallery: every example is run; its page has its words, its figure, what it prints, and the file."""

from __future__ import annotations

import io
import os
import runpy
from contextlib import chdir, redirect_stdout
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib

from flexapod.app.cli.commands_study import titles

FOLDER = Path("gallery")
EXAMPLES = Path(__file__).parents[2] / "src" / "flexapod" / "examples/gallery"
SECTIONS = {
    "A robot and its answer": (
        "paper_robot",
        "sag_by_hand",
        "tripod_against_hexapod",
        "when_bending_matters",
        "stiffness_map",
        "catalogue_sweep",
    ),
    "A machine that somebody builds": (
        "machine_from_data_sheets",
        "better_joint",
        "friction_and_reversal",
        "warm_machine",
        "tolerances",
        "shaken_floor",
        "hydraulic_motion_base",
    ),
    "Other mechanisms": ("delta", "hexaglide", "flexure_hexapod", "redundant_8_ups", "actuator_in_space"),
    "Control and commands": ("force_feedback", "shaped_move"),
    "Under the hood": ("fidelity_ladder", "own_element"),
}


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


def pages() -> dict[Path, str]:
    """Pages by place."""
    names = [name for section in SECTIONS.values() for name in section]
    return {
        FOLDER / "index.md": _index(names),
        Path("notebooks/index.md"): _notebooks(),
        **{FOLDER / f"{name}.md": _page(name) for name in names},
    }


def pictures(folder: Path) -> set[Path]:
    """Write the figures beside the pages."""
    (folder / FOLDER).mkdir(parents=True, exist_ok=True)
    written = set()
    for name in (name for section in SECTIONS.values() for name in section):
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


def _index(names: list[str]) -> str:
    parts = [
        "# Gallery",
        "Each example is one file that runs in seconds and ends with a number known from outside: a closed form, a\n"
        "law, another program. `flexapod new --example sag_by_hand` writes one to start from, `flexapod new --list`\n"
        "names them all.",
    ]
    for title, section in SECTIONS.items():
        cards = "\n".join(
            f":::{{grid-item-card}} {words(n)[0]}\n:link: {n}\n:link-type: doc\n:img-top: {n}.png\n"
            f":img-alt: {words(n)[0]}\n:::\n"
            for n in section
        )
        parts.append(f"## {title}\n\n::::{{grid}} 1 2 3 3\n:gutter: 3\n\n{cards}\n::::")
    parts.append("## Notebooks\n\n" + _notebook_table("../notebooks/"))
    listed = "\n".join([*names, "../notebooks/index"])
    return "\n\n".join(parts) + f"\n\n```{{toctree}}\n:hidden:\n\n{listed}\n```\n"


def _notebook_table(before: str) -> str:
    rows = "\n".join(f"| [{title}]({before}{name}.py) | `{name}` |" for name, title in titles("--notebook").items())
    return f"| Notebook | Name |\n| --- | --- |\n{rows}"


def _notebooks() -> str:
    listed = "\n".join(titles("--notebook"))
    return f"""# Notebooks

They are run when this site is built. `flexapod new --notebook first_robot` writes one as a Python file whose cells
Jupyter opens with jupytext (`pip install jupytext`); `jupytext --to ipynb first_robot.py` makes a notebook of it.

{_notebook_table("")}

```{{toctree}}
:hidden:

{listed}
```
"""
