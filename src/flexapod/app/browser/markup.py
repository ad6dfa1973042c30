"""Errors, answers and remarks as HTML in which nothing that comes from a file is live; calls of scripts.

Scripts (`assets`) run in the page of one client, each a function of one argument.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import cache
from html import escape
from importlib.resources import files
from pathlib import Path
from typing import Any

from viser import ClientHandle

from flexapod.common.errors import FlexapodError
from flexapod.common.version import __version__
from flexapod.output.text.parts import error_lines, error_parts

_LIGHT = {"error": "#c0392b", "warning": "#9a6700", "good": "#2c6e49", "soft": "#666666"}
_COLOURS = {kind: f"var(--flexapod-{kind}, {colour})" for kind, colour in _LIGHT.items()} | {"plain": "inherit"}
"""Of text on white; `assets/view.js` gives those on black."""


def block(text: str, kind: str = "plain") -> str:
    """A paragraph; `kind` is one of error, warning, good, plain, soft."""
    return _box(escape(text), kind)


def title(text: str) -> str:
    """A heading."""
    return panel_html(f"<b style='font-size:1.05em'>{escape(text)}</b>")


def lines_html(lines: Sequence[str], kind: str = "plain") -> str:
    """Lines as they are, one below the other."""
    return _box("<br>".join(escape(line) for line in lines), kind)


def error_html(error: FlexapodError) -> str:
    """The words of the command line for an error; of a file the name, not the folders of whoever runs the server."""
    parts = error_parts(error)
    if file := parts.get("file"):
        parts["file"] = Path(file).name
    head, *rest = error_lines(parts)
    words = [f"<b>{escape(head)}</b>", *(escape(line.strip()) for line in rest)]
    return _box("<br>".join(words), "error")


def fault_html(error: BaseException) -> str:
    """A fault of ours, in words."""
    what = f"unexpected {type(error).__name__}: {error} (flexapod {__version__})"
    return block(f"Error: {what}. This is a fault of flexapod, not yours; the server's terminal shows more.", "error")


def reserve_height(hidden: str, html: str) -> str:
    """Words that take no less room than others, which are not seen."""
    place = "grid-area:1/1;min-width:0"
    return (
        f"<div style='display:grid'><div style='{place};visibility:hidden'>{hidden}</div>"
        f"<div style='{place}'>{html}</div></div>"
    )


def table_html(header: Sequence[str], rows: Sequence[Sequence[str]], marked: Sequence[bool] = ()) -> str:
    """A small table, numbers to the right; `marked` rows stand out."""
    cell = "padding:1px 6px 1px 0;text-align:"
    head = "".join(f"<th style='{cell}{'left' if not i else 'right'}'>{escape(h)}</th>" for i, h in enumerate(header))
    body = ""
    for row, mark in zip(rows, [*marked, *[False] * (len(rows) - len(marked))], strict=True):
        cells = "".join(
            f"<td style='{cell}{'left' if not i else 'right'}'>{escape(text)}</td>" for i, text in enumerate(row)
        )
        body += f"<tr style='color:{_COLOURS['error'] if mark else 'inherit'}'>{cells}</tr>"
    return panel_html(f"<table style='border-collapse:collapse;font-size:0.95em'><tr>{head}</tr>{body}</table>")


def scrollable_html(html: str) -> str:
    """HTML that may be wider than the panel."""
    return f"<div tabindex='0' role='region' aria-label='table' style='overflow-x:auto;white-space:nowrap'>{html}</div>"


def _box(inner: str, kind: str) -> str:
    return panel_html(f"<span class='flexapod-{kind}' style='color:{_COLOURS[kind]}'>{inner}</span>")


def panel_html(inner: str) -> str:
    """HTML at the margins and in the size of the panel's other words."""
    return f"<div style='padding:0 0.75em 0.5em;font-size:0.8rem;line-height:1.35;overflow-wrap:anywhere'>{inner}</div>"


def run_script(client: ClientHandle, name: str, argument: Any) -> None:
    """Call the function of a script, ``name.js``, in the browser of a client."""
    from viser import _messages

    source = f"({_function(name)})({json.dumps(argument, allow_nan=False)})"
    client._websock_connection.queue_message(_messages.RunJavascriptMessage(source=source))


@cache
def _function(name: str) -> str:
    text = files("flexapod.app.browser").joinpath("assets", f"{name}.js").read_text(encoding="utf-8")
    return text[text.index("\n(") + 1 :].rstrip().rstrip(";")
