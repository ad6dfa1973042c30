"""A load that comes all at once swings a robot at rest to twice its static deflection."""

import numpy as np
import pytest
from tests.helpers.runs import paper_robot

import flexapod as fx
from flexapod.model import AxisMotion, StepWrench

pytestmark = pytest.mark.analytic

FORCE = 100.0  # [N] upwards
STEP = 2e-5  # [s]; the period of the vertical mode, 2.2 ms, has 109


def still_robot():
    """Symmetric about z, undamped, at rest: a vertical force moves it vertically."""
    study = paper_robot(leg={"damping": 0.0}, fidelity="lumped", step=STEP)
    payload = study.robot.payload.replace(com=[0, 0, 0], tool=[0, 0, 0])
    motion = AxisMotion(type="heave", amplitude=0.0, duration=0.1)
    return study.replace(motion=motion, robot=study.robot.replace(payload=payload))


@pytest.mark.parametrize("time", [0.0, 0.002])
def test_step_of_force_on_the_robot_at_rest(time):
    """A step at t = 0 once belonged to the equilibrium start, so that it moved nothing."""
    study = still_robot()
    wrench = StepWrench(amplitude=[0, 0, FORCE, 0, 0, 0], time=time)
    data = fx.simulate(study, load=wrench, duration=0.02, output_step=STEP)
    z = data.com_position.values[:, 2] - data.com_position.values[0, 2]
    static = FORCE / float(fx.stiffness(study).stiffness[2, 2])
    # (1 - cos) of the one vertical mode of legs that only stretch. Outputs may miss its peak by (pi / 109)^2 / 4 = 2e-4
    # of it, and the sudden change within a step as much again.
    assert np.ptp(z) == pytest.approx(2 * static, rel=4e-4)
    assert z[data.time < time - STEP / 2] == pytest.approx(0.0, abs=1e-12)


def test_a_constant_load_belongs_to_the_equilibrium():
    data = fx.simulate(still_robot(), load=[0, 0, FORCE, 0, 0, 0], duration=0.05)
    assert np.ptp(data.com_position.values[:, 2]) < 1e-12
