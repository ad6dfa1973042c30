"""A folder of a Zarr store whose files are on the disk, and not only on their way to it, before the next is written."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import TYPE_CHECKING, Any

from zarr.storage import LocalStore

from flexapod.files import whole

if TYPE_CHECKING:
    from zarr.core.buffer import Buffer


class DurableStore(LocalStore):
    """As Zarr's own, but what is written survives that the power goes off, as far as the disk keeps its word."""

    async def set(self, key: str, value: Buffer) -> None:
        """Write a file under another name, wait for the disk, rename it, wait for the disk."""
        self._check_writable()
        await asyncio.to_thread(_put, self.root / key, value.as_buffer_like())


def _put(path: Path, content: Any) -> None:
    with whole(path) as temporary:
        temporary.write_bytes(content)
