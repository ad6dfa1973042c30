"""A folder of a Zarr store whose files are on the disk, and not only on their way to it, before the next is written."""

from __future__ import annotations

import asyncio
import os
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from zarr.storage import LocalStore

if TYPE_CHECKING:
    from zarr.core.buffer import Buffer

__all__ = ["DurableStore", "settle"]


class DurableStore(LocalStore):
    """As Zarr's own, but what is written survives that the power goes off, as far as the disk keeps its word."""

    async def set(self, key: str, value: Buffer) -> None:
        """Write a file under another name, wait for the disk, rename it, wait for the disk."""
        await asyncio.to_thread(_put, self.root / key, value.as_buffer_like())


def _put(path: Path, content: Any) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f"{path.name}.{uuid4().hex}.partial")
    try:
        with temporary.open("wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
    settle(path.parent)


def settle(folder: Path) -> None:
    """Wait until the names in a folder are on the disk; where folders cannot be waited for (Windows), do not."""
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)
