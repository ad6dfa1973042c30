"""Measured frequency responses and damping: files of responses, and poles of a recorded ring-down.

Files are universal files of dataset 58, CSV and MATLAB.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexapod.common.arguments import integer
from flexapod.common.arrays import Array, floats
from flexapod.common.errors import InputError
from flexapod.common.files import LARGEST_TABLE, path_of, read_bytes
from flexapod.common.tables.array_files import mat_arrays, texts_of
from flexapod.control.discretization import period_of
from flexapod.control.response_tables import Response, table_responses

if TYPE_CHECKING:
    from xarray import Dataset

RESPONSE = 4  # function type of a frequency response
REAL, COMPLEX = (2, 4), (5, 6)  # ordinate data types, single and double
DIRECTIONS = ("", "x", "y", "z", "rx", "ry", "rz")
HEAD = 11  # lines of a dataset 58 before its numbers
MOST_VALUES = 20_000_000  # of all outputs by all inputs: 320 MB
SAME = 1e-6  # relative: frequencies of responses that stand beside each other


def read_frf(path: str | Path) -> Dataset:
    r"""Frequency responses of a file, as those of a linear system.

    Parameters
    ----------
    path : path
        ``.uff``, ``.unv``, ``.58``: ASCII datasets 58 whose function is a frequency response. ``.csv``: a line of
        names, then ``frequency [Hz]`` (``f``, ``freq``; in another unit, ``f [kHz]``), and for each response two
        columns. Each is named NAME WORD [UNIT]: ``real`` and ``imag``, both in one unit, or ``magnitude`` and ``phase
        [deg]`` (or ``[rad]``, ``[mrad]``); names say which, as ``tool:z/wrench:fz real``. Units are those of the
        output over the input, ``[um/N]``, ``[(m/s^2)/N]``, ``[rad/(N m)]``, for magnitudes also ``[dB]`` or ``[dB re 1
        um/N]``; values become SI ones, without a unit they are taken as they are. ``.mat``: ``frequency`` [Hz] and
        ``frf`` (outputs, inputs, f), (outputs, f) or (f,), complex, with ``outputs``, ``inputs``, ``output_units``,
        ``input_units`` or without. Frequencies rise from 0 or more.

    Returns
    -------
    xarray.Dataset
        `frequency_response` (output, input, frequency, part); channels that were not measured are NaN.

    Raises
    ------
    InputError
        A file that cannot be read, or without responses, or with frequencies that differ or do not rise.

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
        raise error.with_location(file=path) from None
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
    _check_rise(f, path)
    for one in found[1:]:
        if len(one.frequency) != len(f) or np.abs(one.frequency - f).max() > SAME * np.abs(f).max():
            raise InputError(
                f"has other frequencies for {one.output} by {one.input} than for {found[0].output} by {found[0].input}",
                file=path, allowed="the same frequencies for all responses",
            )  # fmt: skip
    outputs, inputs = (_units(found, side, path) for side in ("output", "input"))
    if len(outputs) * len(inputs) * len(f) > MOST_VALUES:
        words = f"has {len(outputs)} outputs by {len(inputs)} inputs at {len(f)} frequencies"
        raise InputError(words, file=path, allowed=f"at most {MOST_VALUES} values of all together")
    row, column = ({name: i for i, name in enumerate(names)} for names in (outputs, inputs))
    values = np.full((len(outputs), len(inputs), len(f)), np.nan + 0j)
    for one in found:
        at = row[one.output], column[one.input]
        if not np.isnan(values[at]).all():
            raise InputError(f"has {one.output} by {one.input} twice", file=path, allowed="each response once")
        values[at] = one.values
    try:
        return frf_dataset(f, values, outputs, inputs)
    except InputError as error:
        raise error.with_location(file=path) from None


def _units(found: list[Response], side: str, path: Path) -> dict[str, str]:
    """Units of outputs or inputs by name, in the order of the file."""
    units: dict[str, str] = {}
    for one in found:
        name, unit = getattr(one, side), one.units[side == "input"]
        if units.setdefault(name, unit) != unit:
            words = f"has the {side} {name} in {units[name]} and in {unit}"
            raise InputError(words, file=path, allowed="one unit for each channel, in all of its responses")
    return units


def _check_rise(f: Array, path: Path) -> None:
    """Refuse frequencies below 0 and such that do not rise."""
    wrong = np.flatnonzero(np.diff(f) <= 0)
    if f[0] >= 0 and not wrong.size:
        return
    at = 0 if f[0] < 0 else int(wrong[0]) + 1
    what = "is below 0" if at == 0 else "is not above the one before it"
    raise InputError(
        what, file=path, key=f"frequency {at + 1}", value=float(f[at]), allowed="frequencies from 0 Hz on that rise",
        next_step="Sort the lines, and leave out doubles and negative frequencies",
    )  # fmt: skip


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


def _mat(content: bytes) -> list[Response]:
    try:
        data = mat_arrays(content, lambda name: name.lower() in KNOWN or name in LABELS)
    except ValueError as error:
        newer = "7.3" in str(error)
        words = f"cannot be read: {error}"
        raise InputError(words, allowed="versions 4 and 5", next_step='Save it with "-v7"' if newer else None) from None
    names = {key: next((k for k in data if k.lower() in words), None) for key, words in WORDS.items()}
    if names["frequency"] is None or names["frf"] is None:
        raise InputError("lacks a variable", allowed="frequency and frf, with outputs, inputs, or without")
    f, H = _numbers_of(data, names["frequency"], real=True).ravel(), _numbers_of(data, names["frf"], real=False)
    H = H.reshape(1, 1, -1) if H.size == len(f) else H[:, None] if H.ndim == 2 else H
    if H.ndim != 3 or H.shape[2] != len(f):
        raise InputError(f"has the shape {H.shape}", key=names["frf"], allowed=f"(outputs, inputs, {len(f)})")

    def texts(key: str, count: int, plain: str) -> list[str]:
        found = texts_of(data.get(key, [""] * count))
        if found is None:
            raise InputError("are no texts", key=key, allowed="a cell of texts, or rows of letters")
        if len(found) != count:
            raise InputError(f"has {len(found)} names", key=key, allowed=f"{count}, one for each")
        return [text or plain.format(i + 1) for i, text in enumerate(found)]

    outputs, inputs = texts("outputs", H.shape[0], "response {}"), texts("inputs", H.shape[1], "input {}")
    top, bottom = texts("output_units", H.shape[0], "1"), texts("input_units", H.shape[1], "1")
    return [
        Response(frequency=f, values=H[i, j], output=outputs[i], input=inputs[j], units=(top[i], bottom[j]))
        for i in range(H.shape[0])
        for j in range(H.shape[1])
    ]


def _numbers_of(data: Mapping[str, Any], name: str, *, real: bool) -> np.ndarray:
    """Real or complex numbers of a variable."""
    try:
        if data[name].dtype.kind not in "biufc":
            raise ValueError
        return floats(data[name]) if real else np.asarray(data[name], dtype=np.complex128)
    except ValueError:
        raise InputError("is no array of numbers", key=name, allowed="real ones" if real else None) from None


WORDS = {"frequency": ("frequency", "freq", "f", "hz"), "frf": ("frf", "h", "response", "frequency_response")}
KNOWN = {word for words in WORDS.values() for word in words}
LABELS = ("outputs", "inputs", "output_units", "input_units")
READERS: dict[str, Callable[[bytes], list[Response]]] = {
    ".uff": _universal,
    ".unv": _universal,
    ".58": _universal,
    ".csv": table_responses,
    ".mat": _mat,
}


LONGEST = 200  # samples in a window: enough for the slowest of some ten vibrations


def ring_down(samples: ArrayLike, period: float | str, order: int = 10) -> NDArray[np.complex128]:
    """Poles of a free vibration by its samples, Eq. (T26.9), the slowest first, (any,) [1/s].

    Parameters
    ----------
    samples : array_like, shape (T,) or (T, m)
        Equally spaced, while nothing but the controller acts; a constant does not count.
    period : float or str
        Time between them [s], or their rate.
    order : int
        Number of poles: two of each vibration that shows. More than there are take up noise.

    Returns
    -------
    ndarray
        Those that a pair of conjugates has above the real axis, and real ones.

    Raises
    ------
    InputError
        Too few samples.
    """
    T = period_of(period)
    try:
        x = np.atleast_1d(floats(samples))
    except ValueError:
        x = np.full(1, np.nan)
    if not x.size or not np.isfinite(x).all():
        raise InputError("are no finite numbers", key="samples", allowed="(T,) or (T, m), equally spaced")
    order = integer(order, "order", 1, 2 * LONGEST)
    x = np.diff(x.reshape(len(x), -1), axis=0)
    length = min(len(x) // 2, LONGEST)
    if length * x.shape[1] <= order:
        raise InputError("are too few", key="samples", value=len(x) + 1, allowed=f"more than {2 * order + 2}")
    windows = np.stack([x[k : len(x) - length + k + 1] for k in range(length)], axis=0)  # (length, any, m)
    hankel = windows.transpose(0, 2, 1).reshape(length * x.shape[1], -1)
    U = np.linalg.svd(hankel, full_matrices=False)[0][:, :order]
    step = np.linalg.lstsq(U[: -x.shape[1]], U[x.shape[1] :], rcond=None)[0]
    z = np.linalg.eigvals(step).astype(np.complex128)
    poles = np.asarray(np.log(z[np.abs(z) > np.finfo(float).tiny]) / T, dtype=np.complex128)
    poles = poles[np.imag(poles) >= 0]
    return poles[np.argsort(np.abs(poles), kind="stable")]
