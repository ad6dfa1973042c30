"""What the page's server writes to its log: as much as somebody can read, whatever others send."""

from __future__ import annotations

import logging
import time

from websockets.exceptions import WebSocketException

MOST_LINES = 60
"""Entries at once; after that, one a second."""
LONGEST = 8_000
"""Longest entry [characters]."""


class Few(logging.Filter):
    """Lets so many entries pass, cuts long ones, and says how many it left out."""

    def __init__(self) -> None:
        super().__init__()
        self._left, self._since, self._dropped = float(MOST_LINES), time.monotonic(), 0

    def filter(self, record: logging.LogRecord) -> bool:
        """Whether an entry is written."""
        now = time.monotonic()
        self._left, self._since = min(MOST_LINES, self._left + now - self._since), now
        if self._left < 1:
            self._dropped += 1
            return False
        self._left -= 1
        text = record.getMessage()
        if len(text) > LONGEST:
            text = f"{text[: LONGEST // 2]}\n...\n{text[-LONGEST // 2 :]}"
        if self._dropped:
            text = f"({self._dropped} entries were left out.) {text}"
        record.msg, record.args, self._dropped = text, None, 0
        return True


def _unexpected(record: logging.LogRecord) -> bool:
    """Whether an entry tells of more than somebody who does not speak as a browser does, or left."""
    error = record.exc_info[1] if record.exc_info else None
    return not isinstance(error, WebSocketException | OSError | EOFError)


LOG = logging.getLogger("flexapod.view")
"""The log of the server and its sessions."""
CONNECTIONS = LOG.getChild("connections")
"""The log of what lies below them."""

FEW = Few()
LOG.addFilter(FEW)
CONNECTIONS.setLevel(logging.WARNING)  # who comes and goes is not told
CONNECTIONS.addFilter(_unexpected)
CONNECTIONS.addFilter(FEW)
