"""CalculiX that is absent, crashes, hangs or fails: said clearly, and nothing left behind. Stand-ins play its part."""

import os
import time

import pytest

from flexapod import ComputationError
from flexapod.verification.engines import calculix

pytestmark = pytest.mark.consistency

TABLE = """
     E I G E N V A L U E   O U T P U T

 MODE NO    EIGENVALUE                       FREQUENCY
                                     REAL PART            IMAGINARY PART
                           (RAD/TIME)      (CYCLES/TIME     (RAD/TIME)

      1  -0.1000000E-05   0.0000000E+00   0.0000000E+00   0.1000000E-02
      2   0.3947842E+02   0.6283185E+01   0.1000000E+01   0.0000000E+00

     P A R T I C I P A T I O N   F A C T O R S
"""


@pytest.fixture
def stand_in(tmp_path, monkeypatch):
    """`stand_in(script)`: a program named ccx that runs a shell script and notes the folder it runs in."""

    def make(script):
        program = tmp_path / "bin" / "ccx"
        program.parent.mkdir()
        program.write_text(f"#!/bin/sh\npwd > '{tmp_path}/where'\n{script}\n", encoding="utf-8")
        program.chmod(0o755)
        monkeypatch.setenv("PATH", f"{program.parent}{os.pathsep}{os.environ['PATH']}")
        return tmp_path / "where"

    return make


def gone(where):
    return not os.path.exists(where.read_text(encoding="utf-8").strip())


def test_absent(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(ComputationError, match="apt-get install calculix-ccx"):
        calculix.run("*HEADING\n")


def test_crash_says_which_and_the_last_lines(stand_in):
    where = stand_in("for i in 1 2 3 4 5 6 7 8 9 10 11; do echo line $i; done; kill -SEGV $$")
    with pytest.raises(ComputationError, match=r"crashed \(SIGSEGV\).*line 10 \| line 11") as caught:
        calculix.run("*HEADING\n")
    assert "line 1 |" not in str(caught.value)
    assert gone(where)


def test_hang_is_stopped_with_all_it_started(stand_in, tmp_path):
    where = stand_in(f"echo thinking; sleep 777 & echo $! > '{tmp_path}/child'; wait")
    begin = time.perf_counter()
    with pytest.raises(ComputationError, match=r"did not end within 1 s.*thinking"):
        calculix.run("*HEADING\n", time_limit=1.0)
    assert time.perf_counter() - begin < 300  # of a machine with much else to do; the sleep is 777 s
    assert gone(where)
    child = int((tmp_path / "child").read_text(encoding="utf-8"))
    deadline = time.perf_counter() + 300
    while running(child) and time.perf_counter() < deadline:
        time.sleep(0.05)
    assert not running(child)


def running(pid):
    try:
        with open(f"/proc/{pid}/stat", encoding="utf-8") as file:
            return file.read().split(")")[1].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.parametrize("script", ["echo '*ERROR: no material'; exit 201", "echo ' *ERROR: no material'; exit 0"])
def test_error_in_its_words(stand_in, script):
    where = stand_in(script)
    with pytest.raises(ComputationError, match="no material"):
        calculix.run("*HEADING\n")
    assert gone(where)


def test_no_results_is_an_error(stand_in):
    stand_in("echo done")
    found = calculix.run("*HEADING\n")
    with pytest.raises(ComputationError, match=r"no frequencies.*done"):
        found.frequencies()
    with pytest.raises(ComputationError, match=r"no displacements of TIP.*done"):
        found.displacements("TIP")


def test_table_of_frequencies(stand_in):
    stand_in(f"cat > deck.dat <<'END'\n{TABLE}END")
    assert calculix.run("*HEADING\n").frequencies() == pytest.approx([0.0, 1.0], rel=1e-7)  # seven digits


def test_displacements_of_one_set(stand_in):
    rows = " displacements (vx,vy,vz) for set {} and time  {}\n\n         4  1.0E-03 -2.0E+00  3.0E+00\n\n"
    table = rows.format("OTHER", "0.5E+00") + rows.format("TIP", "0.1E+01") + rows.format("TIP", "0.2E+01")
    stand_in(f"cat > deck.dat <<'END'\n{table}     E I G E N V A L U E   N U M B E R    1\nEND")
    times, moved = calculix.run("*HEADING\n").displacements("tip")
    assert times.tolist() == [1.0, 2.0]
    assert moved.tolist() == [[[1e-3, -2.0, 3.0]]] * 2
