"""Compilers that hang, say nothing, make nothing, or are configured and not there."""

import logging
import stat
import sys
import time
from pathlib import Path

import pytest
from tests.helpers.counted_compiles import Compile

from flexapod.common.errors import ComputationError
from flexapod.mechanics.symbolic import compiler

pytestmark = [
    pytest.mark.unit,
    pytest.mark.optimised,
    pytest.mark.skipif(sys.platform == "win32", reason="scripts as programs"),
]


@pytest.fixture
def program(tmp_path, monkeypatch):
    """A compiler that is a shell script, set as CC, with a cache of its own."""
    monkeypatch.setenv("FLEXAPOD_CACHE", str(tmp_path / "cache"))
    compiler._say_passed_over.cache_clear()

    def make(script: str) -> Path:
        path = tmp_path / "my compiler"
        path.write_text(f"#!/bin/sh\n{script}\n", encoding="utf-8")
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
        monkeypatch.setenv("CC", str(path))
        return path

    return make


def compiled():
    return Compile()()


def test_a_compiler_that_hangs_is_stopped_with_what_it_started(program, tmp_path, monkeypatch):
    program(f"sleep 600 & echo $! > '{tmp_path}/child'; wait")
    monkeypatch.setattr(compiler, "LONGEST", 2.0)
    begin = time.monotonic()
    with pytest.raises(ComputationError, match=r"did not end within 2 s and was stopped.*Set CC"):
        compiled()
    assert time.monotonic() - begin < 300  # of a machine with much else to do; the sleep is 600 s
    child = Path("/proc") / (tmp_path / "child").read_text().strip() / "stat"
    while child.exists() and child.read_text().split()[2] != "Z":  # what was killed dies when its turn comes
        assert time.monotonic() - begin < 300
        time.sleep(0.01)


def test_a_silent_compiler_is_told_by_its_exit_status(program):
    program("exit 3")
    with pytest.raises(ComputationError, match=r"said nothing; its exit status is 3\."):
        compiled()


def test_a_compiler_that_makes_nothing(program):
    program("exit 0")
    with pytest.raises(ComputationError, match=r"exit status is 0, and made no library"):
        compiled()


def test_a_configured_compiler_that_is_not_there_is_said_to_be_passed_over(program, monkeypatch, caplog):
    program("exit 1")
    monkeypatch.setenv("CC", "icc-of-last-year -O3")
    found = compiler.compiler()
    assert compiler.compiler() == found
    assert [record.getMessage() for record in caplog.records] == [
        f"CC = icc-of-last-year -O3 is passed over: there is no such program. Used instead: {found[0]}"
    ]


def test_a_configured_compiler_may_have_arguments_and_spaces(program, monkeypatch, caplog):
    path = program("exit 1")
    assert compiler.compiler() == [str(path)]
    monkeypatch.setenv("CC", f"'{path}' -m64")
    assert compiler.compiler() == [str(path), "-m64"]
    assert not caplog.records


@pytest.mark.parametrize("own", ["", " -march=x86-64-v2", " -mcpu=cortex-a72"])
def test_a_target_in_the_command_is_the_target(program, tmp_path, monkeypatch, own):
    """The processor's own came after it, and the last one counts."""
    path = program(f"echo $* >> '{tmp_path}/asked'; exit 1")
    monkeypatch.setenv("CC", f"'{path}'{own}")
    with pytest.raises(ComputationError):
        compiled()
    asked = (tmp_path / "asked").read_text().splitlines()
    targets = [[word for word in line.split() if word.startswith(("-march", "-mcpu"))] for line in asked]
    assert targets == ([[own.strip()]] if own else [["-march=native"], []])


def test_a_compilation_that_takes_its_time_is_told(program, monkeypatch, caplog):
    program("sleep 0.5; exit 1")
    monkeypatch.setattr(compiler, "SILENT", 0.05)
    with caplog.at_level(logging.INFO), pytest.raises(ComputationError):
        compiled()
    assert "Compiling the equations of motion" in caplog.text
