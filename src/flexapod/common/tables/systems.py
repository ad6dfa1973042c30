"""A linear system in a file: matrices A, B, C, D, names of channels, time between samples."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from flexapod.common.arrays import Array, floats
from flexapod.common.errors import InputError
from flexapod.common.files import LARGEST_TABLE, read_bytes
from flexapod.common.tables.array_files import json_arrays, mat_arrays, npz_arrays, texts_of
from flexapod.common.tables.named_files import Content, UnreadableFile

MATRICES, NAMES = ("A", "B", "C", "D"), ("inputs", "outputs")
MOST_CHANNELS = 10_000


def read_system(path: Path) -> dict[str, Any]:
    """Read A (n, n), B (n, m), C (p, n), D (p, m), `inputs`, `outputs`, `sample` [s] or None of `StateSpace.save`.

    Raises
    ------
    InputError
        The file cannot be read, something in it is missing, or sizes and names do not fit.
    """
    reader = SYSTEM_FILES.get(path.suffix.lower())
    if reader is None:
        raise UnreadableFile("is not a format of linear systems", next_step=f"Write it as {', '.join(SYSTEM_FILES)}")
    try:
        content = read_bytes(path, LARGEST_TABLE)
    except OSError as error:
        raise UnreadableFile(
            f"cannot be read: {error.strerror}", next_step="Give its place relative to the study file"
        ) from None
    try:
        data = reader(content, {*MATRICES, *NAMES, "sample"}.__contains__)
    except ValueError as error:
        raise UnreadableFile(f"cannot be read: {error}", next_step="Write it with StateSpace.save") from None
    try:
        return _checked(data)
    except InputError as error:
        raise error.with_location(file=path) from None


def system_text(content: Content) -> str:
    """A linear system as the text of a ``.json`` file."""
    parts = {name: value.tolist() if isinstance(value, np.ndarray) else value for name, (_, value) in content.items()}
    return json.dumps({name: value for name, value in parts.items() if value is not None})


def _checked(data: Mapping[str, Any]) -> dict[str, Any]:
    for name in (*MATRICES, *NAMES):
        if name not in data:
            raise InputError("is missing", key=name, allowed=f"{', '.join((*MATRICES, *NAMES))}, and sample [s] or not")
    names = {name: _names(data[name], name) for name in NAMES}
    for name, given in names.items():
        if not given or len({*given}) < len(given):
            raise InputError("are none, or one of them twice", key=name, value=", ".join(given))
    matrices = [_matrix(data[name], name) for name in MATRICES]
    n, m, p = int(np.sqrt(matrices[0].size)), len(names["inputs"]), len(names["outputs"])
    found: dict[str, Any] = dict(names)
    for name, matrix, shape in zip(MATRICES, matrices, ((n, n), (n, m), (p, n), (p, m)), strict=True):
        if matrix.shape != shape and not matrix.size == np.prod(shape) == 0:  # matrices of no states have no rows
            raise InputError(
                f"has the shape {matrix.shape}", key=name, allowed=f"{shape}: {n} states, {m} inputs, {p} outputs"
            )
        found[name] = matrix.reshape(shape)
    period = _matrix(data.get("sample", 0.0), "sample").ravel()
    if period.size != 1 or period[0] < 0:
        raise InputError("is not a time", key="sample", allowed="between samples [s]; 0 of a law in continuous time")
    return found | {"sample": float(period[0]) or None}


def _matrix(value: object, name: str) -> Array:
    try:
        found = floats(value)
    except ValueError:
        found = np.array(np.nan)
    if not np.isfinite(found).all():
        raise InputError("is no matrix of finite numbers", key=name, allowed="real numbers in rows of one length")
    return found


def _names(value: object, name: str) -> tuple[str, ...]:
    found = texts_of(value)
    if found is None:
        raise InputError("are no names", key=name, allowed="texts in a row")
    if len(found) > MOST_CHANNELS:
        raise InputError(f"are {len(found)} names", key=name, allowed=f"at most {MOST_CHANNELS}")
    return tuple(filter(None, found))


#: Readers by the end of the name.
SYSTEM_FILES: dict[str, Callable[[bytes, Callable[[str], bool]], Mapping[str, Any]]] = {
    ".npz": npz_arrays, ".mat": mat_arrays, ".json": json_arrays,
}  # fmt: skip
