"""Measured frequency responses from files: universal files of datasets 58, CSV, MATLAB."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from flexapod.arrays import Array
from flexapod.errors import InputError
from flexapod.runtime.files import LARGEST_TABLE, path_of, read_bytes
from flexapod.schema.csv_tables import table_lines
from flexapod.units import to_si

if TYPE_CHECKING:
    from xarray import Dataset

__all__ = ["read_frf"]

RESPONSE = 4  # function type of a frequency response
REAL, COMPLEX = (2, 4), (5, 6)  # ordinate data types, single and double
DIRECTIONS = ("", "x", "y", "z", "rx", "ry", "rz")
HEAD = 11  # lines of a dataset 58 before its numbers
FIRST = "frequency [Hz],tool:z/wrench:fz real,tool:z/wrench:fz imag"  # line of a table
SAME = 1e-6  # relative: frequencies of responses that stand beside each other


@dataclass(frozen=True, kw_only=True)
class Response:
    """One response: frequencies (f,) [Hz], values (f,), names and units of output and input."""

    frequency: Array
    values: NDArray[np.complex128]
    output: str
    input: str
    units: tuple[str, str] = ("1", "1")


def read_frf(path: str | Path) -> Dataset:
    r"""Frequency responses of a file, as those of a linear system.

    Parameters
    ----------
    path : path
        ``.uff``, ``.unv``, ``.58``: ASCII datasets 58 whose function is a frequency response. ``.csv``: a line of
        names, then frequency [Hz], or in the unit of its name, ``f [kHz]``, and for each response two columns, ``real``
        and ``imag`` or ``magnitude`` (``[dB]``) and ``phase [deg]``; names before them say which, as
        ``tool:z/wrench:fz real``. ``.mat``: ``frequency`` [Hz] and
        ``frf`` (outputs, inputs, f), (outputs, f) or (f,), complex, with ``outputs``, ``inputs``, ``output_units``,
        ``input_units`` or without.

    Returns
    -------
    xarray.Dataset
        `frequency_response` (output, input, frequency, part); channels that were not measured are NaN.

    Raises
    ------
    InputError
        A file that cannot be read, or without responses, or with frequencies that differ.

    Examples
    --------
    >>> from pathlib import Path
    >>> names = "frequency,tool:z/wrench:fz real,tool:z/wrench:fz imag"
    >>> _ = Path("measured.csv").write_text(names + "\n10,4.0e-9,-1e-11\n20,4.1e-9,-2e-11\n")
    >>> data = fx.read_frf("measured.csv")
    >>> print(data.frequency_response.sel(output="tool:z", input="wrench:fz", part="real").values)
    [4.0e-09 4.1e-09]
    """
    path = path_of(path, "path")
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError("is not a format of responses", file=path, allowed=", ".join(READERS))
    try:
        content = read_bytes(path, LARGEST_TABLE)
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", file=path) from None
    try:
        found = reader(content)
    except InputError as error:
        raise error.located(file=path) from None
    except (ValueError, IndexError, KeyError) as error:
        raise InputError(f"cannot be understood: {error}", file=path) from None
    if not found:
        raise InputError("holds no frequency response", file=path, allowed="at least one")
    return _together(found, path)


def _together(found: list[Response], path: Path) -> Dataset:
    from flexapod.control.datasets import frf_dataset

    f = found[0].frequency
    if not f.size:
        raise InputError("has no frequency", file=path, allowed="one at least")
    if any(np.isinf(one.values).any() for one in found):
        raise InputError("has responses that are infinite", file=path)
    if not np.isfinite(f).all():
        raise InputError("has frequencies that are not finite", file=path)
    for one in found[1:]:
        if len(one.frequency) != len(f) or np.abs(one.frequency - f).max() > SAME * np.abs(f).max():
            raise InputError(
                f"has other frequencies for {one.output} by {one.input} than for {found[0].output} by {found[0].input}",
                file=path, allowed="the same frequencies for all responses",
            )  # fmt: skip
    outputs, inputs = (list(dict.fromkeys(getattr(one, key) for one in found)) for key in ("output", "input"))
    values = np.full((len(outputs), len(inputs), len(f)), np.nan + 0j)
    units = {}
    for one in found:
        if not np.isnan(values[outputs.index(one.output), inputs.index(one.input)]).all():
            raise InputError(f"has {one.output} by {one.input} twice", file=path, allowed="each response once")
        values[outputs.index(one.output), inputs.index(one.input)] = one.values
        units |= {one.output: one.units[0], one.input: one.units[1]}
    return frf_dataset(f, values, tuple(outputs), tuple(inputs), units)


def _universal(content: bytes) -> list[Response]:
    lines = content.decode("ascii", errors="replace").splitlines()
    found, at = [], 0
    while at < len(lines):
        if lines[at].strip() == "-1" and at + 1 < len(lines) and lines[at + 1].strip()[:3] in ("58", "58b"):
            if lines[at + 1].strip().startswith("58b"):
                raise InputError("is a binary dataset 58", allowed="ASCII", next_step="Write it as ASCII")
            end = next((k for k in range(at + 2, len(lines)) if lines[k].strip() == "-1"), None)
            if end is None or end < at + 2 + HEAD:
                raise InputError(
                    "ends within a dataset 58", key=f"line {at + 2}", next_step="It is cut off: copy it again"
                )
            one = _dataset_58(lines[at + 2 : end])
            found += [one] if one is not None else []
            at = end
        at += 1
    return found


def _dataset_58(lines: list[str]) -> Response | None:
    """A dataset of eleven lines and its numbers; None of another function than a response."""
    ids = lines[5]
    if int(ids[:5]) != RESPONSE:
        return None
    frequency: Array
    names = [part.strip() for part in lines[0].split(" / ")]
    if len(names) != 2 or not all(names):
        names = [_channel(ids[31:41], ids[41:51], ids[51:55]), _channel(ids[56:66], ids[66:76], ids[76:80])]
    kind, count, even = (int(lines[6][k : k + 10]) for k in (0, 10, 20))
    start, step = float(lines[6][30:43]), float(lines[6][43:56])
    width = 20 if kind in (4, 6) else 13
    numbers = _numbers(lines[HEAD:], width, kind, bool(even))
    units = tuple(line[47:67].strip() or "1" for line in (lines[8], lines[9]))
    if kind not in (*COMPLEX, *REAL):
        raise InputError("has ordinates of an unknown type", key="58", value=kind, allowed="2, 4, 5, 6")
    columns = (2 if kind in COMPLEX else 1) + (0 if even else 1)
    if count < 1 or len(numbers) < columns * count:
        raise InputError(f"has {len(numbers) // columns} of {count} values", key="58")
    rows = numbers[: columns * count].reshape(count, columns)
    frequency = np.asarray(start + step * np.arange(count) if even else rows[:, 0], dtype=float)
    values = rows[:, -2] + 1j * rows[:, -1] if kind in COMPLEX else rows[:, -1].astype(complex)
    units = tuple("1" if unit == "NONE" else unit for unit in units)
    return Response(frequency=frequency, values=values, output=names[0], input=names[1], units=(units[0], units[1]))


def _channel(entity: str, node: str, direction: str) -> str:
    """A name of what the format has for a channel: entity and node, direction with its sign."""
    where = entity.strip() if entity.strip() not in ("", "NONE") else "node"
    axis = int(direction or 0)
    sign = "-" if axis < 0 else ""
    return f"{where} {int(node or 0)}:{sign}{DIRECTIONS[abs(axis)]}" if axis else f"{where} {int(node or 0)}"


def _numbers(lines: list[str], width: int, kind: int, even: bool) -> Array:
    """Numbers of the data lines: columns of the format, or where these do not hold separated by blanks.

    Abscissas of uneven data have 13 columns.
    """
    found: list[float] = []
    for line in lines:
        if not line.strip():
            continue
        if even:
            parts = [line[k : k + width] for k in range(0, len(line.rstrip()), width)]
        else:
            parts, k, group = [], 0, (13, width, width) if kind in COMPLEX else (13, width)
            while k < len(line.rstrip()):
                parts.append(line[k : k + group[len(parts) % len(group)]])
                k += group[(len(parts) - 1) % len(group)]
        try:
            found += [float(part.replace("D", "E")) for part in parts if part.strip()]
        except ValueError:
            found += [float(part.replace("D", "E")) for part in line.split()]
    return np.array(found)


def _csv(content: bytes) -> list[Response]:
    rows = table_lines(Path(), _text(content))
    if not rows:
        raise InputError("is empty", next_step="First line: " + FIRST)
    heads = [cell.strip() for cell in rows[0][1]]
    if len(heads) < 3 and any(mark in heads[0] for mark in (";", "\t")):
        words = "has semicolons or tabs between its columns"
        raise InputError(words, key=f"line {rows[0][0]}", allowed="commas; before decimals points")
    if len(heads) < 3 or len(heads) % 2 == 0 or len(rows) < 2:
        raise InputError(
            f"has {len(heads)} columns" if len(rows) > 1 else "has no line of numbers",
            key="columns",
            allowed="frequency, then two of each response: real, imag, or magnitude, phase [deg]",
        )
    table = np.array([_row(number, cells, heads) for number, cells in rows[1:]])
    frequency = table[:, 0] * _hertz(heads[0])
    return [_pair(frequency, heads, table, k) for k in range(1, len(heads), 2)]


def _text(content: bytes) -> str:
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError("is not UTF-8 text", next_step="Save it as CSV in UTF-8") from None


def _row(number: int, cells: list[str], heads: list[str]) -> list[float]:
    """Numbers of a line; of a response that was not measured nan."""
    if len(cells) != len(heads):
        raise InputError(f"has {len(cells)} cells for {len(heads)} columns", key=f"line {number}")
    row = []
    for head, cell in zip(heads, cells, strict=True):
        try:
            row.append(float(cell))
        except ValueError:
            raise InputError("is no number", key=f"line {number}, column {head!r}", value=cell) from None
    return row


def _hertz(head: str) -> float:
    """Factor of the column of frequencies, whose name may have a unit: ``f [kHz]``."""
    unit = head.rpartition("[")[2].removesuffix("]").strip() if head.endswith("]") else "Hz"
    return to_si(f"1 {unit}", "frequency", key=f"column {head!r}")


def _pair(frequency: Array, heads: list[str], table: Array, k: int) -> Response:
    """The response in two columns."""
    one, other = heads[k].lower(), heads[k + 1].lower()
    a, b = table[:, k], table[:, k + 1]
    names = [head.partition(" ")[0] if "/" in head else None for head in heads[k : k + 2]]
    if None not in names and names[0] != names[1]:
        raise InputError(f"has the columns {heads[k]!r}, {heads[k + 1]!r}", allowed="two columns of each response")
    if any(word.startswith("im") or word.endswith("imag") for word in re.split("[^a-z]+", other)):
        values = a + 1j * b
    elif "phase" in other or "angle" in other:
        turn = b if "rad" in other else np.radians(b)
        size = 10 ** (a / 20) if "db" in one.split("[")[-1] else a
        values = size * np.exp(1j * turn)
    else:
        words = "real, imag, or magnitude, phase"
        raise InputError(f"has the columns {heads[k]!r}, {heads[k + 1]!r}", allowed=words)
    output, _, input = (names[0] or "").partition("/")
    labels = (output or f"response {(k + 1) // 2}", input or "input")
    return Response(frequency=frequency, values=values.astype(complex), output=labels[0], input=labels[1])


def _mat(content: bytes) -> list[Response]:
    from io import BytesIO

    from scipy.io import loadmat

    try:
        data = loadmat(BytesIO(content))
    except Exception as error:  # scipy lets errors of any kind out of files that are damaged
        newer = "v7.3" in str(error)
        words = "is of MATLAB 7.3" if newer else f"cannot be read: {error}"
        raise InputError(words, allowed="versions 4 and 5", next_step='Save it with "-v7"' if newer else None) from None
    names = {key: next((k for k in data if k.lower() in words), None) for key, words in WORDS.items()}
    if names["frequency"] is None or names["frf"] is None:
        raise InputError("lacks a variable", allowed="frequency and frf, with outputs, inputs, or without")
    f, H = _numeric(data, names["frequency"], float).ravel(), _numeric(data, names["frf"], complex)
    H = H.reshape(1, 1, -1) if H.size == len(f) else H[:, None] if H.ndim == 2 else H
    if H.ndim != 3 or H.shape[2] != len(f):
        raise InputError(f"has the shape {H.shape}", key=names["frf"], allowed=f"(outputs, inputs, {len(f)})")

    def texts(key: str, count: int, plain: str) -> list[str]:
        given = data.get(key)
        if given is None:
            return [plain.format(i + 1) for i in range(count)]
        if np.size(given) != count:
            raise InputError(f"has {np.size(given)} names", key=key, allowed=f"{count}, one for each")
        return [
            str(np.ravel(cell)[0]) if np.size(cell) else plain.format(i + 1) for i, cell in enumerate(np.ravel(given))
        ]

    outputs, inputs = texts("outputs", H.shape[0], "response {}"), texts("inputs", H.shape[1], "input {}")
    top, bottom = texts("output_units", H.shape[0], "1"), texts("input_units", H.shape[1], "1")
    return [
        Response(frequency=f, values=H[i, j], output=outputs[i], input=inputs[j], units=(top[i], bottom[j]))
        for i in range(H.shape[0])
        for j in range(H.shape[1])
    ]


def _numeric(data: Mapping[str, object], name: str, kind: type) -> np.ndarray:
    try:
        return np.asarray(data[name], dtype=kind)
    except (TypeError, ValueError):
        raise InputError("is no array of numbers", key=name) from None


WORDS = {"frequency": ("frequency", "freq", "f", "hz"), "frf": ("frf", "h", "response", "frequency_response")}
READERS: dict[str, Callable[[bytes], list[Response]]] = {
    ".uff": _universal,
    ".unv": _universal,
    ".58": _universal,
    ".csv": _csv,
    ".mat": _mat,
}
