"""Scripts of ours in the page of one client (`assets`), each a function of one argument."""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files
from typing import Any

from viser import ClientHandle


def run_script(client: ClientHandle, name: str, argument: Any) -> None:
    """Call the function of a script, ``name.js``, in the browser of a client."""
    from viser import _messages

    source = f"({_function(name)})({json.dumps(argument, allow_nan=False)})"
    client._websock_connection.queue_message(_messages.RunJavascriptMessage(source=source))


@cache
def _function(name: str) -> str:
    text = files("flexapod.app.browser").joinpath("assets", f"{name}.js").read_text(encoding="utf-8")
    return text[text.index("\n(") + 1 :].rstrip().rstrip(";")
