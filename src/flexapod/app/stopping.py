"""SIGTERM and SIGHUP end a command as Ctrl-C does: what was computed is kept, nothing half written stays."""

from __future__ import annotations

import signal
from types import FrameType
from typing import NoReturn

__all__ = ["heed_signals", "stop_code", "stopped"]

_received: list[int] = []


def heed_signals() -> None:
    """From now on they arrive as KeyboardInterrupt; one that is ignored, as after nohup, stays so."""
    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, _stop)


def _stop(number: int, _: FrameType | None) -> NoReturn:
    _received.append(number)
    raise KeyboardInterrupt


def stopped() -> str:
    """By what the command is being stopped, in words."""
    return f"stopped by {signal.Signals(_received[0]).name if _received else 'Ctrl-C'}"


def stop_code(usual: int) -> int:
    """The exit code that shells give to a process ended by the signal that came, else the `usual` one."""
    return 128 + _received[0] if _received else usual
