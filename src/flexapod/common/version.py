"""Version of flexapod, and a hash of the sources that numbers come from."""

from __future__ import annotations

from functools import cache
from pathlib import Path

__version__ = "0.1.0"

#: Folders, and folders of theirs.
_WITHOUT_NUMBERS = ("app", "verification", "output/exchange", "output/figures", "output/report")
_KINDS = (".py", ".c", ".h", ".toml")


@cache
def sources() -> str:
    """Hash of the package's sources, 16 hexadecimal digits; commands, figures and other programs do not count."""
    import hashlib

    root = Path(__file__).parents[1]
    digest = hashlib.sha256()
    for path in sorted(root.rglob("*")):
        inner = path.relative_to(root)
        if path.suffix in _KINDS and not f"{inner.as_posix()}/".startswith(tuple(f"{x}/" for x in _WITHOUT_NUMBERS)):
            digest.update(inner.as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]


def this_version() -> str:
    """Version and sources in one text."""
    return f"{__version__} (sources {sources()})"
