"""Pistons of next to no mass and of none: the closed form of a payload on massless springs."""

import numpy as np
import pytest
from scipy.linalg import eigh
from tests.helpers.mechanisms import built, leg, ring
from tests.helpers.runs import paper_robot, with_legs

import flexapod as fx
from flexapod.analysis.description.robot_description import describe
from flexapod.common.errors import ComputationError, InputError
from flexapod.model import Cylinder, Piston, ServoDrive

pytestmark = pytest.mark.analytic

FOUR = np.arange(4) * 90.0
SERVO = ServoDrive(stiffness=4e7, damping=1e4)


def robot_study(rhoA, *, EA=1e8, servo=False, cylinders=False, gravity=0.0, **simulation):
    """The preset on pistons of `rhoA` [kg/m]; without cylinders and weight unless told."""
    study = with_legs(paper_robot(**simulation), lambda leg: leg.replace(
        cylinder=leg.cylinder if cylinders else Cylinder(mass=0.0, mouth=leg.cylinder.mouth),
        piston=leg.piston.replace(rhoA=rhoA, EA=EA, E=None, density=None),
        **({"drive": SERVO} if servo else {})))  # fmt: skip
    return study.replace(robot=study.robot.replace(gravity=[0, 0, -gravity]))


def struts(study, *, servo):
    """Frequencies [Hz] of the payload on springs along the legs."""
    robot, piston = study.robot, study.robot.legs[0].piston
    home, com = fx.kinematics.home_pose(robot), robot.payload.com
    J = fx.kinematics.length_jacobian(
        robot.base_joints, robot.platform_joints - com, home.position[0] + com, np.eye(3), np.zeros(3)
    )
    k = 1 / (piston.length / piston.EA + (1 / SERVO.stiffness if servo else 0.0))
    M = np.zeros((6, 6))
    M[:3, :3], M[3:, 3:] = robot.payload.mass * np.eye(3), robot.payload.inertia
    return np.sqrt(eigh(k * J.T @ J, M, eigvals_only=True)) / (2 * np.pi)


@pytest.mark.parametrize("servo", [False, True], ids=["prescribed", "servo"])
@pytest.mark.parametrize("fidelity", ["lumped", "assumed-modes"])
@pytest.mark.parametrize(
    ("EA", "rhoA"), [(1e12, 1e-6), (1e12, 1e-7), (1e12, 1e-8), (1e9, 1e-8), (1e8, 1e-12), (1e12, 0.0), (1e8, 0.0)]
)
def test_frequencies_are_those_of_springs(EA, rhoA, fidelity, servo):
    """Once 5.8, 23 and 67 % off at EA = 1e12 N. A milligram of piston is 1e-8 of the payload: 1e-8 of a frequency."""
    study = robot_study(rhoA, EA=EA, servo=servo, fidelity=fidelity)
    found = fx.modes(study)
    np.testing.assert_allclose(found.frequency[:6], struts(study, servo=servo), rtol=1e-6 if rhoA > 1e-7 else 1e-8)
    assert found.sizes["mode"] == 6 or rhoA > 0
    assert np.isfinite(found.frequency).all()
    assert np.isfinite(found.platform_shape).all()


def test_no_mass_is_the_limit_of_little_mass():
    """Statics, stiffness, maps and the cylinders' own modes do not notice whether a piston has 1e-9 kg/m or nothing."""
    little, none = (robot_study(rhoA, cylinders=True, gravity=9.81) for rhoA in (1e-9, 0.0))
    light, massless = fx.modes(little), fx.modes(none)
    assert (light.sizes["mode"], massless.sizes["mode"]) == (48, 18)  # of payload, and of cylinders across, two each
    np.testing.assert_allclose(massless.frequency, light.frequency[:18], rtol=1e-7)
    np.testing.assert_allclose(massless.damping_ratio, light.damping_ratio[:18], atol=1e-5)  # d goes with sqrt(rhoA)
    np.testing.assert_allclose(massless.com_sag, light.com_sag, rtol=1e-7, atol=1e-14)
    a, b = (fx.stiffness(study).stiffness.values for study in (little, none))
    np.testing.assert_allclose(a, b, atol=1e-8 * np.abs(a).max())
    heave = {"heave": [-0.3, 0.0, 0.02]}  # the first is out of reach
    a, b = (fx.workspace_map(study, heave, frequencies=30) for study in (little, none))
    assert (a.sizes["mode"], b.sizes["mode"]) == (30, 18)
    np.testing.assert_allclose(b.frequency, a.frequency[:, :18], rtol=1e-7)
    np.testing.assert_allclose(a.static_deviation, b.static_deviation, rtol=1e-7, atol=1e-14)
    poses = fx.modes(none, {"heave": [-0.3, 0.0]}, shapes=True)
    np.testing.assert_allclose(poses.frequency[1], massless.frequency, rtol=1e-12)
    assert poses.kind.values[1].tolist() == massless.kind.values.tolist()


@pytest.mark.parametrize("fidelity", ["lumped", "assumed-modes"])
def test_servo_drives_on_light_pistons_are_integrated(fidelity):
    """Steps of a millisecond once ended at t = 0 at 1e-9 kg/m, and gave a deviation 2 % off at 1e-6 kg/m."""
    at = {"fidelity": fidelity, "step": 1e-3, "duration": 0.3}
    heavier, *light = (
        fx.simulate(robot_study(rhoA, servo=True, cylinders=True, gravity=9.81), **at).com_deviation
        for rhoA in (1e-3, 1e-6, 1e-9)
    )
    # The six pistons of a gram a metre are 4.5e-5 of the payload. At 1e-9 kg/m rounding, of which digits differ by
    # processor, is a multiple of 2e-16 times the ratio of the masses, 1e11: 2e-5 a step.
    for data, most in zip(light, (5e-5, 1e-3), strict=True):
        assert float(np.abs(data - heavier).max()) < most * float(np.abs(heavier).max())


def test_no_mass_in_time():
    study = robot_study(0.0, cylinders=True, gravity=9.81)
    with pytest.raises(InputError, match="without mass: they have statics, but no motion in time") as error:
        fx.simulate(study, duration=0.01)
    assert "lumped" in error.value.allowed
    assert "1e-6 kg/m" in error.value.next_step
    assert any("a simulation is not possible" in remark for remark in describe(study).remarks)
    at = {"fidelity": "lumped", "step": 1e-3, "duration": 0.1}  # here the payload's mass stands behind every coordinate
    deviation, limit = (
        fx.simulate(robot_study(rhoA, cylinders=True, gravity=9.81), **at).com_deviation for rhoA in (0.0, 1e-5)
    )
    # 4.5e-7 of the payload are 2e-7 of its frequency, and 2 pi periods of that in phase.
    np.testing.assert_allclose(deviation, limit, rtol=0, atol=2e-6 * np.abs(limit).max())
    with pytest.raises(InputError, match="nothing that could vibrate"):
        fx.modes(study, fidelity="rigid")


@pytest.mark.parametrize("rhoA", [1e-6, 1e-9, 1e-12, 0.0])
def test_damping_beside_overdamped_light_parts(rhoA):
    """A servo's damper of 10 kN s/m holds a piston of micrograms: its rate of 1e16 1/s hid the payload's 10 rad/s."""
    study = with_legs(robot_study(rhoA, servo=True, fidelity="lumped"), damping=0.0)
    piston, found = study.robot.legs[0].piston, fx.modes(study)
    k = piston.EA / piston.length
    series = 1 / (1 / k + 1 / SERVO.stiffness)
    for omega, ratio in zip(2 * np.pi * struts(study, servo=True), found.damping_ratio.values[:6], strict=True):
        scale = omega**2 / series  # s^2 + scale k (k_d + c s) / (k + k_d + c s) = 0
        c, stiff = SERVO.damping, SERVO.stiffness
        roots = np.roots([c, k + stiff, scale * k * c, scale * k * stiff])
        slow = roots[np.imag(roots) > 0][0]
        assert ratio == pytest.approx(-slow.real / abs(slow), rel=1e-5)


@pytest.mark.parametrize("chain", ["FPF", "UPF"])
def test_welded_legs_without_mass_are_springs_too(chain):
    """Their stiffness was refused as infinite, because their twist was left out with their mass."""
    legs = [leg(chain, piston=Piston(length=0.8, EA=1.1e8, EI=5e3, rhoA=rhoA)) for rhoA in (0.0, 1e-9)]
    none, light = (built(f"4-{chain}", ring(0.3, FOUR), ring(0.2, FOUR + 20), 0.8, [each] * 4) for each in legs)
    K = [fx.stiffness(robot).stiffness.values for robot in (none, light)]
    np.testing.assert_allclose(K[0], K[1], rtol=1e-7, atol=1e-9 * np.abs(K[1]).max())  # a nanogram's weight
    lowest = [fx.modes(robot).frequency.values[:6] for robot in (none, light)]
    np.testing.assert_allclose(lowest[0], lowest[1], rtol=1e-7)


def test_what_masses_that_no_body_has_come_from():
    """A rod that hangs through by 5 % of its length was said to be too short."""
    rod = Piston(length=2.05, EA=1.1e8, EI=20.0, rhoA=1.0)
    legs = [
        leg("UPS", cylinder=Cylinder(mass=0.0, mouth=0.0), piston=rod, drive=ServoDrive(stiffness=1e6, damping=1e3))
    ]
    parts = {"payload": None, "platform_fixed": True}
    robot = built("1-UPS", np.zeros((1, 3)), [[2.0, 0, 0]], 0.0, legs, **parts)
    with pytest.raises(ComputationError, match="not positive: a leg bends so far under its load"):
        fx.modes(robot, modes=4)
    with pytest.raises(ComputationError, match="not positive: the piston of leg 1 is shorter than what the leg has"):
        fx.modes(robot.replace(legs=(legs[0].replace(piston=rod.replace(length=1.5)),)), modes=4)
