"""Ctrl-C during a run: what was computed is on disk, readable, and marked as partial."""

import json
import os
import re
import signal
import subprocess
import sys
import time

import pytest
import typer
from tests.helpers.started import heed_interrupts

from flexapod.analysis import open_results
from flexapod.app.cli import cli
from flexapod.app.cli.failures import report_failures

pytestmark = pytest.mark.cli

LONG = [
    ('duration = "2 s" ', 'duration = "1000 s" '),
    ("tolerance = 1e-4", 'step = "0.5 ms"\noutput_step = "10 ms"'),
    ('hold = "1 s" ', 'hold = "999 s" '),
]


def terminal():
    return pytest.importorskip("pty").openpty()


def read_until(source, pattern, seconds=300.0):
    """What a terminal shows until it has shown what matches."""
    shown, end = b"", time.monotonic() + seconds
    while not re.search(pattern, shown, re.DOTALL):
        assert time.monotonic() < end, shown.decode(errors="replace")[-2000:]
        shown += os.read(source, 4096)
    return shown


@pytest.mark.skipif(sys.platform == "win32", reason="needs a pseudo-terminal and SIGINT")
def test_interrupted_run(study, folder):
    source, sink = terminal()
    command = [sys.executable, "-m", "flexapod", "run", str(study(*LONG))]
    environment = os.environ | {"TERM": "xterm", "COLUMNS": "120"}
    run = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=sink, text=True, env=environment, preexec_fn=heed_interrupts
    )
    os.close(sink)
    shown = read_until(source, rb"simulating.* [1-9]\d?%")
    run.send_signal(signal.SIGINT)
    shown += read_until(source, b"stopped by Ctrl-C")
    out, _ = run.communicate(timeout=300)
    os.close(source)
    assert run.returncode == 130
    assert b"Traceback" not in shown
    assert "until the computation stopped" in out
    data = open_results(folder / "study-run" / "results.nc")
    assert data.attrs["partial"] == 1
    assert data.attrs["failure"] == "stopped by the user"
    assert 0 < float(data.time[-1]) < 1000
    assert (folder / "study-run" / "results.csv").is_file()


@pytest.mark.skipif(sys.platform == "win32", reason="SIGINT")
def test_interrupted_run_as_json(study, folder):
    command = [sys.executable, "-c", PROGRAM, str(study(*LONG))]
    run = subprocess.run(command, capture_output=True, text=True, timeout=300, preexec_fn=heed_interrupts)
    assert run.returncode == 130
    assert json.loads(run.stdout)["partial"] is True
    assert json.loads(run.stderr)["error"]["kind"] == "interrupt"
    assert open_results(folder / "study-run" / "results.nc").attrs["partial"] == 1


#: The command in a process that sends itself SIGINT when the simulation is under way.
PROGRAM = """
import os, signal, sys
from flexapod.app.cli import cli
from flexapod.output.text import terminal
from contextlib import contextmanager

calls = []

@contextmanager
def bar(*, quiet):
    def report(words, share):
        calls.append(words)
        if len(calls) == 5:
            os.kill(os.getpid(), signal.SIGINT)
    yield report

terminal.progress_bar = bar
sys.argv = ["flexapod", "run", sys.argv[1], "--json"]
cli.main()
"""


@pytest.mark.parametrize(
    "raised", [RuntimeError("Error building model validator: KeyboardInterrupt"), KeyboardInterrupt()], ids=type
)
def test_an_interrupt_that_a_library_turns_into_its_own_error(raised, capsys):
    """Ctrl-C while pydantic built a model ended as a fault of ours with exit code 1."""

    @report_failures
    def command():
        try:
            raise raised
        except BaseException as cause:
            raise ValueError("schema") from cause

    with pytest.raises(typer.Exit) as stopped:
        command()
    assert stopped.value.exit_code == 130
    assert "stopped by Ctrl-C" in capsys.readouterr().err


def test_ctrl_c_before_a_command_begins_is_no_traceback(monkeypatch):
    def interrupted():
        raise KeyboardInterrupt

    monkeypatch.setattr(cli, "program", lambda names: interrupted)
    monkeypatch.setattr(cli, "install_signal_handlers", lambda: None)
    with pytest.raises(SystemExit) as end:
        cli.main()
    assert end.value.code == 130
