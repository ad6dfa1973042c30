"""The commands: a page for each, from the command line itself."""

from __future__ import annotations

from pathlib import Path

import typer

from flexapod.app.cli.cli import app

FOLDER = Path("reference/commands")


def pages() -> dict[Path, str]:
    """Pages by place."""
    group = typer.main.get_command(app)
    commands = group.commands
    made = {FOLDER / f"{name}.md": _page(name, command) for name, command in commands.items()}
    rows = "\n".join(f"| [`flexapod {name}`]({name}.md) | {_first(command)} |" for name, command in commands.items())
    names = "\n".join(commands)
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


def _page(name: str, command: typer.core.TyperCommand) -> str:
    arguments = [p for p in command.params if p.param_type_name == "argument"]
    options = [p for p in command.params if p.param_type_name == "option" and not p.hidden]
    usage = " ".join(["flexapod", name, *map(_metavar, arguments), "[OPTIONS]"])
    lines = [f"# `flexapod {name}`", command.help or "", f"    {usage}"]
    for title, params in (("Arguments", arguments), ("Options", options)):
        if params:
            rows = [f"| {_called(p)} | {_cell(p.help)} | {_default(p)} |" for p in params]
            lines += [f"## {title}", "\n".join(["| Name | What it is | Default |", "| --- | --- | --- |", *rows])]
    return "\n\n".join(lines) + "\n"


def _metavar(param: typer.core.TyperArgument) -> str:
    return param.metavar or (param.name or "").upper()


def _called(param: typer.core.TyperOption) -> str:
    if param.param_type_name == "argument":
        return f"`{_metavar(param)}`"
    value = "" if param.is_flag else f" {param.metavar or (param.name or '').upper()}"
    return ", ".join(f"`{name}{value}`" for name in (*param.opts, *param.secondary_opts))


def _cell(text: str | None) -> str:
    return (text or "").replace("|", "\\|").replace("\n", " ")


def _default(param: typer.core.TyperOption) -> str:
    if param.required:
        return "required"
    none = param.default is None or param.default is False or callable(param.default)
    return "" if none else f"`{param.default}`"
