"""One closed leg of a robot against closed forms: locked actuator, thrust and buckling, axial vibration."""

import numpy as np
import pytest
from tests.helpers.one_leg import LEGS, PISTON, hertz, squared_frequencies
from tests.helpers.runs import paper_robot, with_legs
from tests.oracles import beams

from flexapod import kinematics
from flexapod.solve.modal.at_poses import robot_modes

pytestmark = pytest.mark.analytic

EULER = np.pi**2 * PISTON["EI"] / 0.6**2


@pytest.mark.parametrize(("mouth", "mass", "free", "table"), LEGS)
@pytest.mark.parametrize("plane", [0, 1])
def test_leg_with_locked_actuator(mouth, mass, free, table, plane):
    exact = beams.ups_leg_frequencies(mouth, mass, free, PISTON["EI"], PISTON["rhoA"], len(table))
    np.testing.assert_allclose(exact, table, rtol=1e-8)
    leg = {"mouth": mouth, "mass": mass, "free": free}
    three, six = (hertz(squared_frequencies(k, **leg))[plane::2][: len(table)] / exact - 1 for k in (3, 6))
    assert -1e-10 < three[0] < 2e-5  # Ritz values lie above; 1.3e-5 for the lightest cylinder
    assert abs(six[0]) < 1e-10
    assert 0 < six[1] < 2e-7
    if len(table) == 3:
        assert 0 < six[2] < 2e-4


@pytest.mark.parametrize(("mouth", "mass", "free", "table"), LEGS)
def test_eigenfunctions_of_the_free_beam_converge_slowly_on_a_pinned_leg(mouth, mass, free, table):
    # Their curvature's slope vanishes at the tip, where the joint pushes: the error falls only as k^-3.
    errors = [
        hertz(squared_frequencies(k, mouth=mouth, mass=mass, free=free, basis="clamped-free"))[0] / table[0] - 1
        for k in (3, 6, 12)
    ]
    assert 1e-3 < errors[0] < 2e-3
    np.testing.assert_allclose(np.log2(np.array(errors[:2]) / errors[1:]), 3.0, atol=0.35)


def test_a_massless_cylinder_of_no_length_leaves_a_pinned_beam():
    exact = beams.frequency(np.pi * np.array([1, 2]), 0.6, PISTON["EI"], PISTON["rhoA"])
    np.testing.assert_allclose(exact, [149.138, 596.553], rtol=0, atol=6e-4)
    assert hertz(squared_frequencies(3))[0] / exact[0] - 1 == pytest.approx(4.5e-4, rel=0.02)
    np.testing.assert_allclose(hertz(squared_frequencies(6))[:3:2], exact, rtol=1e-4)
    assert abs(hertz(squared_frequencies(6))[0] / exact[0] - 1) < 1e-5
    assert abs(hertz(squared_frequencies(9))[0] / exact[0] - 1) < 1e-10


@pytest.mark.parametrize("share", [-2.0, -1e3 / EULER, 1e3 / EULER, 0.5, 0.99])
def test_thrust_lowers_and_tension_raises_the_frequency(share):
    assert EULER == pytest.approx(143.0e3, rel=1e-3)
    # (omega / omega_0)^2 = 1 - P / P_cr: the sine stays the shape. Errors of omega^2 over omega_0^2, k = 6: 2e-6
    square = squared_frequencies(6, thrust=share * EULER)[0] / squared_frequencies(6)[0]
    assert square == pytest.approx(1 - share, abs=1e-8)
    if share == 1e3 / EULER:
        assert np.sqrt(square) == pytest.approx(0.996498, abs=6e-7)


def test_beyond_the_euler_load_the_leg_buckles():
    scale = squared_frequencies(6)[0]
    assert squared_frequencies(6, thrust=EULER * (1 - 1e-6))[0] / scale == pytest.approx(1e-6, rel=1e-3)
    assert squared_frequencies(6, thrust=EULER * (1 + 1e-6))[0] / scale == pytest.approx(-1e-6, rel=1e-3)


def test_axial_vibration_with_a_free_tip():
    exact = np.sqrt(200e9 / 7800.0) / (4 * 0.6)
    assert exact == pytest.approx(2110, abs=0.5)
    found = [hertz(squared_frequencies(1, axial=m, tip="free"))[2] / exact - 1 for m in (1, 2, 3, 4)]
    # one shape sqrt(3) / (pi / 2); two 0.45 %; further sines fight the slope at the free tip
    assert found[0] == pytest.approx(2 * np.sqrt(3) / np.pi - 1, rel=1e-12)
    assert found[1] == pytest.approx(4.5e-3, abs=5e-5)
    assert 0 < found[3] < found[2] < found[1]
    assert found[3] < 4e-4


@pytest.mark.parametrize(("modes", "tolerance"), [(3, 2e-5), (6, 1e-8)])
def test_legs_of_a_robot_whose_platform_cannot_move(modes, tolerance):
    # A platform of 1e12 kg holds the tips; twelve equal lateral modes remain above its own six.
    study = paper_robot()
    home = kinematics.inverse_kinematics(study.robot, kinematics.home_pose(study.robot)).length[0, 0]
    mouth = float(home - 0.6)

    def plain(leg):
        cylinder = leg.cylinder.replace(mouth=mouth, com=mouth / 2, inertia=3 * mouth**2 / 12, mass=3.0)
        return leg.replace(cylinder=cylinder, damping=0.0)

    study = with_legs(study, plain)
    payload = study.robot.payload.replace(mass=1e12, inertia=1e12 * np.eye(3))
    robot = study.robot.replace(payload=payload, gravity=[0, 0, 0])
    found = robot_modes(robot, study.simulation.replace(modes=modes)).frequency
    rod = study.robot.legs[0].piston
    inside = rod.rhoA * (mouth**3 - (mouth + 0.6 - rod.length) ** 3) / 3  # turns with the cylinder
    exact = beams.ups_leg_frequencies(mouth, 3.0, 0.6, rod.EI, rod.rhoA, 1, mouth**2 + inside)[0]
    assert found[5] < 1e-2 * exact
    np.testing.assert_allclose(found[6:18], exact, rtol=tolerance)
