"""Store of a sweep as one SQLite file: a row a point, whole at any instant, continued when reopened."""

from __future__ import annotations

import io
import json
import sqlite3
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager, suppress
from functools import cached_property
from math import prod
from pathlib import Path
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.files import check_regular, sync_folder, temporary_folder
from flexapod.design.sweeps.refusals import damaged_store, lock_error, no_store, sqlite_error, unreadable_row

FORMAT = 3
Values = NDArray[Any]  # numbers of any kind, or texts
PENDING, COMPUTED, FAILED = "pending", "computed", "failed"
PATIENCE = 60.0  # seconds that who reads and who writes wait for each other
PORTION = 64 << 20  # byte of records that are read at a time: nobody writes meanwhile
FLOAT = np.dtype("<f8")


class StoredArray(NamedTuple):
    """A variable of the Dataset: dimensions, shape, attributes, and values if they are known from the start."""

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    attributes: Mapping[str, Any]
    values: Values | None = None


class StoredPoint(NamedTuple):
    """A row: remarks or why there is no result, all scalars one after the other, and records, in their order."""

    point: int
    state: str
    words: str
    scalars: bytes
    records: Sequence[bytes] = ()


class StoreLayout(NamedTuple):
    """Layout of a store, fixed from the start: number of points, attributes and variables of its Dataset."""

    size: int
    header: dict[str, Any]
    arrays: dict[str, StoredArray]

    def result_arrays(self, *, records: bool) -> dict[str, StoredArray]:
        """Arrays of results of every point: those over time, each in a blob of its own, or all the rest."""
        results = {name: array for name, array in self.arrays.items() if array.values is None}
        return {name: array for name, array in results.items() if ("time" in array.dims) == records}


class SweepStore:
    """An open store in a file, or in memory; points that it does not hold are pending."""

    def __init__(self, database: sqlite3.Connection, path: Path | None) -> None:
        self.path: Path | None = path
        self._database = database
        database.text_factory = lambda text: text.decode(errors="replace")  # what is spoilt a checksum tells

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._database.close()

    @classmethod
    def open_or_create(cls, path: Path | None, known: StoreLayout) -> SweepStore:
        """The store at `path`; where there is none a new one with nothing computed, which appears when it is whole.

        Raises
        ------
        InputError
            There is something else.
        ComputationError
            It cannot be written.
        """
        if path is None:
            return cls(_create_database(":memory:", known), None)
        if not path.exists():
            try:
                with temporary_folder(path.parent) as folder:
                    _create_database(folder / "store", known).close()
                    path.with_name(path.name + "-journal").unlink(missing_ok=True)  # of one that was removed
                    (folder / "store").rename(path)
                sync_folder(path.parent)
            except (OSError, sqlite3.Error) as error:
                raise sqlite_error(error, path) from None
        return cls.open(path)

    @classmethod
    def open(cls, path: Path) -> SweepStore:
        """A store that exists, to read it or, by who holds its lock, to write to it.

        What a process that was killed had half written is taken back by whoever reads or writes first.

        Raises
        ------
        InputError
            There is no regular file.
        """
        try:
            check_regular(path)
        except OSError:
            raise no_store(path) from None
        try:  # where nobody may write SQLite takes it to read
            where = f"{path.absolute().as_uri()}?mode=rw"
            return cls(sqlite3.connect(where, uri=True, timeout=PATIENCE, isolation_level=None), path)
        except sqlite3.Error as error:
            raise sqlite_error(error, path) from None

    @cached_property
    def layout(self) -> StoreLayout:
        """Layout as read from the database; refused, as all that is read, where it is not what was written."""
        ((content,),) = [*self._all("SELECT content FROM known")] or [(None,)]
        if (content := _verify_checksum(content, "known")) is None:
            raise damaged_store(self.path, "what describes it cannot be read")
        parts = np.load(io.BytesIO(content))
        size, header, arrays, given = json.loads(parts["arr_0"].tobytes())
        values = {name: parts[f"arr_{number}"] for number, name in enumerate(given, start=1)}
        return StoreLayout(
            size,
            header,
            {name: StoredArray(tuple(a[0]), tuple(a[1]), a[2], values.get(name)) for name, a in arrays.items()},
        )

    def points(self) -> Iterator[StoredPoint]:
        """Rows by number, without their records."""
        for point, state, words, blob in self._all("SELECT point, state, words, scalars FROM points ORDER BY point"):
            scalars = _verify_checksum(blob, point, state, words)
            if scalars is None:
                raise unreadable_row(self.path, f"point {point}")
            yield StoredPoint(point, state, words, scalars)

    def record(self, name: str, points: range, shape: tuple[int, ...]) -> Array:
        """A record of some points, (n, *shape); not a number where there is none."""
        made = np.full((len(points), *shape), np.nan)
        many, low, high = max(1, PORTION // max(1, 8 * prod(shape))), min(points, default=0), max(points, default=-1)
        query = f'SELECT point, "{name}" FROM points WHERE point BETWEEN ? AND ?'
        for begin in range(low, high + 1, many):
            for point, blob in self._all(query, (begin, min(begin + many - 1, high))):
                content = _verify_checksum(blob, point, name) if point in points else b""
                if content is None:
                    raise unreadable_row(self.path, f"{name} of point {point}")
                if content:
                    made[points.index(point)] = np.frombuffer(content, FLOAT).reshape(shape)
        return made

    def drop_damaged_rows(self) -> int:
        """Make points pending whose row is not what was written; how many there were."""
        for (told,) in self._all("PRAGMA quick_check(1)"):
            if told != "ok":
                raise damaged_store(self.path, told)
        lost, names = [], self.layout.result_arrays(records=True)
        for point, state, words, scalars, *records in self._all("SELECT * FROM points"):
            found = [
                _verify_checksum(scalars, point, state, words),
                *map(_verify_checksum, records, [point] * len(names), names),
            ]
            lost += [(point,)] * (None in found)
        self._change("DELETE FROM points WHERE point = ?", lost)
        return len(lost)

    def write(self, rows: Iterable[StoredPoint]) -> None:
        """Write rows, all or none of them; one that is there is replaced.

        Raises
        ------
        ComputationError
            The disk is full or cannot be written to; what was written before stays valid.
        """
        names = self.layout.result_arrays(records=True)
        sealed = (
            (
                *row[:3],
                _add_checksum(row.scalars, *row[:3]),
                *map(_add_checksum, row.records, [row.point] * len(names), names),
            )
            for row in rows
        )
        self._change(f"INSERT OR REPLACE INTO points VALUES (?, ?, ?, ?{', ?' * len(names)})", sealed)

    def _change(self, statement: str, rows: Iterable[tuple[Any, ...]]) -> None:
        with self._sqlite_errors():
            self._database.execute("PRAGMA synchronous = EXTRA")  # what is written is on the disk, its name too
            self._database.execute("BEGIN IMMEDIATE")
            try:
                self._database.executemany(statement, rows)
                self._database.execute("COMMIT")
            except BaseException:
                with suppress(sqlite3.Error):  # SQLite may have done it
                    self._database.execute("ROLLBACK")
                raise

    def _all(self, query: str, values: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
        with self._sqlite_errors():
            yield from self._database.execute(query, values)

    @contextmanager
    def _sqlite_errors(self) -> Iterator[None]:
        """Raise errors of SQLite as errors for the user."""
        try:
            yield
        except sqlite3.Error as error:
            done = 0
            with suppress(sqlite3.Error):
                (done,) = self._database.execute("SELECT count(*) FROM points").fetchone()
            raise sqlite_error(error, self.path, done) from None


def _create_database(place: Path | str, known: StoreLayout) -> sqlite3.Connection:
    """Database with the layout of a store and without points."""
    given = {name: array.values for name, array in known.arrays.items() if array.values is not None}
    arrays = {name: array[:3] for name, array in known.arrays.items()}
    about = json.dumps((known.size, known.header, arrays, list(given))).encode()
    file = io.BytesIO()
    np.savez(file, np.frombuffer(about, np.uint8), *given.values())
    records = "".join(f', "{name}" BLOB' for name in known.result_arrays(records=True))
    database = sqlite3.connect(place, isolation_level=None)
    database.execute("BEGIN")
    database.execute("CREATE TABLE known (content BLOB)")
    database.execute(f"CREATE TABLE points (point INTEGER PRIMARY KEY, state TEXT, words TEXT, scalars BLOB{records})")
    database.execute("INSERT INTO known VALUES (?)", (_add_checksum(file.getvalue(), "known"),))
    database.execute("COMMIT")
    return database


def _add_checksum(content: bytes, *said: object) -> bytes:
    """Content, and behind it the checksum of what is said of it and of itself."""
    return content + zlib.crc32(content, zlib.crc32(" ".join(map(str, said)).encode())).to_bytes(4, "little")


def _verify_checksum(blob: object, *said: object) -> bytes | None:
    """Content without its checksum; None if it is not what was written."""
    content = blob[:-4] if isinstance(blob, bytes) else b""
    return content if blob == _add_checksum(content, *said) else None


@contextmanager
def store_lock(path: Path | None) -> Iterator[None]:
    """Hold the lock of a store: of the empty database ``STORE.lock`` beside it, which is removed at the end.

    It ends with the process that holds it. Who opens the file as it is removed, and locks it, is not seen by a third:
    those two would compute the same rows, and neither would spoil one.

    Raises
    ------
    InputError
        There can be no such file.
    ComputationError
        Another process holds it, or the file system knows no locks.
    """
    if path is None:
        yield
        return
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"cannot be made: {error.strerror or error}", file=path.parent) from None
    place = path.with_name(path.name + ".lock")
    try:
        with closing(sqlite3.connect(place, timeout=0, isolation_level=None)) as lock:
            lock.execute("BEGIN EXCLUSIVE")
            try:
                yield
            finally:
                place.unlink(missing_ok=True)
    except sqlite3.Error as error:
        raise lock_error(error, path) from None
