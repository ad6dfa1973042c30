"""Small dense solves on one thread: the threads of a BLAS spin while they wait, and gain nothing there.

Memory that has been freed: the C library (glibc) keeps it for the next run, a page gives it back to the system.
"""

from __future__ import annotations

import ctypes
import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from threading import Lock
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

_entering = Lock()
_inside: list[Any] = []
"""Who computes now; the first one knows how many threads there were before."""


@contextmanager
def one_thread() -> Iterator[None]:
    """Keep BLAS on one thread for the whole process, until the last of those who asked for it leaves."""
    with _entering:
        _inside.append(_libraries("scipy.linalg" in sys.modules).limit(limits=1, user_api="blas") if not _inside else 0)
    try:
        yield
    finally:
        with _entering:
            if len(_inside) == 1:
                _inside[0].restore_original_limits()
            _inside.pop()


@cache
def _libraries(_with_scipy: bool) -> ThreadpoolController:
    """The libraries that are loaded; scipy brings one of its own."""
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


MOST_ARENAS = 2
"""Pools from which threads take their memory; glibc makes eight for each core, and each keeps what was freed in it."""
_ARENA_MAX = -8  # M_ARENA_MAX of malloc.h

_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3  # M_TRIM_THRESHOLD, M_MMAP_THRESHOLD
LARGEST, MOST_KEPT = 32 << 20, 64 << 20
"""Bytes: the largest arrays whose memory is kept when they are freed, and how much. glibc goes up to that by itself,
with the largest that was freed; Dask has its workers keep 64 kB."""


def retain_freed_memory() -> None:
    """Let what a run frees be taken by the next.

    The system gives memory page by page and fills each with zeros when it is touched, which takes a tenth of a call of
    30 ms, and a fifth of a point of a sweep if workers give back at once what they free.
    """
    library = _glibc()
    if library is not None:
        library.mallopt(_MMAP_THRESHOLD, LARGEST)
        library.mallopt(_TRIM_THRESHOLD, MOST_KEPT)


def limit_arenas() -> None:
    """Let the threads that begin from now on share their memory."""
    library = _glibc()
    if library is not None:
        library.mallopt(_ARENA_MAX, MOST_ARENAS)


def release_memory() -> None:
    """Free what somebody who has left leaves in cycles, before it adds up, and give it back to the system."""
    gc.collect()
    library = _glibc()
    if library is not None:
        library.malloc_trim(0)


@cache
def _glibc() -> ctypes.CDLL | None:
    try:
        library = ctypes.CDLL(None)
    except (OSError, TypeError):
        return None
    return library if hasattr(library, "malloc_trim") and hasattr(library, "mallopt") else None
