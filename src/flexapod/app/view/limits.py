"""Limits that viser and a study leave open: what a browser sends, how many instants are computed and kept."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from flexapod import model
from flexapod.app.view.uploads import refuse_size
from flexapod.errors import InputError

if TYPE_CHECKING:
    from viser import ClientHandle

__all__ = ["MOST_INSTANTS", "MOST_PARTS", "limit_uploads", "refuse_length"]

MOST_INSTANTS = 500_000
"""Stored instants of a simulation that the page starts: a robot's take 2 kB each, so that one result is 1 GB."""
MOST_PARTS = 100
"""Parts in which a file may come; browsers send half a megabyte at a time."""


def refuse_length(study: model.Study | model.ActuatorStudy) -> None:
    """Refuse to simulate a study whose result would fill the memory of the server.

    Raises
    ------
    InputError
        It has more than `MOST_INSTANTS`.
    """
    settings = study.simulation
    count = study.duration / settings.stored_step
    if count > MOST_INSTANTS:
        raise InputError(
            f"gives {count:.3g} stored instants in {study.duration:g} s: too many for this page",
            key="simulation.output_step",
            value=f"{settings.output_step:g} s",
            allowed=f"at most {MOST_INSTANTS} instants",
            next_step="Raise output_step, shorten duration, or compute it with `flexapod run`",
        )


def limit_uploads(client: ClientHandle, largest: int, refused: Callable[[InputError], None]) -> None:
    """Take no file of more than `largest` bytes from a client, and one at a time: the last that was begun.

    viser gathers a file in memory before it tells anybody; this stands before it.
    """
    from viser import _messages

    connection: Any = client._websock_connection
    gui: Any = client.gui
    taken: dict[str, int] = {}  # bytes of the one transfer that goes on
    gui._current_file_upload_states.clear()  # what was begun on a page that is built anew now

    def drop() -> None:
        for transfer in taken:
            gui._current_file_upload_states.pop(transfer, None)
        taken.clear()

    def begin(client_id: Any, message: Any) -> None:
        drop()
        try:
            refuse_size(message.filename, message.size_bytes)
            _refuse_parts(message.part_count)
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
            drop()
            return
        gui._handle_file_transfer_part(client_id, message)
        if message.transfer_uuid not in gui._current_file_upload_states:
            del taken[message.transfer_uuid]

    connection.unregister_handler(_messages.FileTransferStartUpload)
    connection.unregister_handler(_messages.FileTransferPart)
    connection.register_handler(_messages.FileTransferStartUpload, begin)
    connection.register_handler(_messages.FileTransferPart, part)


def _refuse_parts(count: int) -> None:
    if count > MOST_PARTS:
        raise InputError(f"comes in {count} parts", key="upload", allowed=f"at most {MOST_PARTS}")


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
