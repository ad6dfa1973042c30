"""Work that is shared with copies of this process, and other programs: none of them outlives who started it."""

import os
import signal
import subprocess
import sys
import time
from multiprocessing import active_children

import pytest
from tests.helpers.started import none_left, started_by

from flexapod.common.processes import forked_map, run_program

pytestmark = pytest.mark.unit


def slow_square(x):
    time.sleep(0.05)
    return x * x, os.getpid()


def made(make, given, processes):
    with forked_map(make, given, processes) as joined:
        return joined()


def test_results_keep_their_order_and_several_processes_work():
    found = made(slow_square, range(8), 2)
    assert [square for square, _ in found] == [x * x for x in range(8)]
    assert len({process for _, process in found}) == 2
    assert active_children() == []


@pytest.mark.parametrize("processes", [1, 2, 5])
def test_what_fails_is_raised_here(processes):
    def fails(x):
        if x == 2:
            raise ValueError("two")
        return x

    with pytest.raises(ValueError, match="two"):
        made(fails, range(4), processes)


def test_a_copy_that_dies_is_made_good():
    here = os.getpid()

    def dies(x):
        time.sleep(0.02)
        if os.getpid() != here:
            os._exit(9)
        return x

    assert made(dies, range(5), 2) == list(range(5))


def test_copies_work_before_they_are_waited_for(tmp_path):
    def marked(x):
        (tmp_path / str(x)).write_text(str(os.getpid()))

    with forked_map(marked, range(3), 2) as joined:
        until(lambda: len(list(tmp_path.iterdir())) == 3)
        assert str(os.getpid()) not in {path.read_text() for path in tmp_path.iterdir()}
        joined()


def test_nothing_to_do():
    assert made(slow_square, (), 2) == []


def until(true):
    end = time.monotonic() + 300  # of a machine with much else to do
    while not true():
        assert time.monotonic() < end
        time.sleep(0.01)


def large(x):
    return bytes(10_000_000)  # more than a pipe holds


def endless(x):
    while True:
        time.sleep(1)


@pytest.mark.parametrize("make", [large, endless])
def test_copies_that_nobody_asks_end_with_the_block(make):
    """A run whose results could not be saved left them asleep, as long as its process went on."""
    with pytest.raises(OSError, match="disk"), forked_map(make, range(6), 3):
        until(lambda: len(active_children()) == 2)
        raise OSError("disk is full")
    assert active_children() == []


def test_a_copy_that_ends_by_itself_puts_its_files_away(tmp_path):
    def writes(x):
        try:
            (tmp_path / str(x)).touch()
            endless(x)
        finally:
            (tmp_path / str(x)).unlink()

    before = signal.signal(signal.SIGTERM, signal.default_int_handler)  # as in commands
    try:
        with forked_map(writes, range(2), 2):
            until(lambda: list(tmp_path.iterdir()))
    finally:
        signal.signal(signal.SIGTERM, before)
    assert list(tmp_path.iterdir()) == []


AT_ONCE = """
import signal
from flexapod.common.processes import forked_map
for kind in (signal.SIGTERM, signal.SIGINT):
    signal.signal(kind, signal.default_int_handler)  # as in commands
for _ in range(300):
    with forked_map(lambda x: x, range(2), 2):
        pass
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_a_copy_that_is_ended_while_it_is_made_says_nothing():
    """What a signal raised among the first lines of a copy was printed as an exception that was ignored."""
    done = subprocess.run([sys.executable, "-c", AT_ONCE], capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stderr) == (0, "")


KILLED = {
    "in a pipe": "with forked_map(lambda x: bytes(10_000_000), range(9), 4): told(); time.sleep(600)",
    "at work": "with forked_map(lambda x: time.sleep(600), range(9), 4): told(); time.sleep(600)",
    "program": "told(); run_program(['sh', '-c', 'sleep 600 & sleep 600'], Path(sys.argv[1]), 600)",
    "program of a copy": "with forked_map(lambda x: run_program(['sleep', '600'], Path(sys.argv[1]), 600), range(9), 4)"
    " as f:\n    told(); f()",
}


@pytest.mark.skipif(sys.platform != "linux", reason="processes are found in /proc")
@pytest.mark.parametrize("what", KILLED)
def test_nothing_is_left_of_a_process_that_is_killed(what, tmp_path):
    """Copies slept for ever in the pipe that they held open themselves; compilers went on to their end."""
    script = (
        "import sys, time\nfrom pathlib import Path\nfrom flexapod.common.processes import forked_map, run_program\n"
    )
    script += f"def told(): print('begun', flush=True)\n{KILLED[what]}\n"
    with started_by([sys.executable, "-c", script, str(tmp_path)]) as (process, others):
        assert process.stdout.readline() == b"begun\n"
        until(lambda: len(others()) >= (1 if what == "in a pipe" else 3))  # a copy that came too late has ended
        process.kill()
        process.wait()
        none_left(others)


def test_a_program_is_told_apart_by_its_end(tmp_path):
    assert run_program(["sh", "-c", "echo said; exit 3"], tmp_path, 60) == ("said\n", 3)
    assert run_program(["sh", "-c", "cat"], tmp_path, 60) == ("", 0)  # nothing to read
    assert run_program(["sh", "-c", "kill -9 $$"], tmp_path, 60) == ("", -9)
    with pytest.raises(OSError, match="No such file"):
        run_program([str(tmp_path / "none")], tmp_path, 60)
