"""Processes that a process has started, whoever their parents are by now: all carry a variable that it was given."""

import os
import signal
import subprocess
import time
from contextlib import contextmanager, suppress
from pathlib import Path
from uuid import uuid4

MARK = "FLEXAPOD_TEST_MARK"


@contextmanager
def started_by(command, **how):
    """A process, and a function that gives those it has started and that still run; all are gone afterwards."""
    mark = uuid4().hex
    environment = {**os.environ, **how.pop("env", {}), MARK: mark}
    process = subprocess.Popen(command, stdout=subprocess.PIPE, env=environment, **how)

    def others():
        return [number for number in _carrying(mark) if number != process.pid]

    try:
        yield process, others
    finally:
        for number in [process.pid, *others()]:
            with suppress(ProcessLookupError):
                os.kill(number, signal.SIGKILL)
        process.wait()
        process.stdout.close()


def none_left(others, within=300.0):
    """Wait until none of them runs; a busy machine takes longer, a fault for ever."""
    end = time.monotonic() + within
    while left := others():
        assert time.monotonic() < end, [_said(number) for number in left]
        time.sleep(0.05)


def _carrying(mark):
    """Numbers of processes that run with the mark; of those that have ended nothing can be read."""
    found = []
    for place in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if f"{MARK}={mark}".encode() in (place / "environ").read_bytes().split(b"\0"):
                found.append(int(place.name))
    return found


def _said(number):
    with suppress(OSError):
        return Path(f"/proc/{number}/cmdline").read_bytes().replace(b"\0", b" ")[:200]
    return number


def heed_interrupts():
    """A suite that runs in the background, or under nohup, passes on that signals are ignored."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    for name in ("SIGTERM", "SIGHUP"):
        signal.signal(getattr(signal, name), signal.SIG_DFL)
