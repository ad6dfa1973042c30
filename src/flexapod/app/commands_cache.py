"""`flexapod cache`: where compiled kernels are kept, how many, and how to remove them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from flexapod.app.failures import guarded
from flexapod.app.options import Json

if TYPE_CHECKING:
    from flexapod.symbolic.cache import CacheContent

__all__ = ["add"]

Clear = Annotated[bool, typer.Option("--clear", help="Remove all kernels; each is compiled again when needed.")]


def add(app: typer.Typer) -> None:
    """Give `app` the command."""
    app.command("cache")(cache)


@guarded
def cache(clear: Clear = False, json: Json = False) -> None:
    """Where compiled kernels are kept, how many there are, and how to remove them.

    FLEXAPOD_CACHE chooses another folder, FLEXAPOD_CACHE_MEGABYTES another bound.
    """
    from flexapod.app.terminal import print_json, print_text
    from flexapod.symbolic.cache import cache_content, clear_cache

    found = clear_cache() if clear else cache_content()
    if json:
        print_json(_as_dict(found, cleared=clear))
    elif clear:
        print_text(f"Removed {_kernels(found)} ({_megabytes(found.size)}) from {found.folder}.")
    else:
        print_text(f"Folder: {found.folder}")
        print_text(f"{_kernels(found)}, {_megabytes(found.size)} of at most {_megabytes(found.limit)}")
        if found.unused_because:
            print_text(f"Not used: {found.unused_because}. Each run compiles its own kernels.")


def _as_dict(found: CacheContent, *, cleared: bool) -> dict[str, object]:
    if cleared:
        return {"folder": found.folder, "removed": found.kernels, "bytes": found.size}
    return {
        "folder": found.folder,
        "kernels": found.kernels,
        "bytes": found.size,
        "limit_bytes": found.limit,
        "unused_because": found.unused_because,
    }


def _kernels(found: CacheContent) -> str:
    return "1 compiled kernel" if found.kernels == 1 else f"{found.kernels} compiled kernels"


def _megabytes(size: int) -> str:
    return f"{size / 1e6:.4g} MB"
