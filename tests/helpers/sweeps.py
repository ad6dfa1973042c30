"""A study that takes some milliseconds, and sweeps of it, for tests."""

import functools
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

from tests.helpers.texts import replaced

from flexapod.design.sweeps.worker import compute_batch
from flexapod.model import loads, preset_text

KEY = "leg.piston.diameter"
QUICK = (
    ('duration = "1 s" ', 'duration = "20 ms" '),
    ('hold = "1 s" ', "hold = 0 "),
    ('duration = "2 s" ', 'duration = "20 ms" '),
    ('amplitude = "26.6 deg"', 'amplitude = "1 deg"'),
    ('fidelity = "assumed-modes"', 'fidelity = "lumped"'),
    ("modes = 3 ", "# "),
    ("tolerance = 1e-4", 'step = "1 ms"'),
)


@functools.cache
def quick():
    """A roll of 20 ms with legs that only stretch."""
    return loads(quick_text())


def quick_text(*changes):
    """Its file, with pieces replaced."""
    return replaced(preset_text("paper-robot"), *QUICK, *changes)


def diameters(count, *, more=(), **kept):
    """So many diameters of the pistons."""
    entry = {"key": KEY, "start": "25 mm", "stop": "30 mm", "count": count}
    return {"vary": [entry, *more], "keep": kept or {"scalars": ["com_deviation_peak", "com_deviation_peak_by_axis"]}}


def deadly(point):
    """A batch that ends its process where it holds a point; the others take 30 ms a point more."""

    def compute(version, kept, points, studies):
        time.sleep(0.03 * len(points))
        if point in points:
            os.kill(os.getpid(), signal.SIGKILL)
        return compute_batch(version, kept, points, studies)

    return compute


def slow(seconds):
    """Batches that take so long a point more, however fast the processor is: time enough to be killed in."""

    def compute(version, kept, points, studies):
        time.sleep(seconds * len(points))
        done = compute_batch(version, kept, points, studies)
        return replace(done, seconds=done.seconds + seconds * len(points))

    return compute


def start(*arguments, **more):
    """A Python process that heeds SIGINT and imports what the tests import."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    return subprocess.Popen(
        [sys.executable, *map(str, arguments)],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment, **more,
    )  # fmt: skip
