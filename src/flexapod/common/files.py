"""Files in and out: regular files of bounded size are read, what is written is on the disk whole or not at all."""

from __future__ import annotations

import errno
import hashlib
import os
import platform
import re
import shutil
import stat
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache, lru_cache
from pathlib import Path
from uuid import uuid4

from flexapod.common.errors import InputError

LARGEST_TEXT = 10_000_000
"""Of a study or a sweep file [byte]: the largest are some hundred kilobytes."""
LARGEST_TABLE = 100_000_000
"""Of a table [byte]: a million lines of a motion."""
RESULTS = (".nc", ".nc4", ".netcdf")
"""Ends of the names of results."""
UNFINISHED = ".flexapod-*"
"""Names of what is being written: `remove_abandoned` removes what processes left that are gone."""
WRITER = re.compile(r"\.?flexapod-([0-9a-f]{8})-([0-9]+)-[0-9a-f]{12}(\..*)?")
"""Such a name: the machine and the process that write it."""
ABANDONED = 3600.0
"""Age of a file that is being written [s] from which on its writer counts as gone, where nothing else tells."""


def check_regular(path: str | Path) -> None:
    """Refuse what is not a regular file: a pipe or a device would never end.

    Raises
    ------
    OSError
        Its `strerror` says why in words that fit behind "cannot be read:".
    """
    try:
        _refuse(os.stat(path), float("inf"))
    except ValueError:
        raise _zero_byte() from None


def read_bytes(path: str | Path, most: int) -> bytes:
    """The content of a regular file of at most `most` bytes.

    Raises
    ------
    OSError
        As `check_regular`, or it cannot be read.
    """
    try:
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    except ValueError:
        raise _zero_byte() from None
    with open(handle, "rb") as file:
        _refuse(os.fstat(handle), most)
        content = file.read(most + 1)
    if len(content) > most:
        raise _too_large(most)
    return content


def read_text(path: str | Path, most: int) -> str:
    """The UTF-8 text of a regular file, as `read_bytes`; a mark of the byte order is left out."""
    try:
        return read_bytes(path, most).decode("utf-8-sig")
    except UnicodeDecodeError:
        raise OSError(errno.EILSEQ, "it is not UTF-8 text") from None


def _refuse(found: os.stat_result, most: float) -> None:
    if stat.S_ISDIR(found.st_mode):
        raise OSError(errno.EISDIR, os.strerror(errno.EISDIR))
    if not stat.S_ISREG(found.st_mode):
        raise OSError(errno.EINVAL, "it is not a regular file but a pipe or a device")
    if found.st_size > most:
        raise _too_large(most)


def _too_large(most: float) -> OSError:
    return OSError(errno.EFBIG, f"it is larger than {most / 1e6:g} MB")


def _zero_byte() -> OSError:
    return OSError(errno.EINVAL, "its name holds a zero byte")


def path_of(given: object, key: str) -> Path:
    """A path of a text or of a path; InputError of what is neither, or of a name that no file can have."""
    if not isinstance(given, str | os.PathLike) or "\0" in os.fsdecode(given):
        raise InputError("is no path of a file", key=key, value=given, allowed='a text as "robot.mat", or a Path')
    return Path(os.fsdecode(given))


LONGEST_NAME = 255  # bytes, of a file or a folder in any usual file system


def check_name(path: str | Path, key: str | None = None) -> None:
    """Refuse a name that is not UTF-8: neither results nor reports can hold it, or be written to it.

    Raises
    ------
    InputError
        About the option `key`, or about the file.
    """
    name = str(path)
    if any(len(os.fsencode(part)) > LONGEST_NAME for part in Path(name).parts):
        where = {"file": f"{name[:40]}..."} if key is None else {"key": key, "value": f"{name[:40]}..."}
        raise InputError("has a name that is too long", **where, allowed=f"at most {LONGEST_NAME} bytes for each part")
    try:
        name.encode()
    except UnicodeEncodeError:
        shown = name.encode(errors="backslashreplace").decode()
        where = {"file": shown} if key is None else {"key": key, "value": shown}
        raise InputError(
            "has a name that is not UTF-8 text", **where, next_step="Rename the file or the folder that is named so"
        ) from None


@contextmanager
def replace_file(path: str | Path) -> Iterator[Path]:
    """Replace a file as `atomic_file`, with errors in words.

    Raises
    ------
    InputError
        The folder cannot be made or written to, or the disk is full.
    """
    check_name(Path(path).absolute())
    try:
        with atomic_file(path) as temporary:
            yield temporary
    except OSError as error:
        raise InputError(
            f"cannot be written: {error.strerror or error}",
            file=str(path),
            next_step="Choose a place that you may write to and that has space",
        ) from error


def write_text(path: str | Path, text: str, *, encoding: str = "utf-8", errors: str = "strict") -> Path:
    """Write a text as `replace_file` does; the path."""
    with replace_file(path) as temporary:
        temporary.write_text(text, encoding=encoding, errors=errors)
    return Path(path)


@contextmanager
def atomic_file(path: str | Path, *, mode: int = 0o666) -> Iterator[Path]:
    """A temporary file beside `path` that takes its place, on the disk, when the block ends without an error.

    Whatever ends the block, Ctrl-C and SIGTERM too, the temporary file is gone; after SIGKILL the next one who writes
    into the folder removes it.

    Parameters
    ----------
    path : path
        Its folder is made if need be.
    mode : int
        Who may do what with it, as far as the user's mask allows.

    Raises
    ------
    OSError
    """
    path = Path(path)
    with suppress(FileNotFoundError):  # a device would be replaced by a file where its folder may be written to
        check_regular(path)
    temporary = path.with_name(f"{_name('.')}{path.suffix}")
    made = [folder for folder in path.parents if not folder.exists()]
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        _tidy(path.parent.absolute())
        os.close(os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode))
        yield temporary
        _settle(temporary, os.O_RDWR)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
    for folder in (path, *made):
        sync_folder(folder.parent)


@contextmanager
def temporary_folder(beside: Path | None = None) -> Iterator[Path]:
    """An empty folder for this user alone, in the system's temporary one or in `beside`, gone when the block ends.

    Those that killed processes left there are removed.

    Raises
    ------
    OSError
    """
    place = Path(tempfile.gettempdir()) if beside is None else beside
    _tidy(place.absolute())
    folder = place / _name("" if beside is None else ".")
    folder.mkdir(mode=0o700)
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _name(dot: str) -> str:
    return f"{dot}flexapod-{_here()}-{os.getpid()}-{uuid4().hex[:12]}"


@cache
def _here() -> str:
    """Eight digits of this machine, and of this container: numbers of processes mean nothing in another."""
    place = platform.node()
    with suppress(OSError):
        place += os.readlink("/proc/self/ns/pid")
    return hashlib.sha256(place.encode()).hexdigest()[:8]


@lru_cache(maxsize=1024)
def _tidy(folder: Path) -> None:
    """`remove_abandoned`, once in a process for each folder."""
    remove_abandoned(folder)


def remove_abandoned(folder: Path) -> None:
    """Remove what processes that are gone were writing in a folder; what cannot be removed stays."""
    for path in (*folder.glob(UNFINISHED), *folder.glob(UNFINISHED[1:])):
        with suppress(OSError):
            _remove_abandoned(path, path.lstat())


def _remove_abandoned(path: Path, found: os.stat_result) -> None:
    writer, is_folder = WRITER.fullmatch(path.name), stat.S_ISDIR(found.st_mode)
    known = writer is not None and writer[1] == _here() and sys.platform != "win32"
    if writer is not None and known and (_runs(int(writer[2])) or found.st_uid != os.geteuid()):
        return
    if known and is_folder:
        shutil.rmtree(path)
    elif not is_folder and path.name.startswith(".") and (known or time.time() - found.st_mtime > ABANDONED):
        path.unlink()


def _runs(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):  # another user's, or no number of a process
        return True
    return True


def sync_folder(folder: Path) -> None:
    """Wait until the names in a folder are on the disk; where folders cannot be waited for, do not."""
    try:
        _settle(folder, os.O_RDONLY)
    except OSError as error:
        # Windows opens no folders; some file systems on a network do not wait for them
        if error.errno not in (errno.EACCES, errno.EINVAL, errno.ENOTSUP):
            raise


def _settle(path: Path, access: int) -> None:
    handle = os.open(path, access)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
