"""Commands that are planned: refused by name, so that nobody takes them for a typing error."""

from __future__ import annotations

from collections.abc import Callable

import typer

from flexapod.app.failures import guarded
from flexapod.errors import InputError

__all__ = ["LATER", "add"]

LATER = {
    "sweep": "for a few variants, change the study in a Python loop over flexapod.run",
    "view": "`flexapod run FILE` writes figures and report.html",
}


def add(app: typer.Typer) -> None:
    """Give `app` the commands."""
    for name in LATER:
        settings = {"allow_extra_args": True, "ignore_unknown_options": True}
        app.command(name, hidden=True, context_settings=settings, help="Comes with a later release.")(_refusal(name))


def _refusal(name: str) -> Callable[[typer.Context, bool], None]:
    @guarded
    def refuse(context: typer.Context, json: bool = False) -> None:
        raise InputError("comes with a later release of flexapod", key=f"flexapod {name}", next_step=LATER[name])

    return refuse
