"""Small dense solves leave the other cores alone, and BLAS as it was."""

import os
import subprocess
import sys
from threading import Thread

import pytest

from flexapod.common.resources import one_thread

pytestmark = pytest.mark.unit

SIMULATIONS = """
import time
import flexapod as fx

study = fx.preset("paper-robot")
counts = [{"modes": modes, "step": 1e-3, "duration": 0.05} for modes in (4, 6)]
for settings in counts:
    fx.simulate(study, **settings)
wall, cpu = time.perf_counter(), time.process_time()
for settings in 5 * counts:
    fx.simulate(study, **settings)
    fx.modes(study)
print(time.process_time() - cpu, time.perf_counter() - wall)
"""


def threads():
    import numpy as np
    import threadpoolctl

    assert np.linalg.inv(np.eye(2)).any()
    return [pool["num_threads"] for pool in threadpoolctl.threadpool_info() if pool["user_api"] == "blas"]


def times(**environment):
    alone = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    done = subprocess.run(
        [sys.executable, "-c", SIMULATIONS], env=alone | environment, capture_output=True, text=True, check=True,
        timeout=300,
    )  # fmt: skip
    return [float(word) for word in done.stdout.split()]


def test_simulations_use_one_core():
    """With matrices of 100 rows and more the threads of BLAS took up to eight times the time of one."""
    cpu, wall = times()
    assert cpu < 1.1 * wall
    assert cpu < 1.5 * times(OPENBLAS_NUM_THREADS="1")[0]


def test_blas_is_left_as_it_was():
    before = threads()
    with one_thread(), one_thread():
        assert set(threads()) == {1}
    assert threads() == before
    with pytest.raises(ValueError, match="seen"), one_thread():
        raise ValueError("seen")
    assert threads() == before


def test_who_leaves_last_restores():
    before, first, second = threads(), one_thread(), one_thread()
    first.__enter__()
    second.__enter__()
    other = Thread(target=first.__exit__, args=(None, None, None))
    other.start()
    other.join()
    assert set(threads()) == {1}
    second.__exit__(None, None, None)
    assert threads() == before
