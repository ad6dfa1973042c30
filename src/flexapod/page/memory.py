"""Memory that sessions have freed goes back to the system, where the C library (glibc) keeps it otherwise."""

from __future__ import annotations

import ctypes
import gc
from functools import cache

MOST_ARENAS = 2
"""Pools from which threads take their memory; glibc makes eight for each core, and each keeps what was freed in it."""
_ARENA_MAX = -8  # M_ARENA_MAX of malloc.h


def few_arenas() -> None:
    """Let the threads that begin from now on share their memory."""
    library = _glibc()
    if library is not None:
        library.mallopt(_ARENA_MAX, MOST_ARENAS)


def collect() -> None:
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
