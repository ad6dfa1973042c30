"""Binary glTF 2.0: arrays as accessors of one buffer, and the file that holds them."""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

_FLOAT, _UINT = 5126, 5125
_KINDS = {(): "SCALAR", (2,): "VEC2", (3,): "VEC3", (4,): "VEC4"}
VERTICES, TRIANGLES = 34962, 34963
Entry = dict[str, Any]


class Glb:
    """A file that grows: lists of `nodes`, `meshes`, `materials`, and what was stored in the buffer."""

    def __init__(self, generator: str) -> None:
        self._asset = {"version": "2.0", "generator": generator}
        self._bytes = bytearray()
        self._views: list[Entry] = []
        self._accessors: list[Entry] = []
        self.nodes: list[Entry] = []
        self.meshes: list[Entry] = []
        self.materials: list[Entry] = []
        self.samplers: list[Entry] = []
        self.channels: list[Entry] = []

    def add(self, kind: str, entry: Entry) -> int:
        """Put an entry at the end of the list `kind`; its place."""
        entries = getattr(self, kind)
        entries.append(entry)
        return len(entries) - 1

    def store(self, values: ArrayLike, target: int | None = None, name: str | None = None) -> int:
        """Store numbers, (n,) or (n, 2 to 4), as float32, indices as uint32; the accessor.

        Bounds are given for vertices, and for numbers that stand alone, as instants do.
        """
        found: NDArray[Any] = np.asarray(values)
        found = np.ascontiguousarray(found, dtype="<u4" if target == TRIANGLES else "<f4")
        view: Entry = {"buffer": 0, "byteOffset": len(self._bytes), "byteLength": found.nbytes}
        self._views.append(view | ({} if target is None else {"target": target}))
        self._bytes += found.tobytes()
        entry: Entry = {
            "bufferView": len(self._views) - 1,
            "componentType": _UINT if target == TRIANGLES else _FLOAT,
            "count": len(found),
            "type": _KINDS[found.shape[1:]],
        }
        if found.shape[1:] in ((), (3,)) and target != TRIANGLES:
            entry |= {"min": np.atleast_1d(found.min(0)).tolist(), "max": np.atleast_1d(found.max(0)).tolist()}
        self._accessors.append(entry | ({} if name is None else {"name": name}))
        return len(self._accessors) - 1

    def animate(self, node: int, path: str, time: int, values: ArrayLike, name: str | None = None) -> None:
        """Let a node's "translation", "rotation", "scale" or "weights" follow values at the instants `time`."""
        output = self.store(values, name=name)
        sampler = self.add("samplers", {"input": time, "output": output, "interpolation": "LINEAR"})
        self.channels.append({"sampler": sampler, "target": {"node": node, "path": path}})

    def content(self, root: int, animation: str) -> bytes:
        """The file, whose scene is the node `root`."""
        body: Entry = {
            "asset": self._asset, "scene": 0, "scenes": [{"nodes": [root]}], "nodes": self.nodes, "meshes": self.meshes,
            "materials": self.materials, "accessors": self._accessors, "bufferViews": self._views,
            "buffers": [{"byteLength": len(self._bytes)}],
        }  # fmt: skip
        if self.channels:
            body["animations"] = [{"name": animation, "samplers": self.samplers, "channels": self.channels}]
        text = json.dumps(body, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        whole = 12 + 8 + len(text) + 8 + len(self._bytes)
        head = struct.pack("<4sII", b"glTF", 2, whole) + struct.pack("<I4s", len(text), b"JSON")
        return head + text + struct.pack("<I4s", len(self._bytes), b"BIN\0") + bytes(self._bytes)
