"""Limits on one connection to the page's server: its messages, what viser sees of it, the threads that answer."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, TypeAlias, cast

import msgspec
from websockets.asyncio.server import ServerConnection
from websockets.frames import DATA_OPCODES, Frame
from websockets.protocol import Event

from flexapod.app.browser.background import LOG
from flexapod.app.browser.network import admits_client, client_key

LARGEST_MESSAGE = 2_000_000
"""Largest message that is taken [bytes]; more closes the connection."""
LARGEST_WORDS = 64_000
"""Largest message that is not a part of a file [bytes]."""
MOST_CONNECTIONS = 256
"""Connections at once, those that have not said anything yet included; of one address as many as are still free."""
FIRST_MESSAGE = 10.0
"""Time until a page has said that it is there [s]."""
MOST_WORK = 8
"""Callbacks of one visitor that wait or run; what comes then is not read until one is done."""

GREETING, FILE, BEGIN, INPUT = "ViewerCameraMessage", "FileTransferPart", "FileTransferStartUpload", "GuiUpdateMessage"

_MOST_PIECES = 256  # in which a message may come
_UNREAD = 64_000_000  # bytes that wait for somebody who does not read
_PAUSE = 0.02  # [s]

Three: TypeAlias = tuple[float, float, float]
Four: TypeAlias = tuple[float, float, float, float]


class _Any(msgspec.Struct):
    type: str


class _Camera(msgspec.Struct):
    wxyz: Four
    position: Three
    look_at: Three
    up_direction: Three
    fov: float
    near: float
    far: float
    image_width: float
    image_height: float


class _Input(msgspec.Struct):
    uuid: str
    updates: dict[str, bool | int | float | str]


class _Begin(msgspec.Struct):
    source_component_uuid: str
    transfer_uuid: str
    filename: str
    mime_type: str
    part_count: int
    size_bytes: int


class _File(msgspec.Struct, forbid_unknown_fields=True):
    type: str
    source_component_uuid: str | None
    transfer_uuid: str
    part_index: int
    content: bytes


_FORMS: dict[str, Any] = {GREETING: _Camera, INPUT: _Input, BEGIN: _Begin, FILE: _File}
"""Messages that a page sends for itself; others are dropped: viser would pass some of them on to everybody."""


class ClientConnection(ServerConnection):
    """A connection whose messages are checked before they are decoded; `work`: its callbacks that wait or run."""

    peer: str
    whose: str

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self.work: set[Future[Any]] = set()
        self._pieces, self._until, self._is_there = 0, 0.0, False
        self.peer = self.whose = ""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Begin, unless there are too many already."""
        super().connection_made(transport)
        self.peer = self.whose = client_key(str((transport.get_extra_info("peername") or ("",))[0]))
        others = [cast("ClientConnection", other) for other in self.server.handlers if other is not self]
        if not admits_client(sum(other.peer == self.peer for other in others), len(others), MOST_CONNECTIONS):
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
            if kind in _FORMS and _is_finite(kind, cast("bytes", message)):
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


def _is_finite(kind: str, message: bytes) -> bool:
    """Test whether all numbers of a message are finite; ValueError where it has another form."""
    finite = _all_finite(msgspec.structs.astuple(msgspec.msgpack.decode(message, type=_FORMS[kind])))
    if not finite:
        LOG.warning("a message is ignored: a number in a %s is not finite", kind)
    return finite


def _all_finite(value: object) -> bool:
    if isinstance(value, tuple | dict):
        return all(map(_all_finite, value.values() if isinstance(value, dict) else value))
    return not isinstance(value, float) or math.isfinite(value)


class CallbackPool(ThreadPoolExecutor):
    """Threads for callbacks: exceptions are reported to the client of a callback, and a full queue delays it alone.

    `fault` is called with the client's number, or None, and the exception; `visitor` gives the connection of a number.
    """

    def __init__(
        self, fault: Callable[[int | None, BaseException], None], visitor: Callable[[int], ClientConnection | None]
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
