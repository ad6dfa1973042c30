"""Pictures as PNG files: rows as they are, which deflate as well as filtered ones where most of a figure is white."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from struct import pack

import numpy as np
from numpy.typing import NDArray

INCH = 0.0254  # [m]
LEVEL = 1  # of deflating: higher ones take longer for a few per cent
_RGB = 2  # kind of colours: red, green, blue of 8 bits each


def png(colors: NDArray[np.uint8], dpi: float, words: Mapping[str, str | None]) -> bytes:
    """A picture (row, column, at least red, green, blue) as a PNG file, with its dots per inch and words about it."""
    high, wide = colors.shape[:2]
    rows = np.zeros((high, 1 + 3 * wide), dtype=np.uint8)  # each begins with 0: no filter
    for part in range(3):  # a colour at a time: in a third of the time that pixels take
        rows[:, 1 + part :: 3] = colors[:, :, part]
    metre = round(dpi / INCH)
    said = (_part(b"tEXt", f"{key}\0{value}".encode("latin-1")) for key, value in words.items())
    return b"".join(
        [
            b"\x89PNG\r\n\x1a\n",
            _part(b"IHDR", pack(">IIBBBBB", wide, high, 8, _RGB, 0, 0, 0)),
            *said,
            _part(b"pHYs", pack(">IIB", metre, metre, 1)),
            _part(b"IDAT", zlib.compress(rows.data, LEVEL)),
            _part(b"IEND", b""),
        ]
    )


def _part(kind: bytes, data: bytes) -> bytes:
    return pack(">I", len(data)) + kind + data + pack(">I", zlib.crc32(kind + data))
