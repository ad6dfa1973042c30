"""Forces of the rigid robot against MuJoCo, which closes its chains by itself: only the payload's motion is ours."""

import numpy as np
import pytest
from tests.helpers.pack_outcomes import outcome

from flexapod import kinematics
from flexapod.common.errors import ComputationError
from flexapod.model import AxisMotion, preset
from flexapod.verification.cases import mujoco_forces as case
from flexapod.verification.engines import mujoco_forces
from flexapod.verification.engines.mujoco_forces import mjcf
from flexapod.verification.robots import with_unequal_legs, without_cylinders

pytestmark = [
    pytest.mark.consistency,
    pytest.mark.xdist_group("pack of mujoco_forces"),
]  # one process computes its cases
mujoco = pytest.importorskip("mujoco")
ROBOT = preset("paper-robot").robot
ROLL = AxisMotion(type="roll", amplitude=0.3, duration=0.4, pivot=[0.02, 0.01, 0.1])


def path(robot, motion=ROLL, duration=0.4):
    return kinematics.poses(robot, motion, duration * np.linspace(0.05, 0.95, 9))


@pytest.fixture(scope="module")
def checks():
    return outcome("mujoco-forces").checks


def test_forces_on_motions_of_all_degrees_of_freedom(checks):
    assert len(checks) == 3 * 7 * 2
    # Rounding times the condition of the Jacobian; 2e-13 as a rule.
    assert max(check.error for check in checks) < 1e-11


@pytest.mark.parametrize("change", [with_unequal_legs, without_cylinders])
def test_the_chains_close_where_our_kinematics_says(change):
    robot = change(ROBOT)
    found, ours = (
        mujoco_forces.inverse_dynamics(robot, path(robot)),
        kinematics.inverse_kinematics(robot, path(robot)),
    )
    np.testing.assert_allclose(found.leg_length, ours.length, rtol=0, atol=1e-12)  # closed to 1e-13 m
    np.testing.assert_allclose(found.leg_angle, np.stack([ours.alpha, ours.beta], axis=-1), rtol=0, atol=1e-12)


def test_legs_without_cylinder():
    robot = without_cylinders(ROBOT)
    found, ours = (f(robot, path(robot)) for f in (mujoco_forces.inverse_dynamics, kinematics.inverse_dynamics))
    scale = np.abs(ours.actuator_force).max()
    # MuJoCo's least mass and moments, 1e-12 of a leg's, bound the rest
    np.testing.assert_allclose(found.actuator_force, ours.actuator_force, rtol=0, atol=1e-11 * scale)
    np.testing.assert_allclose(found.joint_force, ours.joint_force, rtol=0, atol=1e-11 * scale)


@pytest.mark.parametrize("part", ["cylinder", "piston"])
def test_the_spin_of_the_universal_joint_is_felt(part):
    """What the comparison would miss if either side forgot the turn about the leg's axis: far above its tolerance."""
    robot, motion = case.robots()["axial inertias, light payload"], case.motions()["all at once"]
    without = robot.replace(
        legs=[leg.replace(**{part: getattr(leg, part).replace(axial_inertia=0.0)}) for leg in robot.legs]
    )
    at = path(robot, motion, duration=case.DURATION)
    full, plain = (mujoco_forces.inverse_dynamics(r, at).joint_force for r in (robot, without))
    assert np.abs(full - plain).max() > 1e-5 * np.abs(full).max()


def test_every_mass_is_in_the_model():
    robot = with_unequal_legs(ROBOT)
    model = mujoco.MjModel.from_xml_string(mjcf(robot))
    data = mujoco.MjData(model)
    data.qpos[2:18:3] = robot.home_lengths
    mujoco.mj_forward(model, data)
    mass = robot.payload.mass + sum(leg.cylinder.mass + leg.piston.mass for leg in robot.legs)
    assert model.body_mass.sum() == pytest.approx(mass, rel=1e-14)
    # at home every chain points to its joint of the payload
    tips = data.xpos[[model.body(f"piston_{i}").id for i in range(1, 7)]]
    np.testing.assert_allclose(tips, robot.platform_joints + np.array([0, 0, robot.home_height]), rtol=0, atol=1e-14)
    T, V = kinematics.energies(robot, kinematics.home_pose(robot))
    mujoco.mj_energyPos(model, data)
    assert T[0] == 0
    assert data.energy[0] == pytest.approx(V[0], rel=1e-12)


def test_without_the_engine(monkeypatch):
    monkeypatch.setattr(type(mujoco_forces.MUJOCO), "is_available", lambda self: False)
    with pytest.raises(ComputationError, match=r"MuJoCo is not installed.*pip install"):
        mujoco_forces.inverse_dynamics(ROBOT, path(ROBOT))


def test_a_pose_that_the_chains_cannot_follow():
    far = kinematics.Poses.at_rest([[0.0, 0.0, 0.9], [np.nan, 0.0, 0.9]], np.eye(3))
    with pytest.raises(ComputationError, match="do not close at pose 2"):
        mujoco_forces.inverse_dynamics(ROBOT, far)
