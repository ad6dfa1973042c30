"""Errors of stores of sweeps: what is wrong with a store, and the next step."""

from __future__ import annotations

import errno
import os
import sqlite3
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from flexapod.common.errors import ComputationError, FlexapodError, InputError

_NEXT = "Choose another place with --out (store in Python), or remove this one"
_OF_THE_DISK = (sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR, sqlite3.SQLITE_READONLY, sqlite3.SQLITE_CANTOPEN)


def no_store(path: Path | None) -> InputError:
    """Error of a path that holds something else than a store, or nothing."""
    return InputError("is not a store of a sweep", file=path, next_step="Choose another place with --out")


def damaged_store(path: Path | None, why: str) -> InputError:
    """Error of a damaged store, which cannot be continued."""
    return InputError(f"is a damaged store of a sweep: {why}", file=path, next_step=_NEXT)


def other_format(path: Path, header: Mapping[str, Any]) -> InputError:
    """Error of a store that another version of flexapod has written, and reads."""
    return InputError(
        "was written by another version of flexapod", file=path, key="flexapod_sweep_format",
        value=header.get("flexapod_sweep_format"),
        next_step=f"Read it with flexapod {header.get('flexapod_version', 'of that time')}",
    )  # fmt: skip


def read_only_store(path: Path) -> InputError:
    """Error of a Zarr folder where a sweep is to continue."""
    words = "is a sweep as Zarr, of an earlier flexapod or for other programs: it can be read, not continued"
    return InputError(words, file=path, next_step=_NEXT)


def unreadable_row(path: Path | None, name: str) -> ComputationError:
    """Error of a row that is not what was written, with what to do about it."""
    next_step = "Run the sweep again with this store: it computes again what was lost"
    return ComputationError(f"{path}: {name} cannot be read", next_step=next_step)


def sqlite_error(error: sqlite3.Error | OSError, path: Path | None, done: int = 0) -> FlexapodError:
    """Error for the user from one of SQLite or of the system, with the number of points stored before."""
    code = _code(error)
    if code == sqlite3.SQLITE_NOTADB or "no such table" in str(error):
        return no_store(path)
    if code == sqlite3.SQLITE_BUSY:
        return ComputationError(f"{path} is in use by another program", next_step="Wait for it to end")
    if isinstance(error, sqlite3.Error) and code not in _OF_THE_DISK:
        return damaged_store(path, str(error))
    words = os.strerror(errno.ENOSPC) if code == sqlite3.SQLITE_FULL else getattr(error, "strerror", None) or error
    kept = f"; the points stored before ({done}) are whole" if done else ""
    first = "Let it be written to" if code == sqlite3.SQLITE_READONLY else "Make space"
    next_step = f"{first}, then run the same command again: it continues"
    return ComputationError(f"{path} cannot be written: {words}{kept}", next_step=next_step)


def lock_error(error: sqlite3.Error, path: Path) -> FlexapodError:
    """Error of a lock: another sweep holds it, no such place, or a file system without locks."""
    code = _code(error)
    if code == sqlite3.SQLITE_BUSY:
        next_step = "Wait for it to end, or choose another place with --out"
        return ComputationError(f"{path} is in use by another sweep", next_step=next_step)
    if code in (sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_READONLY):
        return InputError(f"cannot be made: {error}", file=path, next_step="Choose another place with --out")
    return ComputationError(
        f"{path} cannot be locked ({error}): two sweeps at once would compute the same",
        next_step="Choose a folder on a disk of this machine, or a network folder with locks",
    )


def _code(error: Exception) -> int:
    return getattr(error, "sqlite_errorcode", 0) & 0xFF  # the rest tells kinds of it


def check_header(path: Path | None, found: Mapping[str, Any], wanted: Mapping[str, Any]) -> None:
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
