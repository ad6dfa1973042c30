"""The threads in which viser calls back."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

from flexapod.app.view.visitor import Visitor

__all__ = ["Pool"]


class Pool(ThreadPoolExecutor):
    """What a callback raises is told to the client that it belongs to; what waits for one holds up that one only.

    Parameters
    ----------
    fault : callable
        Called with the client's number, or None, and the exception.
    visitor : callable
        Gives the connection of a client's number, or None.
    """

    def __init__(
        self, fault: Callable[[int | None, BaseException], None], visitor: Callable[[int], Visitor | None]
    ) -> None:
        super().__init__(max_workers=32, thread_name_prefix="flexapod-view")
        self._fault, self._visitor = fault, visitor

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Call back in a thread."""
        client = getattr(args[0], "client_id", None) if args else None
        work = super().submit(self._guarded, client, fn, *args, **kwargs)
        visitor = None if client is None else self._visitor(client)
        if visitor is not None:
            visitor.work.add(work)
            work.add_done_callback(visitor.work.discard)
        return work

    def _guarded(self, client: int | None, fn: Callable[..., Any], *args: Any, **kwargs: Any) -> Any:
        try:
            return fn(*args, **kwargs)
        except Exception as error:
            self._fault(client, error)
            return None
