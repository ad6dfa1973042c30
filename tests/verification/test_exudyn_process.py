"""Exudyn's process: absent, too slow, crashed, not converged, and silent."""

import os
import subprocess
import sys
import time
from dataclasses import replace

import pytest

from flexapod import model
from flexapod.common.errors import ComputationError
from flexapod.verification.engines import exudyn_process, exudyn_robot
from flexapod.verification.engines.engine import EXUDYN
from flexapod.verification.engines.exudyn_integration import Integration
from flexapod.verification.engines.exudyn_process import solve_in_process
from flexapod.verification.engines.exudyn_robot import simulate_robot

pytestmark = pytest.mark.consistency

ROLL = model.AxisMotion(type="roll", amplitude=0.05, duration=0.1)


class Does:
    """A problem that does something when it is read."""

    def __init__(self, what, *arguments):
        self.call = what, arguments

    def __reduce__(self):
        return self.call


def test_an_absent_engine_is_named_with_the_line_that_installs_it(monkeypatch):
    monkeypatch.setattr(exudyn_process, "EXUDYN", replace(EXUDYN, module="no_such_module"))
    with pytest.raises(ComputationError, match="not installed") as raised:
        solve_in_process(exudyn_robot.solve, None)
    assert EXUDYN.install in str(raised.value)


@pytest.mark.skipif(not EXUDYN.is_available(), reason="needs Exudyn")
class TestPresent:
    def test_a_process_that_does_not_end_is_stopped(self):
        begin = time.perf_counter()
        with pytest.raises(ComputationError, match=r"did not end within 0\.5 s"):
            solve_in_process(print, Does(time.sleep, 600), time_limit=0.5)
        assert time.perf_counter() - begin < 300  # of a machine with much else to do

    def test_a_crash_is_told_with_its_signal(self):
        with pytest.raises(ComputationError, match="SIGABRT"):
            solve_in_process(print, Does(os.abort))

    def test_no_convergence_is_told_with_its_words_and_nothing_is_printed(self, capfd):
        robot = model.preset("paper-robot").robot
        robot = robot.replace(legs=tuple(leg.replace(damping=0.0) for leg in robot.legs))
        # Forces of EA = 1e8 N cannot be computed to 1e-13 N.
        with pytest.raises(ComputationError, match="convergence failed"):
            simulate_robot(robot, ROLL, Integration(duration=0.01, tolerance=1e-13), elements=4, guide=0.02)
        simulate_robot(robot, ROLL, Integration(duration=0.01), elements=4, guide=0.02)
        assert capfd.readouterr() == ("", "")


def test_our_own_process_does_not_import_it():
    modules = ", ".join(
        f"flexapod.verification.engines.exudyn_{name}"
        for name in ("robot", "actuator", "builder", "process", "integration")
    )
    code = f"import sys, {modules}; sys.exit('exudyn' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
