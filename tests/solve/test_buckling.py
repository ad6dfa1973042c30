"""The load at which guided, stepped and tapered legs buckle: by `check`, by modes, by the march."""

import numpy as np
import pytest
from tests.helpers.mechanisms import planar
from tests.helpers.stepped import section

import flexapod as fx
from flexapod.analysis.description.robot_description import describe
from flexapod.model import AxisMotion, ConstantWrench, Guide, Load, Piston, Simulation, StepWrench, Study
from flexapod.solve.kernel import kernel

pytestmark = pytest.mark.consistency


@pytest.fixture
def interpreted(monkeypatch):
    """Without a compiler: some hundred steps of three legs are quicker than it."""
    kernel.cache_clear()
    monkeypatch.setenv("FLEXAPOD_COMPILER", "none")
    yield
    kernel.cache_clear()


def square_of_growth(study, moment):
    """Of the deflections a load that comes at once leaves to grow [1/s^2]."""
    load = Load(wrench=StepWrench(amplitude=[0, 0, 0, 0, 0, moment], time=0.0))
    data = fx.simulate(study, load=load, duration=0.06, step=4e-4, output_step=0.01)
    before, middle, after = (np.linalg.norm(data.tip_deflection.values[k]) for k in (-3, -2, -1))
    assert after < 1e-4  # small yet
    return (np.arccosh((before + after) / (2 * middle)) / 0.01) ** 2


def test_check_modes_and_march_have_one_buckling_load(interpreted):
    # A moment about its axis pushes the three legs of a planar robot alike; nothing else bends them but a trace of
    # gravity. Squares of frequencies are nearly straight lines over the load: to 1e-6 of it from 0.99 and 0.999 of it,
    # to 1e-4 from growth at 1.02 and 1.04; the integrator's error is (growth times step)^2 / 12 of the distance.
    piston = Piston.stepped([section(0.1, 0.012), section(0.12, 0.012, tip_diameter=0.009)])
    legs = {"guide": Guide(gland=4e6, head=3e6), "piston": piston, "axial_modes": 0, "damping": 0.0}
    robot = planar().replace(gravity=np.array([1e-6, 2e-6, 0.0]))
    robot = robot.replace(legs=tuple(leg.replace(**legs) for leg in robot.legs))
    still = AxisMotion(type="yaw", amplitude=0.0, duration=0.1)
    study = Study(robot=robot, motion=still, simulation=Simulation(duration=0.1))
    checked = [leg.euler_load for leg in describe(study).legs]
    limbs = fx.kinematics.rigid_limbs(robot)
    along = limbs.platform[0] - limbs.base[0]
    arm = np.cross(limbs.platform[0], along / np.linalg.norm(along))[2]

    def at_zero(shares, squares):
        slope = (squares[1] - squares[0]) / (shares[1] - shares[0])
        return shares[0] - squares[0] / slope

    def square(share):
        load = Load(wrench=ConstantWrench(value=[0, 0, 0, 0, 0, -share * 3 * arm * checked[0]]))
        frequency = fx.modes(study.replace(load=load)).frequency.values
        assert frequency[2] == pytest.approx(frequency[0], rel=1e-5)
        return frequency[0] ** 2

    np.testing.assert_allclose(checked, checked[0], rtol=1e-9)
    near = 0.99, 0.999
    assert at_zero(near, [square(x) for x in near]) == pytest.approx(1.0, abs=1e-6)
    beyond = 1.02, 1.04
    growth = [square_of_growth(study, -x * 3 * arm * checked[0]) for x in beyond]
    assert at_zero(beyond, growth) == pytest.approx(1.0, abs=1e-4)
