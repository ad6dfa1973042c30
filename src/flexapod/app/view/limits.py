"""Limits that viser leaves open: the size of what a browser sends."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from flexapod.app.view.uploads import refuse_size
from flexapod.errors import InputError

if TYPE_CHECKING:
    from viser import ClientHandle

__all__ = ["limit_uploads"]


def limit_uploads(client: ClientHandle, largest: int, refused: Callable[[InputError], None]) -> None:
    """Take no file of more than `largest` bytes from a client: neither announced as such nor sent as such.

    viser gathers a file in memory before it tells anybody; this stands before it.
    """
    from viser import _messages

    connection: Any = client._websock_connection
    gui: Any = client.gui
    taken: dict[str, int] = {}

    def begin(client_id: Any, message: Any) -> None:
        try:
            refuse_size(message.filename, message.size_bytes)
        except InputError as error:
            _finish(connection, message)
            refused(error)
            return
        taken[message.transfer_uuid] = 0
        gui._handle_file_transfer_start(client_id, message)

    def part(client_id: Any, message: Any) -> None:
        if message.transfer_uuid not in taken:
            return
        taken[message.transfer_uuid] += len(message.content)
        if taken[message.transfer_uuid] > largest:
            del taken[message.transfer_uuid]
            gui._current_file_upload_states.pop(message.transfer_uuid, None)
            return
        gui._handle_file_transfer_part(client_id, message)
        if message.transfer_uuid not in gui._current_file_upload_states:
            del taken[message.transfer_uuid]

    connection.unregister_handler(_messages.FileTransferStartUpload)
    connection.unregister_handler(_messages.FileTransferPart)
    connection.register_handler(_messages.FileTransferStartUpload, begin)
    connection.register_handler(_messages.FileTransferPart, part)


def _finish(connection: Any, message: Any) -> None:
    """Tell the browser that nothing more is wanted, so that its button is free again."""
    from viser import _messages

    connection.queue_message(
        _messages.FileTransferPartAck(
            source_component_uuid=message.source_component_uuid,
            transfer_uuid=message.transfer_uuid,
            transferred_bytes=message.size_bytes,
            total_bytes=message.size_bytes,
        )
    )
