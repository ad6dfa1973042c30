"""The folder of compiled kernels: private, whole files only, bounded in size, shared by many processes."""

from __future__ import annotations

import functools
import hashlib
import logging
import math
import os
import re
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from flexapod.common.errors import ComputationError, InputError
from flexapod.common.files import UNFINISHED, atomic_file, read_bytes

#: A kernel takes 0.1 to 1 MB: room for some hundred sets of shapes, and little on any disk.
DEFAULT_MEGABYTES = 256.0
LIMIT = "FLEXAPOD_CACHE_MEGABYTES"
#: Of one library [byte]: more is none of ours.
LARGEST = 100_000_000
#: Key of what the code depends on, then the beginning of the hash of the file itself.
LIBRARY = re.compile(r"[0-9a-f]{32}-[0-9a-f]{16}\.so")
#: What a key of equations has given before: a file named after the key, with the hash of their C text.
TEXT = re.compile(r"[0-9a-f]{32}\.text")
#: A text that takes long to make: a file named after the hash of what it is made from, which begins with its own hash.
KEPT = re.compile(r"[0-9a-f]{32}\.kept")
SLACK = 60e9  # by how much longer than kernels these are kept [ns]
_log = logging.getLogger("flexapod")


@dataclass(frozen=True, kw_only=True)
class CacheContent:
    """Content of the cache: ``kernels`` libraries, ``size`` bytes of at most ``limit``; why it is not used, if so."""

    folder: Path
    kernels: int
    size: int
    limit: int
    unused_because: str | None


def cache_directory() -> Path:
    """Absolute path of the compiled kernels: ``FLEXAPOD_CACHE``, else in the user's cache; it need not exist."""
    if chosen := os.environ.get("FLEXAPOD_CACHE"):
        return Path(os.path.expanduser(chosen)).absolute()
    for base in (os.environ.get("XDG_CACHE_HOME"), os.environ.get("LOCALAPPDATA"), os.path.expanduser("~/.cache")):
        if base and os.path.isabs(base):  # a relative one is to be ignored, says the XDG specification
            return Path(base) / "flexapod"
    return Path(tempfile.gettempdir()) / "flexapod"  # a user without a home


def size_limit() -> int:
    """Largest size of the cache [byte]: ``FLEXAPOD_CACHE_MEGABYTES``, else 256 MB.

    Raises
    ------
    InputError
        The variable holds no positive number.
    """
    text = os.environ.get(LIMIT) or str(DEFAULT_MEGABYTES)
    try:
        megabytes = float(text)
    except ValueError:
        megabytes = math.nan
    if not 0 < megabytes < math.inf:
        raise InputError(
            "is not a size of the cache of compiled kernels",
            key=LIMIT,
            value=text,
            allowed="a number of megabytes above 0",
            next_step=f"Unset it for {DEFAULT_MEGABYTES:g} MB",
        )
    return round(megabytes * 1e6)


def open_cache() -> Path | None:
    """The cache folder, made if need be with access for its user alone; None, said once, if it is not to be used."""
    size_limit()
    folder = cache_directory()
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        reason = _distrust(folder)
    except OSError as error:
        reason = error.strerror or str(error)
    if reason:
        warn_unused(folder, reason)
        return None
    return folder


def _distrust(path: Path) -> str | None:
    """Why code must not be loaded from `path`: someone else than this user and root could have put it there."""
    if sys.platform == "win32":
        return None  # the user's profile is private by its access list, which stat does not show
    found = path.stat()
    if found.st_uid not in (os.geteuid(), 0):
        return "it belongs to another user"
    if found.st_mode & 0o022:
        return f"others may write to it (chmod go-w {path})"
    return None


@functools.cache
def warn_unused(folder: Path, reason: str) -> None:
    """Warn, once in a process, that compiled kernels are not stored in `folder`."""
    _log.warning(
        "Compiled kernels are not kept in %s: %s. Each run compiles its own, some seconds each; "
        "set FLEXAPOD_CACHE to a folder of yours that only you can write to.",
        folder,
        reason,
    )


def intact_libraries(folder: Path, key: str) -> list[Path]:
    """Libraries of `key` that are as they were written; others under its name are removed."""
    intact = []
    for path in _matching(folder, re.compile(f"{key}-.*\\.so")):
        with suppress(OSError):
            if not _intact(key, path):
                path.unlink()
                continue
            intact.append(path)
            os.utime(path)  # used now; not to be had in a folder that can only be read
    return intact


def store_library(folder: Path, key: str, built: Path) -> Path | None:
    """Path of a copy of `built` in the cache; it appears there at once and whole. None, said once, if it cannot.

    Least recently used libraries make room for it.
    """
    try:
        target = folder / _name(key, built)
        with atomic_file(target, mode=0o700) as unfinished:
            unfinished.write_bytes(read_bytes(built, LARGEST))
        _make_room(folder, target)
    except OSError as error:
        warn_unused(folder, error.strerror or str(error))
        return None
    return target


def known_text(folder: Path, source: str) -> str | None:
    """Hash of the C text that equations of this key have; None where they have not been written yet."""
    path = folder / f"{source}.text"
    with suppress(OSError, ValueError):
        text = read_bytes(path, 32).decode("ascii")
        if re.fullmatch("[0-9a-f]{32}", text) and not _distrust(path):
            with suppress(OSError):
                os.utime(path)  # used now
            return text
    return None


def remember_text(folder: Path, source: str, text: str) -> None:
    """Store a text for `known_text`; a folder that cannot be written to is not reported again."""
    with suppress(OSError), atomic_file(folder / f"{source}.text", mode=0o600) as unfinished:
        unfinished.write_bytes(text.encode("ascii"))


def kept_text(source: str, make: Callable[[], str]) -> str:
    """Return the ASCII text of `make`, stored under a digest of its source where there is a trusted folder."""
    folder = cache_directory()
    path = folder / f"{hashlib.sha256(source.encode()).hexdigest()[:32]}.kept"
    with suppress(OSError, ValueError):
        found, _, text = read_bytes(path, LARGEST).decode("ascii").partition("\n")
        if found == _digest(text) and not _distrust(folder) and not _distrust(path):
            return text
    text = make()
    with suppress(OSError):
        if not _distrust(folder):
            with atomic_file(path, mode=0o600) as unfinished:
                unfinished.write_bytes(f"{_digest(text)}\n{text}".encode("ascii"))
    return text


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode("ascii")).hexdigest()


def _intact(key: str, path: Path) -> bool:
    try:
        return path.name == _name(key, path) and not _distrust(path)
    except OSError:  # a pipe, a device, something endless
        return False


def _name(key: str, path: Path) -> str:
    return f"{key}-{hashlib.sha256(read_bytes(path, LARGEST)).hexdigest()[:16]}.so"


def _make_room(folder: Path, newest: Path) -> None:
    """Remove libraries, least recently used first, until all fit, and what leads to them; `newest` stays."""
    files = [(path != newest, -found.st_mtime_ns, found.st_size, path) for path, found in _kernels(folder).items()]
    used, removed = 0, 0
    for older, date, size, path in sorted(files):
        used += size
        if older and used > size_limit():
            removed = removed or -date
            _remove(path)
    for path in _matching(folder, TEXT) if removed else ():
        if (found := _stat(path)) and found.st_mtime_ns < removed - SLACK:
            _remove(path)


def cache_content() -> CacheContent:
    """Read the present content of the cache; nothing is made or changed."""
    folder = cache_directory()
    kernels = _kernels(folder)
    return CacheContent(
        folder=folder,
        kernels=len(kernels),
        size=sum(found.st_size for found in kernels.values()),
        limit=size_limit(),
        unused_because=_unused_because(folder),
    )


def _unused_because(folder: Path) -> str | None:
    """Why a run would not keep kernels in `folder`, found without making it; None if it would."""
    try:
        reason = _distrust(folder)
    except FileNotFoundError:
        return None  # the first run makes it
    except OSError as error:
        return error.strerror
    if not folder.is_dir():
        return "it is not a folder"
    return reason or (None if os.access(folder, os.W_OK | os.X_OK) else "it cannot be written to")


def clear_cache() -> CacheContent:
    """Remove all kernels, and no other file; returns what was removed.

    Raises
    ------
    ComputationError
        Some could not be removed.
    """
    before = cache_content()
    ours = (path for pattern in (LIBRARY, TEXT, KEPT) for path in _matching(before.folder, pattern))
    for path in (*ours, *before.folder.glob(UNFINISHED)):
        _remove(path)
    if left := cache_content().kernels:
        raise ComputationError(
            f"{left} of {before.kernels} kernels in {before.folder} could not be removed",
            next_step="End the runs that use them, or see who owns the folder.",
        )
    return before


def _kernels(folder: Path) -> dict[Path, os.stat_result]:
    return {path: found for path in _matching(folder, LIBRARY) if (found := _stat(path))}


def _matching(folder: Path, pattern: re.Pattern[str]) -> list[Path]:
    """Files of `folder` with such names; none where there is no folder."""
    try:
        return sorted(path for path in folder.iterdir() if pattern.fullmatch(path.name))
    except OSError:
        return []


def _stat(path: Path) -> os.stat_result | None:
    """Status of a file; None if another process has removed it meanwhile."""
    with suppress(OSError):
        return path.stat()
    return None


def _remove(path: Path) -> None:
    with suppress(OSError):
        path.unlink()
