"""Other programs: called with a time limit, stopped with all that they have started."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

__all__ = ["call"]


def call(
    command: Sequence[str], folder: Path, time_limit: float, environment: Mapping[str, str] | None = None
) -> tuple[str, int | None]:
    """Run a program in a folder of its own; what it said, and its exit code, or None if it was stopped.

    Parameters
    ----------
    command : sequence of str
    folder : Path
        Where it runs, and where a file takes up what it says.
    time_limit : float
        Seconds after which it is stopped.
    environment : mapping, optional
        Variables to be set.

    Raises
    ------
    OSError
        It cannot be started.
    """
    spoken = folder / "spoken.txt"
    with spoken.open("wb") as file:
        # A session of its own, so that whatever it starts can be stopped with it.
        process = subprocess.Popen(
            command, cwd=folder, env=os.environ | dict(environment or {}), stdin=subprocess.DEVNULL,
            stdout=file, stderr=subprocess.STDOUT, start_new_session=True,
        )  # fmt: skip
        try:
            code: int | None = process.wait(timeout=time_limit)
        except subprocess.TimeoutExpired:
            code = None
        finally:
            if process.poll() is None:
                _stop(process)
    return spoken.read_text(encoding="utf-8", errors="replace"), code


def _stop(process: subprocess.Popen[bytes]) -> None:
    if sys.platform == "win32":
        process.kill()
    else:
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()
