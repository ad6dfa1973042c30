"""`flexapod sweep`: what it prints and writes; killed, interrupted, on a cluster whose scheduler goes and comes."""

import csv
import json
import os
import signal
import socket
import sys
import time

import numpy as np
import pytest
from tests.helpers.sweeps import quick, quick_text, start

import flexapod as fx
from flexapod.design.sweeps import open_sweep
from flexapod.design.sweeps import worker as batch
from flexapod.design.sweeps.worker import compute_batch

pytestmark = pytest.mark.cli

POSIX = pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
SWEEP = """
[[vary]]
key = "leg.piston.diameter"
start = "25 mm"
stop = "30 mm"
count = {count}

[keep]
scalars = ["com_deviation_peak", "com_deviation_peak_by_axis"]
"""


@pytest.fixture
def files(folder):
    """Study and sweep files; `files(120)` gives so many points."""

    def write(count=3, *, text=None):
        (folder / "study.toml").write_text(quick_text(), encoding="utf-8")
        (folder / "sweep.toml").write_text(text or SWEEP.format(count=count), encoding="utf-8")
        return "study.toml", "sweep.toml"

    return write


def result(folder):
    return open_sweep(folder / "study-sweep" / "sweep.sqlite")


def stored(folder):
    """Points in the store, while another process may be writing to it."""
    path = folder / "study-sweep" / "sweep.sqlite"
    return int((open_sweep(path).status != "pending").sum()) if path.exists() else 0


def test_what_it_prints_and_writes(flexapod, files, folder):
    run = flexapod("sweep", *files(), "--workers", "0")
    assert run.exit_code == 0, run.stderr
    for words in ("3 points: 3 computed.", "com_deviation_peak is smallest at point 2 (leg.piston.diameter = 30 mm)"):
        assert words in run.stdout
    names = {path.name for path in (folder / "study-sweep").iterdir()}
    assert names == {"sweep.sqlite", "sweep.csv", "sweep.png"}


def test_without_arrays_of_dask(files, folder):
    """To look for them xarray would import them, scipy's transforms and sparse matrices with them: a second."""
    seen = "print([m for m in ('dask.array', 'scipy.fft', 'scipy.sparse') if sys.modules.get(m)])"
    code = f"import sys\nfrom flexapod.app.cli.cli import main\ntry:\n    main()\nfinally:\n    {seen}"
    process = start("-c", code, "sweep", *files(), "--workers", "0", "--json", cwd=folder)
    out, err = process.communicate(timeout=300)
    assert process.returncode == 0, err
    assert out.splitlines()[-1] == "[]"
    with (folder / "study-sweep" / "sweep.csv").open(encoding="utf-8") as file:
        table = list(csv.DictReader(file))
    data = result(folder)
    assert [float(row["leg.piston.diameter [m]"]) for row in table] == data["leg.piston.diameter"].values.tolist()
    assert [float(row["com_deviation_peak_by_axis.z [m]"]) for row in table] == (
        data.com_deviation_peak_by_axis.sel(axis="z").values.tolist()
    )


def test_failures_in_words(flexapod, files, folder):
    text = '[[vary]]\nkey = "leg.stroke.max"\nvalues = ["1.05 m", "0.8 m", "0.85 m"]\n'
    run = flexapod("sweep", *files(text=text), "--workers", "0")
    assert run.exit_code == 0, run.stderr
    assert "3 points: 1 computed, 2 failed." in run.stdout
    assert "Failed: 1 point, first point 1: " in run.stdout
    assert (folder / "study-sweep" / "sweep.png").is_file()


def test_nothing_but_failures(flexapod, files, folder):
    run = flexapod(
        "sweep", *files(text='[[vary]]\nkey = "leg.stroke.max"\nvalues = ["0.8 m", "0.85 m"]\n'), "--workers=0"
    )
    assert run.exit_code == 1
    assert "2 points: 2 failed." in run.stdout


def test_json(flexapod, files, folder):
    run = flexapod("sweep", *files(), "--workers", "0", "--zarr", "--json", "--out", "there")
    assert run.exit_code == 0, run.stderr
    found = json.loads(run.stdout)
    assert (found["points"], found["computed"], found["failed"], found["pending"]) == (3, 3, 0, 0)
    smallest = found["scalars"]["com_deviation_peak"]["smallest_at"]
    assert smallest == {"point": 2, "leg.piston.diameter": 0.03}
    assert found["files"][:2] == ["there/sweep.sqlite", "there/sweep.zarr"]
    assert all((folder / file).exists() for file in found["files"])


def test_bad_input(flexapod, files, folder):
    text = '[[vary]]\nkey = "leg.piston.diametre"\nvalues = [1]\n'
    run = flexapod("sweep", *files(text=text))
    assert run.exit_code == 2
    assert "Error: leg.piston.diametre: unknown key" in run.stderr
    assert "sweep.toml" in run.stderr
    assert not (folder / "study-sweep").exists()


@pytest.mark.parametrize("more", [(), ("--scheduler", "x")])
def test_workers_below_zero_leave_nothing_behind(flexapod, files, folder, more):
    run = flexapod("sweep", *files(), "--workers", "-1", *more)
    assert run.exit_code == 2
    assert "Error: --workers = -1: is out of range" in run.stderr
    assert not (folder / "study-sweep" / "sweep.sqlite").exists()
    assert flexapod("sweep", *files(), "--workers", "0").exit_code == 0
    assert flexapod("sweep", *files(), "--workers", "-1", *more).exit_code == 2  # also where nothing is left to do


def test_a_scalar_that_no_point_has(flexapod, files):
    text = '[[vary]]\nkey = "simulation.fidelity"\nvalues = ["rigid"]\n[keep]\nscalars = ["first_frequency"]\n'
    run = flexapod("sweep", *files(text=text), "--workers", "0")
    assert run.exit_code == 0, run.stderr
    assert "first_frequency has no value: rigid legs on held strokes" in run.stdout


def test_another_sweep_in_the_same_place(flexapod, files):
    assert flexapod("sweep", *files(3), "--workers", "0", "--out", "there").exit_code == 0
    run = flexapod("sweep", *files(4), "--workers", "0", "--out", "there")
    assert run.exit_code == 2
    assert "holds another sweep of this study" in run.stderr
    assert "--out" in run.stderr


@pytest.mark.parametrize("form", [(), ("--json",)])
def test_interrupt(flexapod, files, folder, monkeypatch, form):
    def stopped(version, kept, points, studies):
        if 4 in points:
            raise KeyboardInterrupt
        return compute_batch(version, kept, points, studies)

    with monkeypatch.context() as pressed:
        pressed.setattr(batch, "compute_batch", stopped)
        run = flexapod("sweep", *files(8), "--workers", "0", *form)
    assert run.exit_code == 130
    assert "stopped by Ctrl-C after" in run.stderr
    assert "of 8 points, which are stored" in run.stderr
    assert "To continue, run the same command again" in run.stderr
    if form:
        assert json.loads(run.stdout)["pending"] > 0
    assert flexapod("sweep", *files(8), "--workers", "0").exit_code == 0
    assert (result(folder).status == "computed").all()


#: The command with points that take 30 ms, however fast the processor is.
SLOW = """
import signal, sys
from flexapod.app.cli import cli
from flexapod.design.sweeps import worker as batch
from tests.helpers.sweeps import slow

signal.signal(signal.SIGINT, signal.default_int_handler)
batch.compute_batch = slow(0.03)
sys.argv = ["flexapod", "sweep", "study.toml", "sweep.toml", *sys.argv[1:]]
cli.main()
"""


def slowly(*arguments):
    """The command in a group of processes of its own, as a terminal has one for it."""
    return start("-c", SLOW, *arguments, start_new_session=True)


def command(*arguments):
    return start("-m", "flexapod", "sweep", "study.toml", "sweep.toml", *arguments)


def wait(condition, what, seconds=300.0):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, what
        time.sleep(0.05)


def assert_right(data):
    """Points here and there are those of a run of their own, to the bit; all are there."""
    assert np.isfinite(data.com_deviation_peak.values).all()
    for point in range(0, data.sizes["point"], 20):
        diameter = float(data["leg.piston.diameter"][point])
        alone = {"vary": [{"key": "leg.piston.diameter", "values": [diameter]}]}
        assert data.com_deviation_peak[point] == fx.sweep(quick(), alone, workers=0).com_deviation_peak[0]


@POSIX
def test_killed_and_interrupted_with_real_workers(files, folder):
    """SIGKILL, then Ctrl-C as a terminal sends it to all processes, then to the end: the bits of one process."""
    files(160)
    killed = slowly("--workers", "1")
    wait(lambda: stored(folder) > 0, "nothing is stored")
    killed.kill()
    killed.communicate()
    first = stored(folder)
    assert 0 < first < 160
    stopped = slowly("--workers", "1")
    wait(lambda: stored(folder) > first, "nothing is added")
    os.killpg(stopped.pid, signal.SIGINT)
    _, shown = stopped.communicate(timeout=300)
    assert stopped.returncode == 130, shown
    assert "Traceback" not in shown
    done = stored(folder)
    assert f"stopped by Ctrl-C after {done} of 160 points" in shown
    assert first < done < 160
    last = command("--workers", "0")
    out, shown = last.communicate(timeout=300)
    assert "160 points: 160 computed." in out, shown
    assert_right(result(folder))


def free_port():
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


@pytest.fixture
def cluster(tmp_path):
    """A real scheduler and worker on loopback; `cluster()` starts the scheduler again, the worker finds it."""
    port, running = free_port(), []
    address = f"tcp://127.0.0.1:{port}"

    def dask(*arguments):
        process = start("-m", "dask", *arguments)
        running.append(process)
        return process

    def scheduler():
        dask("scheduler", "--host", "127.0.0.1", "--port", port, "--dashboard-address", "127.0.0.1:0")
        dask(
            "worker", address, "--nthreads", "1", "--no-nanny", "--no-dashboard",
            "--local-directory", tmp_path / "worker", "--death-timeout", "60",
        )  # fmt: skip
        return running[-2:]

    yield address, scheduler
    for process in running:
        process.kill()
        process.communicate()


@POSIX
def test_a_cluster_whose_scheduler_is_restarted(cluster, files, folder):
    address, launch = cluster
    files(120)
    scheduler, worker = launch()
    run = slowly("--scheduler", address)
    wait(lambda: stored(folder) > 0, "nothing is stored")
    scheduler.kill()
    out, shown = run.communicate(timeout=300)
    assert run.returncode == 1, out
    assert "the connection to the scheduler was lost" in shown
    assert "Nothing that was stored is lost: run the same command again to continue" in shown
    assert "Traceback" not in shown
    assert 0 < stored(folder) < 120
    worker.kill()
    launch()
    again = command("--scheduler", address)
    out, shown = again.communicate(timeout=300)
    assert again.returncode == 0, shown
    assert "120 points: 120 computed." in out
    assert_right(result(folder))
