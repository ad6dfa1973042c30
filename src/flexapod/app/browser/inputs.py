"""What a browser says of its inputs, looked at before viser takes it: only values that the input can have."""

from __future__ import annotations

from typing import Any

from viser import (
    ClientHandle,
    GuiButtonHandle,
    GuiCheckboxHandle,
    GuiDropdownHandle,
    GuiSliderHandle,
    GuiTextHandle,
)

from flexapod.app.browser.logs import LOG

LONGEST = 2_000
"""Longest text that is taken from a field [characters]."""


def limit_inputs(client: ClientHandle) -> None:
    """Take from a client only what its inputs can have: other values have no effect but a line in the log."""
    from viser import _messages

    connection: Any = client._websock_connection
    gui: Any = client.gui

    async def update(client_id: Any, message: Any) -> None:
        handle = gui._gui_input_handle_from_uuid.get(message.uuid)
        if handle is None:  # it may have gone meanwhile
            return
        problem = _problem(handle, message.updates["value"]) if [*message.updates] == ["value"] else "it sets no value"
        if problem:
            LOG.warning("client %s: a message had no effect: %s", client_id, problem)
            return
        if isinstance(handle, GuiSliderHandle):  # its ends may have changed while the value was on its way
            message.updates["value"] = min(max(message.updates["value"], handle.min), handle.max)
        await gui._handle_gui_updates(client_id, message)

    connection.unregister_handler(_messages.GuiUpdateMessage)
    connection.register_handler(_messages.GuiUpdateMessage, update)


def _problem(handle: Any, value: object) -> str:
    """Why an input cannot have a value; "" where it can."""
    if isinstance(handle, GuiSliderHandle):
        right = isinstance(value, int | float) and not isinstance(value, bool)
        return "" if right else "a slider takes a number"
    if isinstance(handle, GuiCheckboxHandle | GuiButtonHandle):
        return "" if isinstance(value, bool) else "a box or a button takes true or false"
    if isinstance(handle, GuiDropdownHandle):
        return "" if value in handle.options else "it is none of the options"
    if isinstance(handle, GuiTextHandle):
        right = isinstance(value, str) and len(value) <= LONGEST
        return "" if right else f"a field takes a text of at most {LONGEST} characters"
    return "this is nothing that a page sets"
