"""What is not the study's fault: outputs that are full or closed, signals, names, files that are none."""

import logging
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from tests.helpers.short_runs import BRIEF
from tests.helpers.started import heed_interrupts

from flexapod.analysis import open_results, store
from flexapod.analysis.checks import resource_limits
from flexapod.app.cli import failures, options
from flexapod.app.cli.failures import report_failures

pytestmark = pytest.mark.cli

posix = pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")


def command(*arguments, **more):
    return subprocess.run(
        [sys.executable, "-m", "flexapod", *map(str, arguments)], stderr=subprocess.PIPE, text=True, timeout=300, **more
    )


@posix
@pytest.mark.parametrize("form", [[], ["--json"]])
def test_stdout_that_takes_no_more(study, form):
    """Once a fault of flexapod, or a traceback at the very end."""
    with open("/dev/full", "w") as full:
        done = command("check", study(), *form, stdout=full)
    assert done.returncode == 1
    assert "the output cannot be written: No space left on device" in done.stderr
    assert "Traceback" not in done.stderr
    assert "fault of flexapod" not in done.stderr


@posix
def test_short_words_into_a_full_output_and_a_closed_pipe(folder):
    with open("/dev/full", "w") as full:
        done = command("--version", stdout=full)
    assert (done.returncode, done.stderr.count("\n")) == (1, 2)
    read, write = os.pipe()
    os.close(read)
    done = command("--version", stdout=write)
    os.close(write)
    assert (done.returncode, done.stderr) == (1, "")  # who closed it knows


@posix
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_stderr_that_takes_no_more(folder, unbuffered):
    """Python tries once more at the end, which once made the exit code 120."""
    words = [sys.executable, "-m", "flexapod", "check", "none.toml"]
    with open("/dev/full", "w") as full:
        done = subprocess.run(words, stderr=full, timeout=300, env=os.environ | {"PYTHONUNBUFFERED": unbuffered})
    assert done.returncode == 2


@pytest.mark.parametrize("place", [".", "..", "sub"])
def test_a_new_file_that_is_a_folder(flexapod, folder, place):
    """`flexapod new .` once ended in a traceback."""
    (folder / "sub").mkdir()
    done = flexapod("new", place)
    assert (done.exit_code, done.exception.__class__) == (2, SystemExit)
    assert "is a folder" in done.stderr


@posix
def test_a_pipe_and_a_device_as_files(flexapod, folder, study):
    os.mkfifo(folder / "pipe.toml")
    for name in ("pipe.toml", "/dev/zero"):
        done = flexapod("check", name)
        assert done.exit_code == 2
        assert "it is not a regular file" in done.stderr
    done = flexapod("sweep", study(), "pipe.toml")
    assert done.exit_code == 2
    assert "it is not a regular file" in done.stderr


@posix
def test_names_that_are_not_utf8_are_refused_at_once(flexapod, study, monkeypatch):
    """Results once were computed and then lost, since neither NetCDF nor the report can hold such a name."""
    monkeypatch.setattr("flexapod.analysis.run", lambda *_, **__: pytest.fail("computed"))
    bad = os.fsdecode(b"b\xe9")
    file = study(*BRIEF)
    os.symlink(file, f"{bad}.toml")
    for arguments, words in (([f"{bad}.toml"], r"b\udce9.toml"), ([file, "--out", bad], r"--out")):
        done = flexapod("run", *arguments)
        assert done.exit_code == 2
        assert "has a name that is not UTF-8 text" in done.stderr
        assert words in done.stderr
    os.mkdir(bad)
    os.chdir(bad)
    assert "not UTF-8" in flexapod("modes", Path("..") / file, "--out", "here").stderr


def test_a_disk_too_small_is_told_before(flexapod, study, folder, monkeypatch):
    monkeypatch.setattr(resource_limits, "free_disk", lambda folder: 1000.0)
    done = flexapod("run", study(*BRIEF))
    assert done.exit_code == 2
    assert "more results than can be kept: 201 instants, 1.21 MB on the disk, where 0.001 MB is free" in done.stderr
    assert sorted(os.listdir(folder)) == ["study.toml"]


def test_a_disk_that_fills_while_modes_are_written(flexapod, study, folder, monkeypatch):
    def full(data, path, **_):
        Path(path).write_bytes(b"half")
        raise RuntimeError("NetCDF: HDF error")

    def say(path, size):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("flexapod.analysis.store.write", full)
    monkeypatch.setattr(store, "_fill", say)
    for arguments in (["modes", study(*BRIEF), "--out", "m"], ["run", study(*BRIEF), "--out", "m"]):
        done = flexapod(*arguments)
        assert done.exit_code == 2
        assert "cannot be written: No space left on device" in done.stderr
        assert os.listdir(folder / "m") == []


def test_a_page_of_verify_that_could_not_be_written_is_refused_first(flexapod, folder, monkeypatch):
    monkeypatch.setattr("flexapod.verification.pack.verify", lambda *_, **__: pytest.fail("computed"))
    (folder / "file").touch()
    for key in ("--html", "--markdown"):
        done = flexapod("verify", key, "file/page")
        assert done.exit_code == 2
        assert f"{key} = file: cannot be made: {folder}/file is a file" in done.stderr
    assert options.check_writable(None) is None


#: `flexapod run` in a process that gets a signal while results.nc is half written.
WRITING = """
import os, signal, sys
from flexapod.app.cli import cli
from flexapod.analysis import store

whole = store.write
def half(data, path, **more):
    open(path, "wb").write(b"half")
    os.kill(os.getpid(), signal.{name})
    return whole(data, path, **more)
store.write = half
sys.argv = ["flexapod", "run", sys.argv[1]]
cli.main()
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize(("name", "code"), [("SIGTERM", 143), ("SIGHUP", 129)])
def test_a_signal_while_results_are_written_leaves_nothing_half(study, folder, name, code):
    file = study(*BRIEF)
    done = subprocess.run(
        [sys.executable, "-c", WRITING.format(name=name), str(file)], capture_output=True, text=True, timeout=300,
        preexec_fn=heed_interrupts,
    )  # fmt: skip
    assert done.returncode == code
    assert f"stopped by {name}; files already written are whole" in done.stderr
    assert "Traceback" not in done.stderr
    left = os.listdir(folder / "study-run")  # figures that were done by then, and are whole
    assert not [name for name in left if name.startswith(".") or not name.endswith(".png")]


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize(
    ("module", "name"),
    [
        ("analysis.simulation", "RobotSimulation.values"),
        ("analysis.store", "save_csv"),
        ("output.report.figures", "concurrent_drawing"),
    ],
)
def test_a_signal_after_the_last_step_loses_nothing(study, folder, module, name):
    """The results were made and written once, and gone with a signal that came meanwhile."""
    *cls, function = name.split(".")
    code = (
        f"import os, signal, sys\nfrom flexapod.app.cli import cli\nimport flexapod.{module} as owner\n"
        + "".join(f"owner = owner.{part}\n" for part in cls)
        + f"whole, count = owner.{function}, []\n"
        "def once(*a, **k):\n    count.append(1)\n    len(count) == 1 and os.kill(os.getpid(), signal.SIGTERM)\n"
        f"    return whole(*a, **k)\nowner.{function} = once\n"
        "sys.argv = ['flexapod', 'run', sys.argv[1]]\ncli.main()"
    )
    done = subprocess.run([sys.executable, "-c", code, str(study(*BRIEF))], capture_output=True, text=True, timeout=300)
    assert done.returncode == 143 and "Traceback" not in done.stderr
    assert "stopped by SIGTERM at t = 0.2 s; the whole result is kept" in done.stderr
    found = open_results(folder / "study-run" / "results.nc")
    assert found.attrs["partial"] == 0 and float(found.time[-1]) == pytest.approx(0.2)


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_sigterm_keeps_what_was_computed(study, folder):
    changes = [('duration = "2 s" ', 'duration = "1000 s" '), ('hold = "1 s" ', 'hold = "999 s" ')]
    file = study(*changes, ("tolerance = 1e-4", 'step = "0.5 ms"\noutput_step = "10 ms"'))
    code = (
        "import os, signal, sys\nfrom flexapod.analysis.results import time_history as record\n"
        "from flexapod.app.cli import cli\n"
        "kept = record.recorded_arrays\ncount = []\n"
        "def some(*a):\n    count.append(1)\n    len(count) == 3 and os.kill(os.getpid(), signal.SIGTERM)\n"
        "    return kept(*a)\nrecord.recorded_arrays = some\nsys.argv = ['flexapod', 'run', sys.argv[1]]\ncli.main()"
    )
    done = subprocess.run([sys.executable, "-c", code, str(file)], capture_output=True, text=True, timeout=300)
    assert done.returncode == 143
    assert "stopped by SIGTERM at t = " in done.stderr
    assert open_results(folder / "study-run" / "results.nc").attrs["partial"] == 1


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_signals_that_are_ignored_stay_so(monkeypatch):
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)  # as nohup does
    term = signal.getsignal(signal.SIGTERM)
    try:
        failures.install_signal_handlers()
        assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGHUP, before)
        signal.signal(signal.SIGTERM, term)


@pytest.mark.parametrize(("form", "told"), [({}, "Compiling ...\n"), ({"json": True}, ""), ({"quiet": True}, "")])
def test_what_takes_its_time_is_told_in_words_only(capsys, form, told):
    @report_failures
    def slow(json=False, quiet=False):
        logging.getLogger("flexapod").info("Compiling")

    slow(**form)
    assert tuple(capsys.readouterr()) == ("", told)


#: A sweep in a terminal whose Ctrl-C comes when its first worker process has just been started.
STARTING = """
import os, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
from multiprocessing import popen_spawn_posix
import distributed
from flexapod.app.cli import cli

launch = popen_spawn_posix.Popen._launch
def announce(self, process):
    launch(self, process)
    print("started", flush=True)
popen_spawn_posix.Popen._launch = announce
if __name__ == "__main__":
    sys.argv = ["flexapod", "sweep", sys.argv[1], "s.toml", "--workers", "1"]
    cli.main()
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_ctrl_c_while_workers_start(study, folder):
    """Forty to a hundred lines of Dask and of its processes once followed the words."""
    (folder / "s.toml").write_text('[[vary]]\nkey = "payload.mass"\nvalues = [100, 101]\n', encoding="utf-8")
    (folder / "program.py").write_text(STARTING, encoding="utf-8")
    run = subprocess.Popen(
        [sys.executable, "program.py", str(study(*BRIEF))],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip
    assert run.stdout.readline() == "started\n"
    time.sleep(0.3)  # it imports Dask now
    os.killpg(run.pid, signal.SIGINT)
    _, told = run.communicate(timeout=300)
    assert run.returncode == 130
    assert told.startswith("Error: stopped by Ctrl-C")
    assert told.count("\n") <= 2
