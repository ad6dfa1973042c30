"""Rigid robots of many kinds in the time integration: forces of the drives against virtual power, second order."""

import numpy as np
import pytest
from tests.helpers.chains import NAMED, as_mechanism
from tests.helpers.mechanisms import AMPLITUDES, OWN, ROBOTS
from tests.oracles import virtual_power

import flexapod as fx
from flexapod.model import CombinedMotion

pytestmark = pytest.mark.consistency

DURATION, AT = 1.0, 0.4
KINDS = ["3-RPS", "3-SPR", "3-PRS", "3-UPU", "3-PUU", "3-UPS+UP", "6-PUS", "6-RUS", "6-UCU", "planar 3-PRR"]


def smooth(amplitude, t):
    """Value, rate, acceleration of the law `smooth`, written a second time."""
    s = t / DURATION
    g, h = 1 / s - 1 / (1 - s), 1 / s**2 + 1 / (1 - s) ** 2
    value = 1 / (1 + np.exp(g))
    rate = value * (1 - value) * h
    accel = value * (1 - value) * ((1 - 2 * value) * h**2 + 2 / (1 - s) ** 3 - 2 / s**3)
    return amplitude * np.array([value, rate / DURATION, accel / DURATION**2])


@pytest.mark.parametrize("name", KINDS)
def test_drive_forces_are_those_of_virtual_power(name):
    robot, own = ROBOTS[name](), OWN.get(name, tuple(NAMED))
    motion = CombinedMotion(amplitudes={axis: AMPLITUDES[axis] for axis in own}, duration=DURATION, profile="smooth")
    mechanism = as_mechanism(robot, own)
    state = virtual_power.follow(mechanism, *np.array([smooth(AMPLITUDES[axis], AT) for axis in own]).T)
    exact = virtual_power.forces(mechanism, state).drive
    errors = []
    for step in (4e-3, 2e-3):
        data = fx.simulate(robot, motion, fidelity="rigid", step=step, output_step=AT, duration=AT)
        errors.append(np.nanmax(np.abs(data["drive_force"].values[-1] - exact)) / np.nanmax(np.abs(exact)))
        assert data["closure_residual"].values.max() < 1e-14
    assert errors[1] < 2e-4  # h^2 / 12 times the square of some 15 rad/s
    assert errors[0] / errors[1] == pytest.approx(
        4, rel=0.1
    )  # at 2 ms rounding in forces of index 3 is still below 1e-8
