"""Legs with more than thirty coordinates: steps start on a cubic, matrices serve longer, the numbers are the same."""

from functools import cache

import numpy as np
import pytest
from tests.helpers.machines import BASE, SCREW, SOFT, TOP, machine, study
from tests.helpers.runs import balance, collect

from flexapod.model import Feedback, JointFriction, ScrewFriction
from flexapod.solve.time.native import LARGE
from flexapod.solve.time.robot_march import prepare

pytestmark = pytest.mark.convergence

RUBS = SOFT.replace(friction=JointFriction(mu=0.1, diameter=0.04))
DRIVE = SCREW.replace(command="servo", loop=Feedback(stiffness=5e3, damping=20.0), friction=ScrewFriction(torque=0.5))


@cache
def march(step, motion):
    """A heave of 20 mm that takes `motion` seconds, 0.1 s of it: what was marched, and its arrays."""
    robot = machine(base_joint=RUBS, platform_joint=RUBS, drive=DRIVE).replace(base_mount=BASE, platform_mount=TOP)
    one = study(robot, fidelity="assumed-modes", modes=2, step=step, duration=0.1, output_step=1e-3)
    prepared = prepare(one.replace(motion=one.motion.replace(duration=motion)))
    assert prepared.system.n > LARGE
    return prepared, collect(prepared.chunks)


def test_energy_balances_to_the_second_order():
    # A half of the step leaves a quarter, within a tenth of the order: the start of a step is not in its result.
    left = [np.ptp(balance(march(step, 0.1)[1])) for step in (5e-4, 2.5e-4, 1.25e-4)]
    np.testing.assert_allclose(np.log2(np.divide(left[:-1], left[1:])), 2.0, atol=0.1)


def test_closures_are_those_of_small_legs():
    assert march(2.5e-4, 0.1)[1]["closure"].max() < 1e-13  # rounding of metres


def test_two_corrections_a_step_nearly_and_few_matrices():
    # Along straight lines, with matrices for 32 steps: 2.43 corrections and 0.0325 matrices a step.
    counters = march(2.5e-4, 0.5)[0].counters
    assert counters.iterations < 2.25 * counters.steps
    assert counters.factorisations < 0.02 * counters.steps
