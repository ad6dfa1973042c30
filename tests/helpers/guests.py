"""Somebody who connects to the page's server as a browser does, without one, and reads what is sent; waiting."""

from __future__ import annotations

import threading
import time
from collections import Counter
from contextlib import contextmanager
from html import unescape

import msgspec
import viser
import zstandard
from viser import _messages
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

CAMERA = _messages.ViewerCameraMessage(
    wxyz=(1, 0, 0, 0), position=(1, 1, 1), fov=1.0, near=0.1, far=10.0, image_height=10, image_width=10,
    look_at=(0, 0, 0), up_direction=(0, 0, 1),
)  # fmt: skip


def until(true, seconds=300.0):
    """Wait until something holds; a busy machine takes longer, a fault for ever."""
    end = time.monotonic() + seconds
    while not (found := true()):
        assert time.monotonic() < end
        time.sleep(0.02)
    return found


def said(session) -> str:
    """What a session says above its tabs."""
    return unescape(session.header.said + session.header._fault.content)


class Guest:
    """What has come so far: `frames`, and in them `messages` by type; `bytes`."""

    def __init__(self, socket) -> None:
        self.socket, self.frames, self.bytes, self.messages = socket, 0, 0, Counter()
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def clear(self) -> None:
        """Count anew."""
        self.frames, self.bytes, self.messages = 0, 0, Counter()

    def _read(self) -> None:
        try:
            for frame in self.socket:
                self.frames, self.bytes = self.frames + 1, self.bytes + len(frame)
                self.messages.update(message["type"] for message in _messages_of(frame))
        except ConnectionClosed:
            pass


def _messages_of(frame: bytes) -> list[dict]:
    size, packed = (int.from_bytes(frame[i : i + 8], "little") for i in (0, 8))
    inner = zstandard.ZstdDecompressor().decompress(frame[16 : 16 + packed], max_output_size=size)
    return msgspec.msgpack.decode(inner)["messages"]


@contextmanager
def guest(server, **headers):
    """A `Guest` of a server, for as long as the block lasts."""
    address, versions = f"ws://127.0.0.1:{server.port}", [f"viser-v{viser.__version__}"]
    with connect(address, subprotocols=versions, max_size=None, **headers) as socket:
        socket.send(msgspec.msgpack.encode(CAMERA.as_serializable_dict([])))
        yield Guest(socket)
