"""What the writer of a format hands back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class Content:
    """A study in some format.

    `files`: contents by name, that of the file itself is "", others are beside it, or in the folder where the format is
    one; a text is ASCII or UTF-8. `left_out`: what the files do not have, in words. `remarks`: what their reader must
    know, for instance how to run them.
    """

    files: Mapping[str, str | bytes]
    left_out: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
