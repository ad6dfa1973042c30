"""CSV tables with units in the header. Data only: interpolation belongs to those who use it."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Iterable, Mapping
from functools import lru_cache
from pathlib import Path

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import LONGEST_QUOTE, InputError, quote_text, suggest_word
from flexapod.common.files import LARGEST_TABLE, read_text
from flexapod.common.tables.named_files import Content, UnreadableFile
from flexapod.common.units import DIMENSIONS, to_si

POSE = {"surge": "length", "sway": "length", "heave": "length", "roll": "angle", "pitch": "angle", "yaw": "angle"}
WRENCH = {"Fx": "force", "Fy": "force", "Fz": "force", "Mx": "torque", "My": "torque", "Mz": "torque"}

LONGEST_UNIT = 40  # letters; the longest that is written out, (rad/s^2)^2/Hz, has 14
MOST_KEPT = 2_000_000  # letters of a table that is kept for the next time it is read
_HEADER = re.compile(r"^\s*(.+?)\s*\[\s*(.+?)\s*\]\s*$")


def read_table(
    path: Path, columns: Mapping[str, str], *, needed: bool = False, jumps: bool = False, along: str = "time"
) -> dict[str, Array]:
    """Columns of a CSV file in SI units, by name.

    The header names each column with its unit, ``time [s], roll [deg]``. Lines that start with # are comments.

    Parameters
    ----------
    path : Path
        The file.
    columns : Mapping
        Allowed columns besides the first and their dimension (see `flexapod.common.units`).
    needed : bool
        Whether all of them must be there; otherwise at least one.
    jumps : bool
        Whether two rows may stand at one instant: before and after a jump.
    along : str
        The first column, ``time`` or ``frequency``.

    Returns
    -------
    dict
        The first and the columns found, each (n,), SI.

    Raises
    ------
    InputError
        If the file cannot be read, a column is unknown or missing, a cell is empty or no finite number, or the
        instants do not start at 0 and increase, apart from ``jumps``, or a spectrum is none; with the line number.
    """
    try:
        text = read_text(path, LARGEST_TABLE)
    except OSError as error:
        raise _unreadable(path, str(error.strerror)) from None
    read = _read if len(text) < MOST_KEPT else _read.__wrapped__
    return dict(read(path, text, tuple(columns.items()), needed=needed, jumps=jumps, along=along))


@lru_cache(maxsize=16)  # a sweep reads the tables of its study at every point
def _read(
    path: Path, text: str, allowed: tuple[tuple[str, str], ...], *, needed: bool, jumps: bool, along: str
) -> dict[str, Array]:
    lines, columns = table_lines(path, text), dict(allowed)
    if not lines:
        raise InputError("is empty", file=path, next_step=f"First line: {header(columns, along)}")
    number, cells = lines[0]
    factors = _header(path, number, cells, {along: along, **columns})
    missing = [name for name in (along, *columns) if name not in factors]
    if along in missing or (needed and missing) or len(missing) == len(columns):
        raise InputError(
            f"has no column {missing[0]!r}", file=path, key=f"line {number}", allowed=header(columns, along)
        )
    values = np.array([_row(path, n, row, list(factors)) for n, row in lines[1:]]).reshape(-1, len(factors))
    table = {name: values[:, i] * factor for i, (name, factor) in enumerate(factors.items())}
    if along == "time":
        _check_times(path, table["time"], [n for n, _ in lines[1:]], jumps)
    for column in table.values():
        column.flags.writeable = False
    return table


def table_lines(path: Path | None, text: str) -> list[tuple[int, list[str]]]:
    """Cells of the lines that are neither empty nor comments, with their numbers."""
    try:
        rows = list(enumerate(csv.reader(io.StringIO(text, newline="")), start=1))
    except csv.Error:
        raise _unreadable(path, "it is not a text table") from None
    return [(n, row) for n, row in rows if any(cell.strip() for cell in row) and not row[0].lstrip().startswith("#")]


def _unreadable(path: Path | None, why: str) -> UnreadableFile:
    return UnreadableFile(f"cannot be read: {why}", file=path, next_step="Give its place relative to the study file")


def _header(path: Path, line: int, cells: list[str], dimensions: Mapping[str, str]) -> dict[str, float]:
    factors: dict[str, float] = {}
    for cell in cells:
        match = _HEADER.match(cell)
        if match is None:
            raise InputError(
                "has no unit in the header",
                file=path,
                key=f"line {line}, column {quote_text(cell.strip())}",
                allowed="name [unit]",
            )
        name, unit = match[1], match[2]
        if name not in dimensions:
            raise InputError(
                f"has an unknown column {quote_text(name)}",
                file=path,
                key=f"line {line}",
                allowed=", ".join(dimensions),
                next_step=suggest_word(name[:LONGEST_QUOTE], dimensions),
            )
        if len(unit) > LONGEST_UNIT:
            raise InputError(
                "has an unknown unit", file=path, key=f"line {line}, column {name!r}", value=unit[:LONGEST_QUOTE]
            )
        if name in factors:
            raise InputError(f"has the column {name!r} twice", file=path, key=f"line {line}")
        try:
            factors[name] = to_si(f"1 {unit}", dimensions[name], key=f"line {line}, column {name!r}")
        except InputError as error:
            raise error.with_location(file=path) from None
    return factors


def _row(path: Path, line: int, cells: list[str], names: list[str]) -> list[float]:
    if len(cells) != len(names):
        raise InputError(f"has {len(cells)} cells for {len(names)} columns", file=path, key=f"line {line}")
    row = []
    for name, cell in zip(names, cells, strict=True):
        try:
            value = float(cell)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            raise InputError(
                "is empty or no finite number",
                file=path,
                key=f"line {line}, column {name!r}",
                value=cell[:LONGEST_QUOTE],
                next_step="Fill the gap or remove the line",
            )
        row.append(value)
    return row


def wrong_instant(time: Array, jumps: bool) -> int | None:
    """Index of the first instant that is not later than the one before it; with `jumps` two may be the same."""
    fine = np.diff(time) > 0.999 * DIMENSIONS["time"].least  # a difference of two instants is rounded
    if jumps:
        fine |= (np.diff(time) == 0) & np.append(True, fine[:-1])
    return None if fine.all() else int(np.argmin(fine)) + 1


def _check_times(path: Path, time: Array, lines: list[int], jumps: bool) -> None:
    if len(time) < 2:
        raise InputError("has fewer than two rows of numbers", file=path)
    if time[0] != 0:
        raise InputError(
            "does not start at 0",
            file=path,
            key=f"line {lines[0]}, column 'time'",
            value=float(time[0]),
            next_step="Subtract the first instant from all",
        )
    at = wrong_instant(time, jumps)
    if at is not None:
        before, now = time[at - 1], time[at]
        what = "goes back in time" if now < before else "repeats the instant before"
        raise InputError(
            f"{what} once more" if jumps and now == before else what,
            file=path,
            key=f"line {lines[at]}, column 'time'",
            value=float(now),
            allowed=f"at least {DIMENSIONS['time'].least:g} s above {before:g} s",
            next_step="Two rows at one instant are a jump, a third has no meaning"
            if jumps and now == before
            else "Sort the lines by time and remove doubles",
        )


def force_columns(count: int, dimension: str = "force") -> dict[str, str]:
    """Columns of a table of the drive forces, or of cranks the torques, of so many legs."""
    return {f"leg {i}": dimension for i in range(1, count + 1)}


def header(columns: Mapping[str, str], along: str = "time") -> str:
    """First line of a table with these columns, in SI units."""
    return ", ".join(f"{name} [{DIMENSIONS[dimension].unit}]" for name, dimension in {along: along, **columns}.items())


def table_text(content: Content) -> str:
    """A CSV file of these columns, in SI units: read again they are the same, to the bit."""
    first = ", ".join(f"{name} [{DIMENSIONS[dimension].unit}]" for name, (dimension, _) in content.items())
    rows = np.column_stack([values for _, values in content.values()]).tolist()
    return "\n".join([first, *(",".join(map(repr, row)) for row in rows)]) + "\n"


def stack_columns(table: Mapping[str, Array], names: Iterable[str]) -> Array:
    """Columns of a table side by side; 0 where there is none."""
    return np.column_stack([table.get(name, np.zeros_like(table["time"])) for name in names])
