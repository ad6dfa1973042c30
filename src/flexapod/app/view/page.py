"""What the browser is told besides viser's own messages: the title of its tab, and a script for what viser lacks."""

from __future__ import annotations

import json
from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from viser import ClientHandle

__all__ = ["prepare"]


def prepare(client: ClientHandle, name: str) -> None:
    """Call the page of a client after what it shows, and let it mend itself (`assets/view.js`)."""
    from viser import _messages

    source = f"({_script()})({json.dumps(f'{name} - flexapod')})"
    client._websock_connection.queue_message(_messages.RunJavascriptMessage(source=source))


@cache
def _script() -> str:
    text = files("flexapod.app").joinpath("assets", "view.js").read_text(encoding="utf-8")
    return text[text.index("(title) =>") :].rstrip().rstrip(";")
