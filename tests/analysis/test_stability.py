"""Fixed steps that pass over what the motion leaves vibrating are told, with a step that does."""

import re

import numpy as np
import pytest
from tests.helpers.runs import paper_robot

from flexapod import simulate
from flexapod.analysis.checks.stability import steps_needed

pytestmark = pytest.mark.convergence


def after_the_roll(found):
    """Vibration of the payload about its mean in 0.3 s after the roll, (300, 3) [m]."""
    rest = found.com_deviation.values[1001:1301]
    return rest - rest.mean(axis=0)


def remarks(found):
    return [line for line in found.attrs["warnings"].splitlines() if "vibrating" in line]


def test_steps_that_pass_over_a_vibration_are_told():
    """With 0.5 ms the vertical vibration after the roll of `paper-robot` is a third; by Radau's method at 1e-7."""
    true = simulate(paper_robot(tolerance=1e-7, duration=1.31))
    coarse = simulate(paper_robot(step=5e-4, duration=1.31))
    size = np.ptp(after_the_roll(true)[:, 2])
    assert np.ptp(after_the_roll(coarse)[:, 2]) < 0.5 * size
    (remark,) = remarks(coarse)
    assert "79.3 Hz: 25.2 steps a period" in remark
    # A tenth of a period late, pi / 5 of the vibration: that is what is asked for.
    advised = float(re.search(r"step = (\S+) s$", remark)[1])
    fine = simulate(paper_robot(step=advised, duration=1.31))
    assert not remarks(fine)
    assert np.abs(after_the_roll(fine) - after_the_roll(true)).max() < np.pi / 5 * size


def test_with_the_steps_that_are_needed_a_vibration_is_a_tenth_of_a_period_late():
    """The trapezoidal rule turns an oscillator of angular frequency w by 2 atan(w h / 2) in a step, not by w h."""
    periods = np.array([30.0, 100.0, 1000.0])
    step = 2 * np.pi / steps_needed(periods)  # w h
    late = periods * (1 - 2 * np.arctan(step / 2) / step)
    np.testing.assert_allclose(late, 0.1, rtol=0.01)  # the next term is 12 (w h)^2 / 80 of it: 0.6 % at 30
    assert steps_needed(np.array([0.0, 1.0])).tolist() == [20.0, 20.0]


def test_a_slow_motion_leaves_nothing_to_be_followed():
    """A roll of 5 s excites less than a nanometre; the steps are ten a period of 79 Hz."""
    study = paper_robot(step=1.2e-3, output_step=1e-2)
    slow = study.replace(motion=study.motion.replace(duration=5.0, hold=0.1))
    assert not remarks(simulate(slow.replace(simulation=slow.simulation.replace(duration=5.1))))


def test_tolerances_have_no_such_remark():
    assert not remarks(simulate(paper_robot(tolerance=1e-2, duration=1.1)))


def test_a_run_that_ends_in_the_motion_has_none():
    """It stops the record, not the robot: no impact, which would leave 75 um."""
    assert not remarks(simulate(paper_robot(step=1e-3, duration=0.1)))
