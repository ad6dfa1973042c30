"""One process at a time on a store: a lock of the operating system, which ends with the process that holds it."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from flexapod.errors import ComputationError, InputError

_TAKEN = (errno.EWOULDBLOCK, errno.EACCES, errno.EDEADLK)


@contextmanager
def locked(store: Path) -> Iterator[None]:
    """Hold the lock of a store: of the file ``STORE.lock`` beside it, which is removed at the end.

    A file that a killed process left behind is not a hindrance: its lock went with the process.

    Raises
    ------
    InputError
        There can be no such file.
    ComputationError
        Another process holds it, or the file system knows no locks.
    """
    path = store.with_name(store.name + ".lock")
    handle = _acquire(path, store)
    try:
        yield
    finally:
        path.unlink(missing_ok=True)  # while it is held: whoever opened it meanwhile sees that it is gone
        os.close(handle)


def _acquire(path: Path, store: Path) -> int:
    while True:
        try:
            handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        except OSError as error:
            raise InputError(
                f"cannot be made: {error.strerror or error}", file=path, next_step="Choose another place with --out"
            ) from None
        try:
            _lock(handle)
        except OSError as error:
            os.close(handle)
            raise _refusal(error, store) from None
        try:
            if os.path.samestat(os.fstat(handle), os.stat(path)):
                return handle
        except FileNotFoundError:
            pass
        os.close(handle)  # removed by its last holder between opening and locking


def _lock(handle: int) -> None:
    if sys.platform == "win32":
        import msvcrt

        msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)
    else:
        import fcntl

        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)


def _refusal(error: OSError, store: Path) -> ComputationError:
    if error.errno in _TAKEN:
        return ComputationError(
            f"{store} is in use by another sweep", next_step="Wait for it to end, or choose another place with --out"
        )
    return ComputationError(
        f"{store} cannot be locked ({error.strerror}): two sweeps at once would spoil it",
        next_step="Choose a folder on a disk of this machine, or a network folder with locks",
    )
