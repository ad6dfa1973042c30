"""Durations, output steps and steps that do not fit each other: remarked on or refused, never ignored."""

import numpy as np
import pytest
from tests.helpers.runs import paper_robot

import flexapod as fx
from flexapod.analysis import check_path
from flexapod.model import AxisMotion
from flexapod.solve.time.robot_march import prepare

pytestmark = pytest.mark.unit

QUICK = {"fidelity": "lumped", "step": 1e-3}


def test_a_rest_shorter_than_an_output_step_is_left_out_with_a_remark():
    data = fx.simulate(paper_robot(**QUICK), duration=0.0267, output_step=0.01)
    assert data.time.values == pytest.approx([0.0, 0.01, 0.02])  # not 0.03, which is beyond the duration
    assert "0.0267 s is not a multiple of simulation.output_step = 0.01 s: results end at t = 0.02 s" in data.warnings
    np.testing.assert_array_equal(
        fx.inverse_kinematics(paper_robot(), duration=0.0267, output_step=0.01).time, data.time
    )


def test_decimal_fractions_are_whole_multiples():
    for duration, output_step, count in ((0.3, 1e-3, 301), (0.07, 0.01, 8), (1.1, 0.1, 12)):
        study = paper_robot(duration=duration, output_step=output_step)
        assert fx.inverse_kinematics(study).sizes["time"] == count
        assert check_path(study) == []


@pytest.mark.parametrize("name", ["output_step", "step"])
def test_no_output_after_the_start_is_refused(name):
    with pytest.raises(fx.InputError, match="is longer than the simulation") as error:
        fx.simulate(paper_robot(), duration=0.05, **{name: 1.0})
    assert error.value.key == f"simulation.{name}"


def test_a_step_longer_than_the_output_step_is_told():
    data = fx.simulate(paper_robot(fidelity="lumped"), duration=0.02, step=5e-3)
    assert data.sizes["time"] == 5
    assert "results are stored at every step" in data.warnings


def test_a_jump_between_outputs_is_met_by_a_step():
    """It was refused; the same motion with outputs on its end agrees."""
    motion = AxisMotion(type="heave", amplitude=0.001, duration=0.0105, profile="linear")
    study = paper_robot(fidelity="lumped", step=5e-4, duration=0.02).replace(motion=motion)
    assert check_path(study) == []
    between, on = (fx.simulate(study, output_step=step) for step in (1e-3, 5e-4))
    # The same steps; Newton starts anew at each output interval with a break, 1e-14 m, which rings on undamped.
    np.testing.assert_allclose(between.com_position, on.com_position[::2], atol=1e-11)
    np.testing.assert_allclose(between.work_drive, on.work_drive[::2], rtol=1e-9)


def test_the_single_actuator_is_treated_alike():
    study = fx.preset("paper-actuator")
    data = fx.simulate_actuator(study, duration=0.0267, output_step=0.01)
    assert data.sizes["time"] == 3
    assert "results end at t = 0.02 s" in data.warnings
    with pytest.raises(fx.InputError, match="is longer than the simulation"):
        fx.simulate_actuator(study, duration=0.05, output_step=0.1)


def test_a_tolerance_out_of_reach_is_found_without_minutes_of_work():
    """1e-14 of 20 um is far below what rounding leaves of a metre."""
    found = prepare(paper_robot(fidelity="lumped", duration=0.2, tolerance=1e-14))
    with pytest.raises(fx.ComputationError, match="tolerance 1e-14 is out of reach at t = 0"):
        list(found.chunks)
    assert found.counters.steps < 3e5


@pytest.mark.parametrize("duration", [2e5, 1e9])
def test_results_that_no_machine_could_hold_are_refused(duration):
    study = paper_robot(duration=duration, output_step=1e-3)
    with pytest.raises(fx.InputError, match=r"output_step = 0.001: asks for more results than .* GB of memory.*Give"):
        fx.simulate(study)
    with pytest.raises(fx.InputError, match="more results than can be kept"):
        fx.inverse_kinematics(study)
