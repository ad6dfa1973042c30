"""Arrays by name in files of others, read within bounds: NumPy's `.npz`, MATLAB's `.mat` of versions 4 and 5, JSON.

What a file says of its sizes is compared with what is there before anything is made of it, so that a damaged or a
hostile file costs no more than an honest one.
"""

from __future__ import annotations

import ast
import json
import math
import re
import zlib
from collections.abc import Callable, Iterator, Mapping
from io import BytesIO
from struct import error as TooShort
from struct import unpack_from
from typing import Any
from zipfile import ZIP_DEFLATED, ZIP_STORED, BadZipFile, ZipFile

import numpy as np

from flexapod.common.files import LARGEST_TABLE

MOST = LARGEST_TABLE // 8  # numbers, or texts, of all arrays together
MOST_LISTS = 200_000  # in JSON: rows of matrices
MOST_MEMBERS = 10_000  # arrays of a file, cells of an array
DEEPEST = 4  # cells within cells
HEAD = re.compile(rb"\x93NUMPY[\x01\x02\x03]\x00")
Wanted = Callable[[str], bool]


def texts_of(value: object) -> list[str] | None:
    """Texts of a list, an array, of MATLAB's cells or rows of letters; "" for an empty cell; None of something else."""
    if isinstance(value, str):
        return [value.strip()]
    if isinstance(value, np.ndarray):
        value = value.ravel().tolist()
    if not isinstance(value, list | tuple):
        return None
    found = [_text(cell) for cell in value]
    return None if None in found else [text for text in found if text is not None]


def _text(cell: object) -> str | None:
    """One text, of an array of one too."""
    if isinstance(cell, np.ndarray) and cell.size <= 1:
        cell = cell.ravel().tolist()[0] if cell.size else ""
    return cell.strip() if isinstance(cell, str) else None


def _claimed(count: int, itemsize: int, size: int) -> None:
    """Refuse as many numbers as a file says that it has where there are others, or too many."""
    if count * itemsize != size:
        raise ValueError("its sizes do not fit what is in it")
    if count > MOST:
        raise ValueError(f"it has more than {MOST} numbers")


def json_arrays(content: bytes, wanted: Wanted) -> dict[str, Any]:
    """Values by name, as JSON has them.

    Raises
    ------
    ValueError
        In words that fit behind "cannot be read:".
    """
    if content.count(b",") > MOST or content.count(b"[") + content.count(b"{") > MOST_LISTS:
        raise ValueError(f"it has more than {MOST} numbers or {MOST_LISTS} lists")
    try:
        data = json.loads(content.decode("utf-8-sig"))
    except RecursionError:
        raise ValueError("its lists are too deep") from None
    if not isinstance(data, Mapping):
        raise ValueError("it holds no names with matrices")
    return {name: value for name, value in data.items() if wanted(name)}


def npz_arrays(content: bytes, wanted: Wanted) -> dict[str, Any]:
    """Arrays by name, as `numpy.savez` and `numpy.savez_compressed` write them.

    Raises
    ------
    ValueError
        In words that fit behind "cannot be read:".
    """
    found, room = {}, LARGEST_TABLE
    try:
        with ZipFile(BytesIO(content)) as archive:
            members = archive.infolist()
            if len(members) > MOST_MEMBERS:
                raise ValueError(f"it has more than {MOST_MEMBERS} arrays")
            for member in members:
                name = member.filename.removesuffix(".npy")
                if not wanted(name):
                    continue
                if member.compress_type not in (ZIP_STORED, ZIP_DEFLATED):  # others are unpacked without a bound
                    raise ValueError(f"{name} is packed in another way than numpy's")
                room -= member.file_size
                if room < 0:
                    raise ValueError(f"unpacked it is larger than {LARGEST_TABLE / 1e6:g} MB")
                with archive.open(member) as file:
                    found[name] = _npy(file.read(member.file_size))
    except (BadZipFile, zlib.error, EOFError, OSError, RuntimeError, TooShort) as error:
        raise ValueError(str(error) or "it is damaged") from None
    return found


def _npy(data: bytes) -> np.ndarray:
    """The array of one member: a magic word, a description in letters, numbers."""
    if not HEAD.match(data):
        raise ValueError("an array in it has no head")
    width = 2 if data[6] == 1 else 4
    size = int.from_bytes(data[8 : 8 + width], "little")
    start = 8 + width + size
    if size > 10_000 or start > len(data):
        raise ValueError("an array in it has a head that is cut off")
    try:
        head = ast.literal_eval(data[8 + width : start].decode())
        shape, letters, turned = head["shape"], head["descr"], head["fortran_order"]
    except (ValueError, SyntaxError, KeyError, TypeError, MemoryError, RecursionError):
        raise ValueError("an array in it has a head that cannot be read") from None
    if not (isinstance(letters, str) and re.fullmatch(r"[<>|=]?[biufcUS]\d{1,6}", letters)):
        raise ValueError("an array in it holds neither numbers nor texts")
    if not (isinstance(shape, tuple) and len(shape) <= 32 and all(type(n) is int and n >= 0 for n in shape)):
        raise ValueError("an array in it has no shape")
    try:
        kind = np.dtype(letters)
    except TypeError:
        raise ValueError("an array in it holds neither numbers nor texts") from None
    _claimed(math.prod(shape), kind.itemsize or 1, len(data) - start)
    flat = np.frombuffer(data, kind, offset=start) if kind.itemsize else np.zeros(0, kind)
    return flat.reshape(shape, order="F" if turned else "C")


#: Of elements of version 5: how numbers are stored, by the number of the kind.
STORED = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
MATRIX, COMPRESSED, TEXT_8, TEXT_16, TEXT_32 = 14, 15, 16, 17, 18
#: What an array of version 5 is, by the number of its class.
CELLS, LETTERS, OPAQUE, NUMBERS = 1, 4, 17, range(6, 16)
OTHERS = {2: "a struct", 3: "an object", 5: "a sparse matrix", 16: "a function",
          OPAQUE: "an object, or texts in double quotes"}  # fmt: skip
COMPLEX = 0x800
#: Numbers of version 4, by the tens of the type.
STORED_4 = ("f8", "f4", "i4", "i2", "u2", "u1")


def mat_arrays(content: bytes, wanted: Wanted) -> dict[str, Any]:
    """Arrays by name of a file of MATLAB, versions 4 and 5 (``-v4``, ``-v6``, ``-v7``): numbers, texts, cells.

    Texts are arrays of their rows, cells arrays of arrays. Variables that are not wanted are passed over.

    Raises
    ------
    ValueError
        In words that fit behind "cannot be read:".
    """
    try:
        if len(content) < 20 or 0 in content[:4]:
            return dict(_version_4(content, wanted))
        return dict(_version_5(content, wanted))
    except TooShort:
        raise ValueError("it is cut off") from None


def _version_5(content: bytes, wanted: Wanted) -> Iterator[tuple[str, Any]]:
    mark = content[126:128]
    if mark not in (b"IM", b"MI"):
        raise ValueError("it is no file of MATLAB")
    order = "<" if mark == b"IM" else ">"
    if unpack_from(order + "H", content, 124)[0] != 0x0100:
        raise ValueError("it is of MATLAB 7.3, or of no version that is known")
    room = LARGEST_TABLE
    for number, (kind, data) in enumerate(_elements(memoryview(content)[128:], order)):
        if number == MOST_MEMBERS:
            raise ValueError(f"it has more than {MOST_MEMBERS} arrays")
        if kind == COMPRESSED:
            unpacked = _unpacked(data, room)
            room -= len(unpacked)
            kind, data = _next(_elements(memoryview(unpacked), order), (MATRIX,))
        if kind == MATRIX:
            name, value = _array(data, order, wanted, 0)
            if value is not None:
                yield name, value


def _unpacked(data: memoryview, room: int) -> bytes:
    machine = zlib.decompressobj()
    try:
        unpacked = machine.decompress(data, room + 1)
    except zlib.error:
        raise ValueError("a compressed array in it is damaged") from None
    if len(unpacked) > room:
        raise ValueError(f"unpacked it is larger than {LARGEST_TABLE / 1e6:g} MB")
    if not machine.eof:
        raise ValueError("a compressed array in it is cut off")
    return unpacked


def _elements(data: memoryview, order: str) -> Iterator[tuple[int, memoryview]]:
    """Kinds and contents of elements, one behind the other; each begins at eight bytes, compressed ones anywhere."""
    at = 0
    while at < len(data):
        kind, size = unpack_from(order + "II", data, at)
        if kind >> 16:  # a small one: its size and kind share four bytes, its content takes the other four
            kind, size, start, end = kind & 0xFFFF, kind >> 16, at + 4, at + 8
            fits = size <= 4
        else:
            start = at + 8
            end = start + size + (0 if kind == COMPRESSED else -size % 8)
            fits = start + size <= len(data)
        if not fits:
            raise ValueError("an element in it goes beyond its end")
        yield kind, data[start : start + size]
        at = end


def _array(data: memoryview, order: str, wanted: Wanted, depth: int) -> tuple[str, Any]:
    """Name and value of an array; no value where it is not wanted."""
    if not len(data):
        return "", np.zeros((0, 0))
    parts = _elements(data, order)
    flags = _next(parts, (6,))[1]
    what = unpack_from(order + "I", flags)[0]
    number = what & 0xFF
    shape = () if number == OPAQUE else tuple(_stored(*_next(parts, (5,)), order).tolist())
    name = bytes(_next(parts, (1, TEXT_8))[1]).decode("utf-8", errors="replace")
    if depth == 0 and not wanted(name):
        return name, None
    if number in OTHERS:
        raise ValueError(f"{name or 'a cell'} is {OTHERS[number]}, not numbers, or texts in single quotes in a cell")
    if len(shape) > 32 or any(n < 0 for n in shape):
        raise ValueError(f"{name} has no shape")
    count = math.prod(shape)
    if number == CELLS:
        return name, _cells(parts, order, count, depth).reshape(shape, order="F")
    if number == LETTERS:
        return name, _rows(*_next(parts, None), order, shape)
    if number not in NUMBERS:
        raise ValueError(f"{name} is of a class that is not known")
    value = _numbers(parts, order, count)
    if what & COMPLEX:
        value = _complex(value, _numbers(parts, order, count))
    return name, value.reshape(shape, order="F")


def _next(parts: Iterator[tuple[int, memoryview]], kinds: tuple[int, ...] | None) -> tuple[int, memoryview]:
    """Next piece, of one of some kinds."""
    kind, data = next(parts, (0, memoryview(b"")))
    if kind == 0 or (kinds is not None and kind not in kinds):
        raise ValueError("an array in it lacks a part")
    return kind, data


def _stored(kind: int, data: memoryview, order: str) -> np.ndarray:
    if kind not in STORED:
        raise ValueError("an array in it has numbers of a kind that is not known")
    stored = np.dtype(order + STORED[kind])
    if len(data) % stored.itemsize:
        raise ValueError("its sizes do not fit what is in it")
    return np.frombuffer(data, stored)


def _numbers(parts: Iterator[tuple[int, memoryview]], order: str, count: int) -> np.ndarray:
    found = _stored(*_next(parts, None), order)
    _claimed(count, 1, len(found))
    return found


def _complex(real: np.ndarray, imaginary: np.ndarray) -> np.ndarray:
    """Numbers of two parts; a sum would make infinite ones undefined."""
    whole = np.empty(real.shape, dtype=np.complex128)
    whole.real, whole.imag = real, imaginary
    return whole


def _cells(parts: Iterator[tuple[int, memoryview]], order: str, count: int, depth: int) -> np.ndarray:
    if depth >= DEEPEST:
        raise ValueError("its cells are too deep")
    if count > MOST_MEMBERS:
        raise ValueError(f"it has more than {MOST_MEMBERS} cells")
    cells = np.empty(count, dtype=object)
    for i in range(count):
        cells[i] = _array(_next(parts, (MATRIX,))[1], order, lambda _: True, depth + 1)[1]
    return cells


def _rows(kind: int, data: memoryview, order: str, shape: tuple[int, ...]) -> np.ndarray:
    """Texts of the rows of an array of letters."""
    big = "-be" if order == ">" else "-le"
    coding = {1: "latin-1", 2: "latin-1", 4: "utf-16" + big, TEXT_8: "utf-8", TEXT_16: "utf-16" + big,
              TEXT_32: "utf-32" + big}.get(kind)  # fmt: skip
    if coding is None or len(shape) != 2:
        raise ValueError("a text in it cannot be read")
    return _lines(bytes(data).decode(coding), *shape)


def _lines(letters: str, rows: int, columns: int) -> np.ndarray:
    """Rows of letters that stand column by column."""
    if rows == 1:  # letters of two bytes, and such that need two of them, are counted in different ways
        return np.array([letters])
    _claimed(rows * columns, 1, len(letters))
    return np.array(["".join(letters[i::rows]) for i in range(rows)], dtype=str)


def _version_4(content: bytes, wanted: Wanted) -> Iterator[tuple[str, Any]]:
    order = next((one for one in "<>" if 0 <= unpack_from(one + "i", content)[0] < 5000), None)
    if order is None:
        raise ValueError("it is no file of MATLAB")
    at = 0
    while at < len(content):
        kind, rows, columns, has_imaginary, length = unpack_from(order + "5i", content, at)
        stored, what = kind // 10 % 10, kind % 10
        if not (0 <= kind < 5000 and kind // 100 % 10 == 0 and stored < len(STORED_4) and what < 3):
            raise ValueError("it is no file of MATLAB, or damaged")
        if min(rows, columns, has_imaginary, length) < 0 or has_imaginary > 1:
            raise ValueError("an array in it has no shape")
        numbers = np.dtype(order + STORED_4[stored])
        count = rows * columns * (1 + has_imaginary)
        start, end = at + 20 + length, at + 20 + length + count * numbers.itemsize
        if end > len(content):
            raise ValueError("it is cut off")
        _claimed(count, numbers.itemsize, end - start)
        name = content[at + 20 : start].rstrip(b"\0").decode("latin-1")
        if wanted(name):
            if what == 2:
                raise ValueError(f"{name} is a sparse matrix; write a full one")
            yield name, _of_version_4(np.frombuffer(content, numbers, count, start), rows, columns, what == 1)
        at = end


def _of_version_4(flat: np.ndarray, rows: int, columns: int, letters: bool) -> np.ndarray:
    if letters:
        if flat.size and not (np.isfinite(flat).all() and 0 <= flat.min() and flat.max() < 0xD800):
            raise ValueError("a text in it cannot be read")
        return _lines("".join(map(chr, flat.astype(int).tolist())), rows, columns)
    parts = flat.reshape(-1, columns, rows) if flat.size else np.zeros((1, columns, rows))
    return (_complex(*parts) if len(parts) == 2 else parts[0]).T
