"""Files that clients send, and the study that they download.

Uploads are limited in size, read as data, and refused in the words of the command line. A download has the text
of the study and the tables that the text names.
"""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any

import numpy as np

from flexapod import model
from flexapod.app.browser.document import Document, read
from flexapod.common.errors import InputError
from flexapod.common.files import temporary_folder
from flexapod.common.tables.csv_tables import table_text
from flexapod.common.tables.named_files import Content, NamedFiles, UnreadableFile
from flexapod.common.tables.systems import system_text
from flexapod.common.tables.toml import parse_toml
from flexapod.model import ActuatorStudy, Study
from flexapod.model.stored_tables import stored_tables

if TYPE_CHECKING:
    from viser import ClientHandle

LARGEST = 1_000_000
"""Largest file that is taken [bytes]."""
MOST_TABLES = 20
"""Tables that are kept for one person."""
MOST_BYTES = 10 * LARGEST
"""Size of all tables that are kept for one person [bytes]."""


class UploadFolder:
    """The folder of the tables that one person has sent; it lasts as long as their session."""

    def __init__(self) -> None:
        self._end = ExitStack()
        self.folder: Path = self._end.enter_context(temporary_folder())

    def close(self) -> None:
        """Delete the tables."""
        self._end.close()


def refuse_size(name: str, size: int) -> None:
    """Refuse a file of more than `LARGEST` bytes before it is taken in."""
    if size > LARGEST:
        raise InputError(
            f"is too large: {size / 1e6:.3g} MB", file=plain_name(name), allowed=f"at most {LARGEST / 1e6:g} MB"
        )


def read_upload(name: str, content: bytes, folder: Path) -> Document:
    """The document of a sent study file; of its `name` only the last part is used, for messages.

    `folder`: where the tables lie that the same person has sent before; no other file is read. InputError: too large,
    no UTF-8, no TOML, no valid study, or it names a table that was not sent.
    """
    name = plain_name(name)
    refuse_size(name, len(content))
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError("cannot be read: it is not UTF-8 text", file=name, allowed="a study file (TOML)") from None
    sent = NamedFiles(folder, closed=True)
    for key, file in _named(parse_toml(text, name)):
        try:
            sent.place(file)
        except UnreadableFile as error:
            raise InputError(
                error.what, file=name, key=key, value=file, allowed=error.allowed, next_step=error.next_step
            ) from None
    found = read(Document(text, name, sent))
    if found.error is not None:
        raise found.error
    return found.document


def store_table(name: str, content: bytes, folder: Path) -> str:
    """Keep a sent CSV table for a study file that names it; returns the name it goes by.

    InputError: too large, or no text; or with it there would be more than `MOST_TABLES` or `MOST_BYTES`.
    """
    name = plain_name(name)
    refuse_size(name, len(content))
    try:
        content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError("cannot be read: it is not a text table", file=name, allowed="a CSV file") from None
    kept = [path.stat().st_size for path in folder.iterdir() if path.name != name]
    if len(kept) >= MOST_TABLES or sum(kept) + len(content) > MOST_BYTES:
        raise InputError(
            "is one table too many",
            file=name,
            allowed=f"{MOST_TABLES} tables, {MOST_BYTES / 1e6:g} MB together",
            next_step="Send it under the name of one that is not needed any more, which it then replaces",
        )
    (folder / name).write_bytes(content)
    return name


def plain_name(name: str) -> str:
    """The last part of a name, with nothing in it that leads elsewhere."""
    last = PurePosixPath(name.replace("\\", "/")).name
    kept = "".join(c for c in last if c.isprintable() and c not in '/\\:*?"<>|')[-100:].lstrip(".")
    return kept or "study.toml"


def _named(data: object) -> list[tuple[str, str]]:
    """Key paths and values of every ``file = ...``, however deep: what is missing is told before all else."""
    found: list[tuple[str, str]] = []
    waiting = [("", data)]
    while waiting:
        path, value = waiting.pop()
        if isinstance(value, dict):
            inner = [(name, f"{path}.{name}" if path else name, item) for name, item in value.items()]
            found += [(key, item) for name, key, item in inner if name == "file" and isinstance(item, str)]
            waiting += [(key, item) for _, key, item in inner]
        elif isinstance(value, list):
            waiting += [(f"{path}[{i}]", item) for i, item in enumerate(value, start=1)]
    return found


MOST_INSTANTS = 500_000
"""Stored instants of a simulation that the page starts: a robot's take 2 kB each, so that one result is 1 GB."""
MOST_PARTS = 100
"""Parts in which a file may come; browsers send half a megabyte at a time."""


def refuse_length(study: model.Study | model.ActuatorStudy) -> None:
    """Refuse to simulate a study of more than `MOST_INSTANTS`, which would fill the memory of the server."""
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


def study_download(document: Document, study: Study | ActuatorStudy | None) -> tuple[str, bytes]:
    """End of a file's name, and its content: a ZIP of the study and its tables, or the text alone where it names none.

    `study`: what the document reads as; None where it is refused.
    """
    text, tables = study_files(document, study) if study is not None else (document.text, {})
    if not tables:
        return ".toml", text.encode()
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as files:
        files.writestr("study.toml", text)
        for name, content in tables.items():
            files.writestr(name, content)
    return ".zip", archive.getvalue()


def study_files(document: Document, study: Study | ActuatorStudy) -> tuple[str, dict[str, str]]:
    """The text of a study that names plain files only, and the text of each of these by name."""
    tables: dict[str, Content] = {}
    for key, table in stored_tables(study).items():
        place = next(place for place in _places(key) if isinstance(document.value(place), str))
        name = _free(
            plain_name(table.name) if table.name else _named_after(place, table.content), tables, table.content
        )
        tables[name] = {**tables.get(name, {}), **table.content}
        if document.value(place) != name:
            document = document.with_value(place, name)
    return document.text, {name: _text(content) for name, content in tables.items()}


def _places(key: str) -> tuple[str, ...]:
    """Key paths at which a key may be in a text: its own, that in the table of all legs, that of its table."""
    of_all = re.sub(r"^leg\[\d+\]", "leg", key)
    return key, of_all, *(place.rpartition(".")[0] for place in (key, of_all))


def _named_after(key: str, content: Content) -> str:
    stem = re.sub(r"\W+", "-", key.rpartition(".")[0]).strip("-")
    return f"{stem}.json" if "A" in content else f"{stem}.csv"


def _free(name: str, tables: dict[str, Content], content: Content) -> str:
    """A name under which no other table stands; columns of legs in one file stay together."""
    stem, _, ending = name.rpartition(".")
    names = (name, *(f"{stem}-{i}.{ending}" for i in range(2, len(tables) + 3)))
    return next(one for one in names if one not in tables or _fit(tables[one], content))


def _fit(there: Content, content: Content) -> bool:
    """Test whether columns may join others: those that both have are the same, the instants among them."""
    both = there.keys() & content.keys()
    return bool(both) and all(
        there[x][0] == content[x][0] and np.array_equal(np.asarray(there[x][1]), np.asarray(content[x][1]))
        for x in both
    )


def _text(content: Content) -> str:
    return system_text(content) if "A" in content else table_text(content)
