"""Tables of a study packed into a few bytes, and unpacked to the bit: a result stores the files that it names.

Numbers of a column are whole numbers: decimal digits times a unit where nearly all were written so, else their
64 bits; of these the first or second differences where they are smaller; then byte by byte, deflated.
"""

from __future__ import annotations

import hashlib
import json
import math
import zlib
from base64 import b85decode, b85encode
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import InputError
from flexapod.common.tables.named_files import Stored

Whole = NDArray[np.signedinteger[Any]]
Bytes = NDArray[np.uint8]

MAGIC = b"flexapod tables 1\n"
MOST_NUMBERS = 50_000_000
"""Of all tables of a study; the largest CSV file has fewer."""
HEADER = 16_000_000
"""Largest description of what is packed [bytes]."""
FACTORS = (1.0, 1e-3, math.pi / 180, 1e-6, 1e-9, 1e3, 1e6, math.pi / 180e3, math.pi / 180e6)
"""Of units in which tables are written; a column in another one is kept by its bits."""
MOST_DIGITS = 18  # after the decimal point
LOOKED_AT = 200  # numbers of a column that tell how it was written
WORTH = 0.7  # share of them from which on it is tried
KEPT = 4  # packed tables that are remembered: many results of one study follow each other

_packed: OrderedDict[str, Bytes] = OrderedDict()


def pack(tables: Mapping[str, Stored]) -> Bytes:
    """Tables as bytes, (n,) of ``uint8``, read-only; the same tables give the same bytes."""
    arrays: dict[bytes, tuple[int, Array]] = {}
    entries = []
    for key, table in tables.items():
        parts = [[name, dimension, _part(value, arrays)] for name, (dimension, value) in table.content.items()]
        entries.append([key, table.name, parts])
    digest = hashlib.sha256(json.dumps(entries).encode() + b"".join(arrays)).hexdigest()
    if digest not in _packed:
        _packed[digest] = _joined(entries, [array for _, array in arrays.values()])
        while len(_packed) > KEPT:
            _packed.popitem(last=False)
    return _packed[digest]


def _part(value: Any, arrays: dict[bytes, tuple[int, Array]]) -> object:
    """A value as JSON; equal arrays are stored once."""
    if not isinstance(value, np.ndarray):
        return {"value": value}
    flat = np.ascontiguousarray(value, dtype=np.float64).ravel()
    number, _ = arrays.setdefault(hashlib.sha256(flat.tobytes()).digest(), (len(arrays), flat))
    return {"array": number, "shape": list(value.shape)}


def _joined(entries: list[Any], arrays: list[Array]) -> Bytes:
    columns = [_Column.shortest_form(array) for array in arrays]
    told = {"tables": entries, "arrays": [column.header() for column in columns]}
    header = zlib.compress(json.dumps(told).encode())
    content = b"".join(
        [MAGIC, len(header).to_bytes(8, "little"), header, *(c for column in columns for c in column.made)]
    )
    found = np.frombuffer(content, np.uint8)
    found.flags.writeable = False
    return found


def unpack(packed: object) -> dict[str, Stored]:
    """The tables of `pack`, or of `as_text`.

    Raises
    ------
    InputError
        They are damaged, or unpack to more than `MOST_NUMBERS`.
    """
    try:
        content = b85decode(packed) if isinstance(packed, str) else np.asarray(packed, dtype=np.uint8).tobytes()
        begin = len(MAGIC) + 8
        if not content.startswith(MAGIC):
            raise ValueError("another form")
        end = begin + int.from_bytes(content[len(MAGIC) : begin], "little")
        told = json.loads(_inflated(content[begin:end], None))
        columns = [_Column(**column) for column in told["arrays"]]
        if sum(column.size for column in columns) > MOST_NUMBERS or min((c.size for c in columns), default=0) < 0:
            raise ValueError("too many numbers")
        arrays = []
        for column in columns:
            lengths = column.lengths
            pieces = [content[end + sum(lengths[:i]) : end + sum(lengths[: i + 1])] for i in range(len(lengths))]
            arrays.append(column.numbers(pieces))
            end += sum(lengths)
        return {
            str(key): Stored(str(name), {str(n): (str(d), _value(part, arrays)) for n, d, part in parts})
            for key, name, parts in told["tables"]
        }
    except Exception as error:  # whatever bytes that are none of ours lead to
        raise InputError(
            f"are not the tables of its study ({type(error).__name__})",
            key="study_tables",
            next_step="Take a copy of the file, if there is one, or compute it again",
        ) from None


def as_text(packed: Bytes) -> str:
    """Packed tables where there is place for a text only."""
    return b85encode(packed.tobytes()).decode()


def _value(part: Mapping[str, Any], arrays: list[Array]) -> object:
    if "array" not in part:
        return part["value"]
    return arrays[part["array"]].reshape(part["shape"])


def _inflated(content: bytes, size: int | None) -> bytes:
    """Inflate content to `size` bytes, or to at most `HEADER` where it is None."""
    reader = zlib.decompressobj()
    found = reader.decompress(content, HEADER if size is None else size + 1)
    if (size is not None and len(found) != size) or not reader.eof:
        raise ValueError("another length")
    return found


@dataclass(kw_only=True)
class _Column:
    """Numbers as whole ones: `digits` after the point, None of bits, `factor` of the unit, `order` of differences.

    `odd`: how many of them are written out beside; `made`: what they are deflated to, of these `lengths`.
    """

    size: int
    order: int
    lengths: tuple[int, ...]
    digits: int | None = None
    factor: float = 1.0
    odd: int = 0
    made: tuple[bytes, ...] = ()

    @classmethod
    def shortest_form(cls, x: Array) -> _Column:
        """The shortest of the ways to keep (n,) numbers."""
        found = [_made(x.view(np.int64), x[:0], np.zeros(0, np.int64))]
        settings: list[dict[str, Any]] = [{}]
        if (way := _decimal(x)) is not None:
            whole, same = _whole(x, *way)
            odd = np.flatnonzero(~same)
            found.append(_made(np.where(same, whole, 0), x[odd], odd))
            settings.append({"digits": way[0], "factor": way[1], "odd": int(odd.size)})
        best = min(range(len(found)), key=lambda i: sum(map(len, found[i][1])))
        order, made = found[best]
        return cls(size=x.size, order=order, lengths=tuple(map(len, made)), made=made, **settings[best])

    def header(self) -> dict[str, Any]:
        """Header of the column: all but its bytes."""
        return {name: value for name, value in vars(self).items() if name != "made"}

    def numbers(self, pieces: list[bytes]) -> Array:
        """The numbers, (size,), read-only."""
        planes = np.frombuffer(_inflated(pieces[0], 8 * self.size), np.uint8).reshape(8, self.size)
        folded = np.ascontiguousarray(planes.T).reshape(-1).view(np.uint64)
        whole = (folded >> np.uint64(1)).view(np.int64) ^ -(folded & np.uint64(1)).view(np.int64)
        for _ in range(self.order):
            whole = np.cumsum(whole)
        found = whole.view(np.float64) if self.digits is None else _back(whole, self.digits, self.factor)
        if self.odd:
            beside = _inflated(pieces[1], 16 * self.odd)
            found = found.copy()
            found[np.frombuffer(beside[: 8 * self.odd], np.int64)] = np.frombuffer(beside[8 * self.odd :], np.float64)
        found.flags.writeable = False
        return found


def _made(whole: Whole, odd: Array, places: Whole) -> tuple[int, tuple[bytes, ...]]:
    """Order of the differences that are smallest, and the bytes of them and of what is written out beside."""
    ways, x = [whole], whole
    for _ in range(2):
        x = np.diff(x, prepend=np.int64(0))  # runs over where it has to: back again, too
        ways.append(x)
    folded = [(way.astype(np.uint64) << np.uint64(1)) ^ (way >> 63).astype(np.uint64) for way in ways]
    order = int(np.argmin([np.log2(1.0 + way.astype(float)).sum() for way in folded]))
    planes = np.ascontiguousarray(folded[order].view(np.uint8).reshape(-1, 8).T)
    beside = (zlib.compress(places.astype(np.int64).tobytes() + odd.tobytes()),) if odd.size else ()
    return order, (zlib.compress(planes.tobytes()), *beside)


def _decimal(x: Array) -> tuple[int, float] | None:
    """Digits after the point and unit in which most of the numbers seem to be written; None where there are none."""
    some, digits = x[:: max(1, x.size // LOOKED_AT)], np.arange(MOST_DIGITS + 1)
    if not some.size:
        return None
    shares = np.array([_whole(some[:, None], digits, factor)[1].mean(axis=0) for factor in FACTORS])
    unit, few = np.unravel_index(np.argmax(shares), shares.shape)  # of equal ones the usual unit, and the fewest digits
    return (int(few), FACTORS[unit]) if shares[unit, few] > WORTH else None


def _whole(x: Array, digits: int | Whole, factor: float) -> tuple[Whole, Mask]:
    """Whole numbers, and which of them give the numbers back to the bit."""
    with np.errstate(over="ignore"):
        scaled = np.rint(x / factor * 10.0**digits)
    within = np.abs(scaled) < 2.0**53
    whole = np.where(within, scaled, 0.0).astype(np.int64)
    return whole, within & (_back(whole, digits, factor).view(np.int64) == x.view(np.int64))


def _back(whole: Whole, digits: int | Whole, factor: float) -> Array:
    """The numbers as a table of them is read: the nearest to the decimal ones, times the unit."""
    return whole / 10.0**digits * factor
