"""Vibration along a path that turns a robot with heavy legs far, against the nonlinear march in time."""

import numpy as np
import pytest
from tests.helpers.six_springs import AFTER, MOVING, turning

import flexapod as fx
from flexapod.commissioning.feedforward.modal_path import path_vibration

pytestmark = pytest.mark.consistency


def test_legs_with_mass_shake_the_tool_as_the_march_in_time_says() -> None:
    """Their inertia acts by how the payload moves them at each pose; the march is not linear. Left out as above."""
    study, own = turning(), fx.preset("paper-robot").robot.legs
    legs = tuple(x.replace(damping=0.0, cylinder=x.cylinder.replace(mass=60.0, inertia=10.0)) for x in own)
    study = study.replace(robot=study.robot.replace(legs=legs))
    found = path_vibration(study, MOVING, MOVING + AFTER)
    data = fx.simulate(fx.model.override(study, step=5e-5, output_step=5e-4, duration=MOVING + AFTER))
    time, exact = data.time.values, data.tool_deviation.values
    tool = np.stack([np.interp(time, found.time, column) for column in found.tool.T], axis=1)
    moving = time <= MOVING
    for part in (moving, ~moving):
        np.testing.assert_allclose(tool[part], exact[part], rtol=0, atol=0.01 * np.abs(exact[part]).max())
