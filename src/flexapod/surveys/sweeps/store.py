"""The results of a sweep as one Zarr store: written by one process, whole at any instant, continued when reopened."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from flexapod.errors import ComputationError, InputError
from flexapod.files import UNFINISHED, check_regular, scratch, settle
from flexapod.typing import Array

if TYPE_CHECKING:
    import zarr

FORMAT = 2
Values = NDArray[Any]  # numbers of any kind, or texts
PENDING, COMPUTED, FAILED = 0, 1, 2
CHUNK_POINTS = 2048  # of scalars
CHUNK_BYTES = 1 << 20  # of records
TEXTS = {"message": "why there is no result", "remarks": "remarks on the result, a line each"}
_NEXT = "Choose another place with --out (store in Python), or remove this one"


class Column(NamedTuple):
    """An array of the store: dimensions, shape, attributes, and values if they are known from the start."""

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    attributes: Mapping[str, Any]
    values: Values | None = None


class SweepStore:
    """An open store. Results are written first, the status of their points last.

    Parameters
    ----------
    group : zarr.Group
    path : Path, optional
        Where it is; None: in memory.
    """

    def __init__(self, group: zarr.Group, path: Path | None) -> None:
        self.group, self.path = group, path
        self._arrays = _arrays(group, path)
        self.lost = 0  # points whose status could not be read
        self.status: Values = np.zeros(self._arrays["status"].shape, dtype=np.int8)
        for rows, file in self.chunks("status"):
            try:
                self.status[rows] = self.read("status", rows)
            except Exception:  # spoilt: whatever its decoder says
                if group.read_only:
                    raise unreadable(path, "status") from None
                file.unlink(missing_ok=True)
                self.lost += rows.stop - rows.start

    @classmethod
    def create(
        cls, path: Path | None, size: int, header: Mapping[str, Any], columns: Mapping[str, Column]
    ) -> SweepStore:
        """A new store with nothing computed; it appears at `path` when it is whole.

        Raises
        ------
        ComputationError
            It cannot be written.
        """
        import zarr
        from zarr.storage import MemoryStore

        from flexapod.surveys.sweeps.disk import DurableStore

        if path is None:
            group = zarr.create_group(MemoryStore(), attributes=dict(header))
            _fill(group, size, columns)
            return cls(group, None)
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with scratch(path.parent) as folder:
                whole = folder / "store"
                _fill(zarr.create_group(DurableStore(whole), attributes=dict(header)), size, columns)
                whole.rename(path)
            settle(path.parent)
        except OSError as error:
            raise _unwritable(path, error, 0) from None
        return cls.open(path, write=True)

    @classmethod
    def open(cls, path: Path, *, write: bool = False) -> SweepStore:
        """A store that `create` made, to read it or, by who holds its lock, to write to it.

        Raises
        ------
        InputError
            There is something else, or a part is missing; to read: another version has written it, or there is a pipe
            or a device in the place of a file.
        ComputationError
            To read: the status of its points is spoilt.
        """
        import zarr

        from flexapod.surveys.sweeps.disk import DurableStore

        _only_files(path, write=write)
        try:
            place = DurableStore(path) if write and path.is_dir() else path
            group = zarr.open_group(place, mode="r+" if write else "r", use_consolidated=False)
        except (OSError, ValueError, KeyError):
            group = None
        if group is None and (path / "status").is_dir():
            raise _damaged(path / "zarr.json", "what describes the whole cannot be read")
        if group is None or "flexapod_sweep_format" not in group.attrs:
            raise InputError("is not a store of a sweep", file=path, next_step="Choose another place with --out")
        if not write and group.attrs["flexapod_sweep_format"] != FORMAT:  # `check_header` is for who goes on with it
            raise InputError(
                "was written by another version of flexapod", file=path, key="flexapod_sweep_format",
                value=group.attrs["flexapod_sweep_format"], allowed=str(FORMAT),
                next_step=f"Read it with flexapod {group.attrs.get('flexapod_version', 'of that time')}",
            )  # fmt: skip
        for rest in path.rglob(UNFINISHED) if write else ():
            rest.unlink(missing_ok=True)  # of a process that was killed while writing
        return cls(group, path)

    def dims(self, name: str) -> tuple[str, ...]:
        """Dimensions of an array."""
        return tuple(self._arrays[name].metadata.dimension_names or ())

    def read(self, name: str, rows: slice) -> Values:
        """Values of some points."""
        return np.asarray(self._arrays[name][rows])

    def chunks(self, name: str) -> Iterator[tuple[slice, Path]]:
        """Points of an array that share a file, and the file."""
        array, folder = self._arrays[name], (self.path or Path()) / name
        for number, begin in enumerate(range(0, array.shape[0], array.chunks[0])):
            key = array.metadata.encode_chunk_key((number, *(0,) * (array.ndim - 1)))
            yield slice(begin, min(begin + array.chunks[0], array.shape[0])), folder / key

    def missing(self, name: str) -> list[slice]:
        """Items of an array that are in no file."""
        return [rows for rows, file in self.chunks(name) if not file.is_file()] if self.path is not None else []

    def absent(self, name: str) -> Values:
        """Points whose values of an array are in no file, (N,)."""
        found = np.zeros(self.status.shape, dtype=bool)
        for rows in self.missing(name):
            found[rows] = True
        return found

    def whole(self, name: str) -> bool:
        """Whether an array is there and can be read."""
        try:
            return not self.missing(name) and self._arrays[name][...] is not None
        except Exception:  # whatever the decoder of a spoilt chunk says
            return False

    @property
    def coordinates(self) -> list[str]:
        """Names of what is known from the start."""
        return [name for name in self._arrays if name not in ("status", *TEXTS, *self.header["kept"].split())]

    def renew(self, columns: Mapping[str, Column]) -> None:
        """Write again what is known from the start, where it is missing or cannot be read.

        Raises
        ------
        ComputationError
            It cannot be written.
        """
        try:
            for name, column in columns.items():
                if column.values is not None and not self.whole(name):
                    for _, file in self.chunks(name):
                        file.unlink(missing_ok=True)
                    _set_all(self._arrays[name], column.values)
        except OSError as error:
            raise _unwritable(self.path, error, 0) from None

    @property
    def header(self) -> dict[str, Any]:
        """Attributes of the store."""
        return dict(self.group.attrs)

    def write(
        self, points: Values, values: Mapping[str, Array], status: Values, texts: Mapping[str, Sequence[str]]
    ) -> None:
        """Write results of points (sorted): values (n, ...) by name, then status.

        Raises
        ------
        ComputationError
            The disk is full or cannot be written to; what was written before stays valid.
        """
        try:
            for name, array in values.items():
                self._set(name, points, array)
            for name, lines in texts.items():
                self._set(name, points, np.array(lines, dtype=object))
            self._set("status", points, status)
        except OSError as error:
            done = int(np.count_nonzero(self.status))
            raise _unwritable(self.path, error, done) from None
        self.status[points] = status

    def _set(self, name: str, points: Values, values: Values) -> None:
        array = self._arrays[name]
        if points[-1] - points[0] == len(points) - 1:
            array[int(points[0]) : int(points[-1]) + 1] = values
        else:
            array.oindex[(points, *[slice(None)] * (array.ndim - 1))] = values


def _arrays(group: zarr.Group, path: Path | None) -> dict[str, Any]:
    """Arrays of the store, which write chunks of nothing too: no file means lost; refused where one is missing."""
    import zarr

    with zarr.config.set({"array.write_empty_chunks": True}):
        found = dict(group.arrays()) if path is None else {name: _array_of(group, path, name) for name in _names(path)}
    known = [name for part in ("varied", "kept") for name in str(group.attrs.get(part, "")).split()]
    for name in ("status", *TEXTS, *known):
        if name not in found:
            raise _damaged(path, f"there is no {name}")
    return found


def _only_files(path: Path, *, write: bool) -> None:
    """Refuse a store with a pipe, a device or a link to nothing: reading would never end, what is written is lost."""
    for folder, _, names in os.walk(path):
        for file in (Path(folder, name) for name in names if not os.path.isfile(os.path.join(folder, name))):
            if not write or file.name == "zarr.json":
                raise _damaged(file, "it is not a regular file")
            file.unlink(missing_ok=True)


def _names(path: Path) -> list[str]:
    """Folders of a store that hold an array, or did so once."""
    return sorted(f.name for f in path.iterdir() if (f / "c").is_dir() or os.path.lexists(f / "zarr.json"))


def _array_of(group: zarr.Group, path: Path, name: str) -> Any:
    file = path / name / "zarr.json"
    if not os.path.lexists(file):
        raise _damaged(path, f"there is no {name}")
    try:
        check_regular(file)
        found: Any = group[name]
        if found.metadata.dimension_names is not None:
            return found
    except Exception:  # whatever the reader of a spoilt description says
        pass
    raise _damaged(file, f"what describes the array {name} cannot be read")


def _damaged(path: Path | None, why: str) -> InputError:
    return InputError(f"is a damaged store of a sweep: {why}", file=path, next_step=_NEXT)


def unreadable(path: Path | None, name: str) -> ComputationError:
    """What is to be done about a spoilt chunk."""
    return ComputationError(
        f"{path}: {name} cannot be read",
        next_step="Run the sweep again with this store: it computes again what was lost",
    )


def _fill(group: zarr.Group, size: int, columns: Mapping[str, Column]) -> None:
    import zarr

    flags = {"flag_values": [PENDING, COMPUTED, FAILED], "flag_meanings": "pending computed failed"}
    made = {**columns, "status": Column(("point",), (size,), {"long_name": "state of the point", **flags})}
    for name, column in made.items():
        _array(group, name, column, np.dtype("int8") if name == "status" else np.dtype("float64"))
    for name, words in TEXTS.items():
        _array(group, name, Column(("point",), (size,), {"long_name": words}), None)
    with warnings.catch_warnings():  # all metadata in one place is what xarray looks for first
        warnings.filterwarnings("ignore", message="Consolidated metadata")
        zarr.consolidate_metadata(group.store)


def _array(group: zarr.Group, name: str, column: Column, kind: np.dtype[Any] | None) -> None:
    """An array of numbers, or of texts if `kind` is None or the values are."""
    from zarr.codecs import ZstdCodec

    values = column.values
    if values is not None:
        kind = None if values.dtype.kind in "UOT" else values.dtype
    width = 8 * int(np.prod(column.shape[1:], dtype=int))
    chunk = CHUNK_POINTS if width <= CHUNK_BYTES // CHUNK_POINTS else max(1, CHUNK_BYTES // width)
    made: Any = group.create_array(
        name,
        shape=column.shape,
        chunks=(min(chunk, column.shape[0]), *column.shape[1:]),
        dtype=str if kind is None else kind,
        compressors=ZstdCodec(checksum=True),  # what is not what was written cannot be read
        fill_value="" if kind is None else np.nan if kind.kind == "f" else 0,
        dimension_names=column.dims,
        attributes=dict(column.attributes),
        config={"write_empty_chunks": True},
    )
    if values is not None:
        _set_all(made, values)


def _set_all(array: Any, values: Values) -> None:
    array[...] = values.astype(object) if values.dtype.kind in "UOT" else values


def check_header(path: Path, found: Mapping[str, Any], wanted: Mapping[str, Any]) -> None:
    """Refuse to continue the store of something else.

    Raises
    ------
    InputError
        Saying what differs: format, version, study, sweep, or how they are read.
    """
    words = {
        "flexapod_sweep_format": "has another format",
        "flexapod_version": "was made by another version of flexapod",
        "flexapod_sources": "was made by other sources of flexapod",
        "study_hash": "holds another study",
        "sweep_hash": "holds another sweep of this study",
        "points_hash": "holds other points: tables that the study names have changed",
    }
    for name, what in words.items():
        if found.get(name) != wanted[name]:
            raise InputError(
                what, file=path, key=name, value=found.get(name), allowed=str(wanted[name]), next_step=_NEXT
            )


def _unwritable(path: Path | None, error: OSError, done: int) -> ComputationError:
    kept = f"; the points stored before ({done}) are whole" if done else ""
    return ComputationError(
        f"{path} cannot be written: {error.strerror or error}{kept}",
        next_step="Make space, then run the same command again: it continues",
    )
