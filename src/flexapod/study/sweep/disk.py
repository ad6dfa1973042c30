"""A folder of a Zarr store whose files are on the disk, and not only on their way to it, before the next is written."""

from __future__ import annotations

import asyncio
import errno
import os
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
        self._check_writable()
        await asyncio.to_thread(_put, self.root / key, value.as_buffer_like())


def _put(path: Path, content: Any) -> None:
    made = [folder for folder in path.parents if not folder.exists()]
    path.parent.mkdir(parents=True, exist_ok=True)
    for folder in made:
        settle(folder.parent)
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
    """Wait until the names in a folder are on the disk; where folders cannot be waited for, do not."""
    try:
        handle = os.open(folder, os.O_RDONLY)
    except OSError:  # Windows
        return
    try:
        os.fsync(handle)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):  # some file systems on a network
            raise
    finally:
        os.close(handle)
