"""Wherever and in whatever order points are computed, results are the same bits; what dies takes only itself along."""

import itertools
import os
import pickle
import signal
import sys
from contextlib import suppress

import numpy as np
import pytest
import xarray as xr
from tests.helpers.sweeps import deadly, diameters, quick, start

import flexapod as fx
from flexapod.common.errors import ComputationError, InputError, Malformed
from flexapod.design.sweeps import executors, open_sweep, run, worker
from flexapod.design.sweeps.executors import InProcess, WorkerDied
from flexapod.design.sweeps.worker import compute_batch, compute_packed

pytestmark = pytest.mark.contract


def sweep(count, **settings):
    return fx.sweep(quick(), diameters(count), **settings)


class Backwards(InProcess):
    """Several threads, as it seems, whose last batch is done first; a batch with a deadly point dies."""

    threads = 3
    deadly: frozenset[int] = frozenset()

    def result(self):
        kept, points, packed = self._waiting.pop()
        if self.deadly & set(points):
            raise WorkerDied(tuple(points))
        return compute_packed(compute_batch, self._version, kept, points, packed)


@pytest.fixture
def backwards(monkeypatch):
    made = []

    def executor(version, scheduler, workers):
        made.append(Backwards(version))
        return _Entered(made[-1])

    monkeypatch.setattr(run, "executor", executor)
    return made


class _Entered:
    def __init__(self, inner):
        self.inner = inner

    def __enter__(self):
        return self.inner

    def __exit__(self, *what):
        return None


def test_order_changes_nothing(backwards, tmp_path):
    there = sweep(14, store=tmp_path / "a.sqlite")
    assert len(backwards) == 1
    backwards.clear()
    reversed_ = fx.sweep(quick(), diameters(14), store=tmp_path / "b.sqlite")
    xr.testing.assert_identical(there, reversed_)


def test_only_the_deadly_point_fails(backwards, monkeypatch):
    monkeypatch.setattr(Backwards, "deadly", frozenset({25, 26}))
    made = sweep(40)
    assert np.flatnonzero(made.status.values == "failed").tolist() == [25, 26]
    assert made.message.values[25] == executors.DEADLY
    assert np.isfinite(made.com_deviation_peak.values[[24, 27]]).all()


def test_batches_grow_to_what_is_worth_a_task_and_shrink_at_the_end():
    batches = executors._Batches(list(range(1000)))
    sizes = []
    while batches.left:
        points = batches.take(2)
        sizes.append(len(points))
        batches.learn(worker.BatchResult(points=tuple(points), results=(), seconds=0.05 * len(points)))
    assert sizes[0] == 1
    assert max(sizes) == pytest.approx(executors.TASK / 0.05, abs=1)
    assert sum(sizes) == 1000
    ends, least = list(itertools.accumulate(sizes)), executors.LEAST / 0.05
    assert all(size <= max(least, -(-(1000 - end + size) // 4)) for size, end in zip(sizes, ends, strict=True))
    assert all(size >= least - 1 for size in sizes[1:-1])  # a task of less is more cost than work


def test_two_local_workers_one_of_which_dies(monkeypatch, tmp_path):
    """A real cluster: a worker killed in mid-task, and a point that kills every process it comes to."""
    alone = sweep(30, workers=0)
    monkeypatch.setattr(worker, "compute_batch", deadly(11))
    seen = []

    def progress(words, share):
        if words.startswith("1 of") and not seen:
            seen.append(_kill_a_worker())

    made = sweep(30, workers=2, store=tmp_path / "a.sqlite", progress=progress)
    assert seen == [True]
    assert np.flatnonzero(made.status.values == "failed").tolist() == [11]
    assert made.message.values[11] == executors.DEADLY
    others = np.arange(30) != 11
    for name in ("com_deviation_peak", "com_deviation_peak_by_axis"):
        assert (made[name].values[others] == alone[name].values[others]).all()
    monkeypatch.undo()
    xr.testing.assert_identical(sweep(30, workers=0, store=tmp_path / "a.sqlite", retry_failed=True), alone)


def _kill_a_worker():
    psutil = pytest.importorskip("psutil")
    children = psutil.Process().children(recursive=True)
    workers = []
    for child in children:
        with suppress(psutil.Error):  # one that ends meanwhile
            workers += [child.pid] * ("spawn_main" in " ".join(child.cmdline()))
    os.kill(workers[0], signal.SIGKILL)
    return True


def test_worker_of_another_version():
    with pytest.raises(ComputationError, match=r"a worker runs flexapod .*, the sweep 9.9"):
        compute_batch("9.9", None, [0], [quick()])


def test_a_worker_of_another_version_is_told_from_other_faults():
    """The error lost its kind on the way from a worker, and the user read that a task could not be run."""
    error = pickle.loads(pickle.dumps(worker.OtherVersion("a worker", next_step="Give")))
    assert (type(error), str(error)) == (worker.OtherVersion, "a worker. Give.")
    malformed = pickle.loads(pickle.dumps(Malformed("is bad", key="a", value=3)))
    assert (type(malformed), malformed.key, malformed.value) == (Malformed, "a", 3)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"workers": 1.5}, "workers = 1.5: is not a whole number"),
        ({"workers": "2"}, "workers = '2': is not a whole number"),
        ({"scheduler": 8786}, "scheduler = 8786: is not an address"),
        ({"workers": -1}, "workers = -1: is out of range"),
        ({"workers": 1, "scheduler": "tcp://127.0.0.1:1"}, "together with a scheduler"),
        ({"scheduler": "tcp://127.0.0.1:1"}, "scheduler = 'tcp://127.0.0.1:1': cannot be reached"),
        ({"scheduler": "somewhere"}, "cannot be reached"),
    ],
)
def test_bad_places(monkeypatch, settings, words):
    monkeypatch.setattr(executors, "CONNECT", 1.0)
    with pytest.raises(InputError, match=words):
        sweep(2, **settings)


@pytest.mark.skipif(sys.platform == "win32", reason="SIGKILL")
def test_a_script_without_a_guard_is_told_so(tmp_path):
    """Workers import the script: without a guard it would begin again in each of them."""
    script = tmp_path / "script.py"
    script.write_text(
        "import flexapod\nfrom tests.helpers.sweeps import diameters, quick\n"
        "flexapod.sweep(quick(), diameters(2), workers=1)\n",
        encoding="utf-8",
    )
    process = start(script)
    _, shown = process.communicate(timeout=300)
    assert process.returncode == 1
    assert 'if __name__ == "__main__":' in shown


def test_open_sweep_of_nothing(tmp_path):
    with pytest.raises(InputError, match="is not a store of a sweep"):
        open_sweep(tmp_path / "none.sqlite")
