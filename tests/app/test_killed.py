"""SIGKILL at any moment: no process is left of a command, and what it left in folders the next one removes."""

import os
import sys
import time
from pathlib import Path

import pytest
from tests.helpers.short_runs import BRIEF
from tests.helpers.started import none_left, started_by

from flexapod.common import files

pytestmark = [pytest.mark.cli, pytest.mark.skipif(sys.platform != "linux", reason="processes are found in /proc")]
#: A command that says when it is at a certain place, and stays there.
STAYING = """
import sys, time
from pathlib import Path
from flexapod.app.cli import cli

def stay(*_, **__):
    print("<here>", flush=True)
    time.sleep(600)

{place}
sys.argv = ["flexapod", *sys.argv[1:]]
cli.main()
"""


def killed(place, *arguments, others=0, **environment):
    """Run a command, kill it where it stays, and wait until nothing that it started runs."""
    command = [sys.executable, "-c", STAYING.format(place=place), *map(str, arguments)]
    with started_by(command, env=environment) as (process, running):
        said = []
        while b"<here>" not in (line := process.stdout.readline()):
            said.append(line)
            assert line, said
        until(lambda: len(running()) >= others)
        process.kill()
        process.wait()
        none_left(running)


def until(true):
    end = time.monotonic() + 300  # of a machine with much else to do
    while not true():
        assert time.monotonic() < end
        time.sleep(0.01)


def unfinished(folder):
    return [path for path in folder.rglob(files.UNFINISHED)]


def test_a_run_that_is_killed_while_it_draws(study, folder):
    """A copy that draws slept for ever in its pipe, 210 MB each."""
    file = study(*BRIEF)
    place = "from flexapod.app.cli import options\noptions.PROCESSES, options.MANY = 3, 0\noptions.write_data = stay"
    killed(place, "run", file, "--quiet", others=2)


@pytest.mark.parametrize("command", ["run", "new", "modes"])
def test_what_a_killed_command_left_is_removed_by_the_next(command, study, folder, flexapod):
    file = study(*BRIEF)
    arguments = {
        "run": ("run", file, "--no-figures"),
        "new": ("new", "other.toml", "--force"),
        "modes": ("modes", file, "--out", "modes"),
    }[command]
    killed("from flexapod.common import files\nfiles._settle = stay", *arguments)
    assert len(unfinished(folder)) == 1
    assert flexapod(*arguments).exit_code == 0
    assert unfinished(folder) == []


def test_a_compiler_that_works_for_a_command_that_is_killed(study, folder, flexapod):
    """It went on to its end, and what it worked on stayed in the temporary folder."""
    slow = folder / "slow-cc"
    slow.write_text('#!/bin/sh\ntouch "$TMPDIR/cc.s"\nsleep 600 & sleep 600\n')
    slow.chmod(0o755)
    temporary = folder / "temporary"
    temporary.mkdir()
    environment = {"CC": str(slow), "FLEXAPOD_CACHE": str(folder / "kernels"), "TMPDIR": str(temporary)}
    said = "import threading\nthreading.Thread(target=lambda: (time.sleep(0.1), print('<here>', flush=True))).start()"
    killed(said, "run", study(*BRIEF), "--quiet", others=4, **environment)
    left = list(temporary.iterdir())
    assert len(left) == 1 and (left[0] / "cc.s").exists()
    files.remove_abandoned(temporary)
    assert list(temporary.iterdir()) == []


def test_a_sweep_that_is_killed_while_its_workers_compute(study, folder):
    plan = Path("plan.toml")
    plan.write_text('[[vary]]\nkey = "payload.mass"\nstart = "90 kg"\nstop = "120 kg"\ncount = 4000\n')
    place = "from flexapod.design.sweeps import executors\nexecutors.DaskExecutor.result = stay"
    environment = {"FLEXAPOD_CACHE": os.environ.get("FLEXAPOD_CACHE", "")}
    killed(place, "sweep", study(*BRIEF), plan, "--workers", 2, "--quiet", others=3, **environment)
