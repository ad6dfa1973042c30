"""Small dense solves on one thread: the threads of a BLAS spin while they wait, and gain nothing there."""

from __future__ import annotations

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
