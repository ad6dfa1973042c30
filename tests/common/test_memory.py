"""Memory that a run has freed: the next takes it, and the system is not asked for more."""

import os
import subprocess
import sys

import pytest

from flexapod.common.resources import _glibc

pytestmark = pytest.mark.unit

#: Twice eight arrays of 2 MB each, and pages that the system had to give for the second eight.
ROUNDS = """
import resource
import numpy as np
from flexapod.common.resources import retain_freed_memory

def eight():
    return [np.ones(1 << 18) for _ in range(8)]

retain_freed_memory()
eight()
before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
eight()
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""


@pytest.mark.skipif(_glibc() is None, reason="another C library")
def test_what_a_run_frees_is_kept_for_the_next():
    """Where the environment asks for the contrary, too, as that of workers of Dask: 16 MB are 4096 pages of 4 kB."""
    environment = {**os.environ, "MALLOC_TRIM_THRESHOLD_": "65536"}
    words = subprocess.run([sys.executable, "-c", ROUNDS], env=environment, capture_output=True, check=True).stdout
    assert int(words) < 100


#: Things in circles that live while a module is asked for that is there already: how many of 200000 are there at last.
CIRCLES = """
import weakref
from flexapod.common.lazy_imports import load_module

class Thing:
    pass

def round():
    things = [Thing() for _ in range(1000)]
    for thing in things:
        thing.itself = thing
    load_module("flexapod.common.quantities")
    return [weakref.ref(thing) for thing in things]

there = [reference for _ in range(200) for reference in round()]
print(sum(reference() is not None for reference in there))
"""


def test_figures_that_nobody_has_do_not_grow_old_with_modules():
    """Python searches the oldest things when a quarter has come since: well below half of all are left at any time."""
    words = subprocess.run([sys.executable, "-c", CIRCLES], capture_output=True, check=True).stdout
    assert int(words) < 100_000
