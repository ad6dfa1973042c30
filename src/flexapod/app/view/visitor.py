"""One connection to the page's server: what is taken from it, what viser sees of it, the threads that answer."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

import msgspec
from websockets.asyncio.server import ServerConnection
from websockets.frames import DATA_OPCODES, Frame
from websockets.protocol import Event

LARGEST_MESSAGE = 2_000_000
"""Largest message that is taken [bytes]; more closes the connection."""
LARGEST_WORDS = 64_000
"""Largest message that is not a part of a file [bytes]."""
MOST_CONNECTIONS = 128
"""Connections at once, those that have not said anything yet included."""
FIRST_MESSAGE = 10.0
"""Time until a page has said that it is there [s]."""
MOST_WORK = 8
"""Callbacks of one visitor that wait or run; what comes then is not read until one is done."""

GREETING, FILE = "ViewerCameraMessage", "FileTransferPart"
WANTED = frozenset(
    {GREETING, FILE, "FileTransferStartUpload", "GuiUpdateMessage", "GuiButtonHoldMessage", "CommandTriggerMessage",
     "ScenePointerMessage", "SceneNodeClickMessage", "SceneNodeDragMessage", "TransformControlsUpdateMessage",
     "TransformControlsDragStartMessage", "TransformControlsDragEndMessage", "LocalStorageGetItemResponseMessage"}
)  # fmt: skip
"""Messages that a page sends for itself; others are dropped: viser would pass some of them on to everybody."""

_MOST_PIECES = 256  # in which a message may come
_UNREAD = 64_000_000  # bytes that wait for somebody who does not read
_PAUSE = 0.02  # [s]


class _Any(msgspec.Struct):
    type: str


class _File(msgspec.Struct, forbid_unknown_fields=True):
    type: str
    source_component_uuid: str | None
    transfer_uuid: str
    part_index: int
    content: bytes


class Visitor(ServerConnection):
    """A connection whose messages are looked at before they are decoded; `work`: callbacks that wait or run for it."""

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self.work: set[Future[Any]] = set()
        self._pieces, self._until, self._is_there = 0, 0.0, False

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Begin, unless there are too many already."""
        super().connection_made(transport)
        if len(self.server.handlers) > MOST_CONNECTIONS:
            self.transport.abort()

    def data_received(self, data: bytes) -> None:
        """Take what has come; who only writes is not answered for ever."""
        super().data_received(data)
        if self.transport.get_write_buffer_size() > _UNREAD:
            self.transport.abort()

    def process_event(self, event: Event) -> None:
        """Take a request or a frame; a message in too many pieces ends the connection."""
        if isinstance(event, Frame) and event.opcode in DATA_OPCODES:
            self._pieces = 0 if event.fin else self._pieces + 1
            if self._pieces > _MOST_PIECES:
                self.transport.abort()
                return
        super().process_event(event)

    async def recv(self, decode: bool | None = None) -> Any:
        """The next message that the page may send.

        Raises
        ------
        TimeoutError
            `FIRST_MESSAGE` is over, and no page has said that it is there.
        ValueError
            What was sent is not a message of a page.
        """
        self._until = self._until or self.loop.time() + FIRST_MESSAGE
        while True:
            while len(self.work) >= MOST_WORK:
                await asyncio.sleep(_PAUSE)
            async with asyncio.timeout_at(None if self._is_there else self._until):
                message = await super().recv(decode)
            kind = _kind(message)
            if kind in WANTED:
                self._is_there |= kind == GREETING
                return message


def _kind(message: str | bytes) -> str:
    """Type of a message, from its bytes: what a large one holds is decoded only if it is a part of a file."""
    if isinstance(message, str):
        raise ValueError("text, where messages are bytes")
    form = _Any if len(message) <= LARGEST_WORDS else _File
    found = msgspec.msgpack.decode(message, type=form).type
    if form is _File and found != FILE:
        raise ValueError(f"{len(message)} bytes in a {found:.40}")
    return found


class Pool(ThreadPoolExecutor):
    """What a callback raises is told to the client that it belongs to; what waits for one holds up that one only.

    `fault` is called with the client's number, or None, and the exception; `visitor` gives the connection of a number.
    """

    def __init__(
        self, fault: Callable[[int | None, BaseException], None], visitor: Callable[[int], Visitor | None]
    ) -> None:
        super().__init__(max_workers=32, thread_name_prefix="flexapod-view")
        self._fault, self._visitor = fault, visitor

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Call back in a thread."""
        client = getattr(args[0], "client_id", None) if args else None
        work = super().submit(self._guarded, client, fn, *args, **kwargs)
        visitor = None if client is None else self._visitor(client)
        if visitor is not None:
            visitor.work.add(work)
            work.add_done_callback(visitor.work.discard)
        return work

    def _guarded(self, client: int | None, fn: Callable[..., Any], *args: Any, **kwargs: Any) -> Any:
        try:
            return fn(*args, **kwargs)
        except Exception as error:
            self._fault(client, error)
            return None
