"""Undamped drives are remarked on; a tolerance that makes a run slow is told with the step that would have done."""

import numpy as np
import pytest
from tests.sweeps import quick

import flexapod as fx
from flexapod import model
from flexapod.surveys.convergence import quicker as module
from flexapod.surveys.convergence.quicker import Quicker, quicker


def with_drive(drive):
    robot = quick().robot
    return robot.replace(legs=tuple(leg.replace(drive=drive) for leg in robot.legs))


@pytest.fixture(scope="module")
def slow():
    """A servo without damping under a tolerance, and its result."""
    study = quick().replace(robot=with_drive(model.ServoDrive(stiffness=1e7)))
    study = model.override(study, tolerance=1e-6, duration=0.1)
    return study, fx.run(study)


def test_finds_the_longest_step_that_gives_the_same(slow):
    study, data = slow
    found = quicker(study, data, slow=0.0)
    assert found is not None
    again = fx.simulate(study, step=found.step)
    largest = np.linalg.norm(data.com_deviation, axis=1).max()
    difference = np.linalg.norm(again.com_deviation - data.com_deviation, axis=1).max() / largest
    assert difference == pytest.approx(found.difference, rel=1e-6) and difference <= module.SAME
    coarser = fx.simulate(study, step=2 * found.step) if found.step < study.simulation.output_step else None
    if coarser is not None:
        assert np.linalg.norm(coarser.com_deviation - data.com_deviation, axis=1).max() / largest > module.SAME
    assert found.times >= module.WORTH


def test_says_nothing_without_a_reason(slow):
    study, data = slow
    assert quicker(study, data) is None  # a fraction of a second is not slow
    assert quicker(model.override(study, step=1e-3), data, slow=0.0) is None
    assert quicker(study, data.assign_attrs(partial=1), slow=0.0) is None
    few = data.assign_attrs(steps=4 * 100 - 1)  # the output step itself would not be four times fewer
    assert quicker(study, few, slow=0.0) is None


def test_another_result_is_no_advice(slow):
    study, data = slow
    assert quicker(study, data.assign(com_deviation=data.com_deviation * 1.01), slow=0.0) is None


def test_a_single_actuator_too():
    study = model.override(fx.preset("paper-actuator"), modes=1, duration=0.2, tolerance=1e-7)
    found = quicker(study, fx.run(study), slow=0.0)
    assert found is not None and found.difference <= module.SAME


def test_words():
    words = Quicker(step=2.5e-4, times=68.2, difference=7.4e-4).words
    assert words == (
        'step = "0.25 ms" in place of the tolerance is 68 times faster, with the same result to 0.0007 of the largest '
        "deviation (measured)"
    )


@pytest.mark.parametrize(
    ("drive", "key"),
    [
        (model.ServoDrive(stiffness=1e7), "leg.drive.damping"),
        (model.ForceDrive(feedback=model.Feedback(stiffness=1e7)), "leg.drive.feedback.damping"),
    ],
)
def test_a_spring_without_damper_is_remarked_on(drive, key):
    """0.2 sqrt(1e7 N/m 100 kg / 6) = 2582 N s/m."""
    remarks = quick().replace(robot=with_drive(drive)).warnings
    assert len(remarks) == 1 and remarks[0].startswith("all legs: the ")
    assert f"no damping: what once vibrates on it goes on; {key} = 2600 N s/m" in remarks[0]


@pytest.mark.parametrize(
    "drive",
    [
        model.PrescribedDrive(),
        model.ServoDrive(stiffness=1e7, damping=1.0),
        model.ForceDrive(),
        model.ForceDrive(feedback=model.Feedback(stiffness=0.0)),
    ],
)
def test_others_are_not(drive):
    assert quick().replace(robot=with_drive(drive)).warnings == ()
