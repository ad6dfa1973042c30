"""The commands: a page for each, as typer writes it."""

from __future__ import annotations

from pathlib import Path

import typer
from typer.cli import get_docs_for_click

from flexapod.app.cli.cli import app

FOLDER = Path("reference/commands")


def pages() -> dict[Path, str]:
    """Pages by place."""
    group = typer.main.get_command(app)
    above = typer.Context(group, info_name="flexapod")
    made = {FOLDER / f"{name}.md": _page(command, above) for name, command in group.commands.items()}
    rows = "\n".join(f"| [`flexapod {name}`]({name}.md) | {_first(x)} |" for name, x in group.commands.items())
    names = "\n".join(group.commands)
    made[FOLDER / "index.md"] = f"""# Commands

Every command takes `--help`; `flexapod --debug COMMAND` shows where in the code an error arose. {group.epilog}

| Command | What it does |
| --- | --- |
{rows}

```{{toctree}}
:hidden:

{names}
```
"""
    return made


def _first(command: typer.core.TyperCommand) -> str:
    return (command.help or "").split("\n\n")[0].replace("\n", " ")


def _page(command: typer.core.TyperCommand, above: typer.Context) -> str:
    context = typer.Context(command, info_name=command.name, parent=above)
    return get_docs_for_click(obj=command, ctx=context, call_prefix="flexapod")
