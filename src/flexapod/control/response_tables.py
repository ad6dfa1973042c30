"""Frequency responses in a CSV table: the grammar of its columns, names, words and units."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.tables.csv_tables import table_lines
from flexapod.common.units import COMMON_UNITS, to_si

#: Words of a column, by what it holds; letters of both cases.
WORDS: dict[str, tuple[str, ...]] = {
    "frequency": ("frequency", "frequencies", "freq", "f", "hz"),
    "real": ("real", "re", "real part"),
    "imag": ("imag", "im", "imaginary", "imag part", "imaginary part"),
    "magnitude": ("magnitude", "mag", "amplitude", "modulus", "abs"),
    "phase": ("phase", "angle", "arg"),
}
KINDS: dict[str, str] = {word: kind for kind, words in WORDS.items() for word in words}
PAIRS = {"real": "imag", "magnitude": "phase"}
COLUMN = re.compile(
    rf"(?:(?P<name>.*?\S)[\s_]+)?(?P<word>{'|'.join(KINDS)})"
    r"(?:[\s_]*(?:\[(?P<square>[^\[\]]*)\]|\((?P<round>.*)\))|[\s_]+(?P<bare>dB|deg(?:rees)?|rad(?:ians)?|k?Hz))?",
    re.IGNORECASE,
)
DECIBELS = re.compile(
    r"dB(?:\s+(?:re|ref|rel)\.?\s+(?P<number>\d+(?:\.\d*)?(?:e[-+]?\d+)?\s+)?(?P<unit>\S.*))?", re.IGNORECASE
)
LONGEST = 1000  # letters of a name of a column
FIRST = "frequency [Hz],tool:z/wrench:fz real,tool:z/wrench:fz imag"  # line of a table
GRAMMAR = "NAME WORD [UNIT], two columns of each response: real, imag, or magnitude, phase"
#: What a channel may measure.
CHANNELS = (
    "length", "angle", "velocity", "angular rate", "acceleration", "angular acceleration", "force", "torque",
)  # fmt: skip
UNITS = {"": (1.0, "1"), "1": (1.0, "1"), "-": (1.0, "1"), "V": (1.0, "V"), "mV": (1e-3, "V")}
SI = {"length": "m", "angle": "rad", "velocity": "m/s", "angular rate": "rad/s", "acceleration": "m/s^2",
      "angular acceleration": "rad/s^2", "force": "N", "torque": "N m"}  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Response:
    """One response: frequencies (f,) [Hz], values (f,), names and units of output and input."""

    frequency: Array
    values: NDArray[np.complex128]
    output: str
    input: str
    units: tuple[str, str] = ("1", "1")


@dataclass(frozen=True, kw_only=True)
class ResponseColumn:
    """Parsed name of a column: the text `head`, the name before the word, its kind, and the unit or None."""

    head: str
    name: str
    kind: str
    unit: str | None


def table_responses(content: bytes) -> list[Response]:
    """Responses of a table: frequencies, then two columns of each, as `read_frf` says.

    Raises
    ------
    InputError
        Columns or cells that cannot be read.
    """
    rows = table_lines(None, _text(content))
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
    if np.isinf(table).any():
        raise InputError("has numbers that are infinite", allowed="finite ones, nan where a response was not measured")
    frequency = table[:, 0] * _hertz(heads[0])
    columns = [ResponseColumn(head=heads[0], name="", kind="frequency", unit=None), *map(_column, heads[1:])]
    return [
        _pair(frequency, columns[k], columns[k + 1], table[:, k : k + 2], (k + 1) // 2)
        for k in range(1, len(columns), 2)
    ]


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
    """Factor to Hz of the first column."""
    column = _read(head)
    if column is None or column.kind != "frequency":
        words = f"NAME or NAME [UNIT], NAME one of {', '.join(WORDS['frequency'])}; in Hz, or in the unit"
        raise InputError("is not a frequency", key=f"column {head[:80]!r}", allowed=words)
    return to_si(f"1 {column.unit or 'Hz'}", "frequency", key=f"column {head!r}")


def _column(head: str) -> ResponseColumn:
    column = _read(head)
    if column is None:
        raise InputError(
            "has no word that says what it holds, or more than a unit after it",
            key=f"column {head[:80]!r}", allowed=GRAMMAR, next_step="As in: " + FIRST,
        )  # fmt: skip
    return column


def _read(head: str) -> ResponseColumn | None:
    """Name, word and unit of a column; None of a text that is not of this form."""
    found = COLUMN.fullmatch(head) if len(head) <= LONGEST else None
    if found is None:
        return None
    unit = next((found[key] for key in ("square", "round", "bare") if found[key] is not None), None)
    kind = KINDS[found["word"].lower()]
    return ResponseColumn(head=head, name=found["name"] or "", kind=kind, unit=None if unit is None else unit.strip())


def _pair(frequency: Array, one: ResponseColumn, other: ResponseColumn, numbers: Array, count: int) -> Response:
    """The response in two columns, numbers (f, 2)."""
    words = f"has the columns {one.head!r}, {other.head!r}"
    if PAIRS.get(one.kind) != other.kind:
        raise InputError(words, allowed="real, imag, or magnitude, phase")
    if one.name and other.name and one.name != other.name:
        raise InputError(words, allowed="two columns of each response")
    if one.kind == "real":
        if one.unit != other.unit:
            raise InputError(words, allowed="one unit for both columns")
        factor, units = _factor(one.unit or "", one.head)
        values: NDArray[np.complex128] = np.ascontiguousarray(factor * numbers).view(np.complex128)[:, 0]
    else:
        size, units = _sizes(numbers[:, 0], one)
        turn = to_si(f"1 {other.unit or 'deg'}", "angle", key=f"column {other.head!r}")
        with np.errstate(invalid="ignore"):  # infinite times 0; what is infinite is refused with all that is
            values = (size * np.exp(1j * (numbers[:, 1] * turn))).astype(np.complex128)
    output, input = _split(one.name or other.name) or (f"response {count}", "")
    return Response(frequency=frequency, values=values, output=output, input=input or "input", units=units)


def _sizes(numbers: Array, column: ResponseColumn) -> tuple[Array, tuple[str, str]]:
    """Magnitudes in SI units, of decibels too, and the units of output and input."""
    unit = column.unit or ""
    level = DECIBELS.fullmatch(unit)
    factor, units = _factor(unit if level is None else level["unit"] or "", column.head)
    if level is None:
        return factor * numbers, units
    with np.errstate(over="ignore"):
        return float(level["number"] or 1.0) * factor * 10 ** (numbers / 20), units


def _factor(unit: str, head: str) -> tuple[float, tuple[str, str]]:
    """Factor to SI of a unit of output over input, ``um/N``, and the units of the two."""
    whole = _of_channel(unit)
    parts = None if whole is not None else _halves(unit)
    if whole is not None:
        return whole[0], (whole[1], "1")
    if parts is not None:
        output, input = _of_channel(parts[0]), _of_channel(parts[1])
        if output is not None and input is not None:
            return output[0] / input[0], (output[1], input[1])
    allowed = "dB, dB re a unit, or a unit of the output over one of the input: mm/N, (m/s^2)/N, rad/(N m), um/V"
    raise InputError(f"has a unit that is not known ({unit})", key=f"column {head!r}", allowed=allowed)


def _of_channel(unit: str) -> tuple[float, str] | None:
    """Factor to SI and SI unit of what a channel measures; None of other units."""
    unit = unit.strip()
    if unit.startswith("(") and unit.endswith(")") and _depths(unit[1:-1])[-1:] in ([], [0]):
        unit = unit[1:-1].strip()
    if unit in UNITS:
        return UNITS[unit]
    for dimension in sorted(CHANNELS, key=lambda name: unit not in COMMON_UNITS[name]):
        try:
            return to_si(f"1 {unit}", dimension), SI[dimension]
        except InputError:
            continue
    return None


def _depths(text: str) -> list[int]:
    """Number of open brackets after each letter."""
    return np.cumsum([(letter in "([") - (letter in ")]") for letter in text]).astype(int).tolist()


def _halves(unit: str) -> tuple[str, str] | None:
    """Both sides of the last slash outside of brackets; None without one."""
    slashes = [i for i, depth in enumerate(_depths(unit)) if depth == 0 and unit[i] == "/"]
    return (unit[: slashes[-1]], unit[slashes[-1] + 1 :]) if slashes else None


def _split(name: str) -> tuple[str, str] | None:
    """Output and input of a name, at its first slash outside of brackets; None without one, or without an output."""
    at = next((i for i, depth in enumerate(_depths(name)) if depth == 0 and name[i] == "/"), 0)
    return (name[:at].strip(), name[at + 1 :].strip()) if at else None
