"""The rigid robot as one object: paths, drive laws, checks."""

import numpy as np
import pytest
from tests.oracles.stewart_cases import base_circle, central_difference, platform_circle

from flexapod import kinematics
from flexapod.model import (
    AxisMotion,
    Cylinder,
    Leg,
    Payload,
    Piston,
    Robot,
    Stroke,
)

pytestmark = pytest.mark.unit

T = np.linspace(0, 1.2, 25)
ROLL = AxisMotion(type="roll", amplitude=np.deg2rad(26.6), duration=1.0, profile="smooth")
HEAVE = AxisMotion(type="heave", amplitude=0.3, duration=1.0)


def make(stroke=None, u_axis=None):
    leg = Leg(
        cylinder=Cylinder(mass=3.0, com=0.1575, inertia=0.0248, mouth=0.31518),
        piston=Piston(length=0.75, EA=1.145e8, EI=5217.0, rhoA=4.466),
        stroke=stroke,
        u_axis=u_axis,
    )
    return Robot(
        base_joints=base_circle(0.25, 10),
        platform_joints=platform_circle(0.15, 10),
        home_height=0.9,
        gravity=[0, 0, -9.81],
        payload=Payload(mass=100.0, inertia=[17.88, 17.88, 17.88], com=[0, 0.373, 0]),
        legs=(leg,) * 6,
    )


ROBOT = make()


def legs(robot, motion, t):
    return kinematics.inverse_kinematics(robot, kinematics.poses(robot, motion, t))


def test_strokes_start_at_home_and_have_exact_derivatives():
    found = legs(ROBOT, ROLL, T)
    np.testing.assert_allclose(found.length[0], ROBOT.home_lengths, rtol=1e-15)
    inner = T[3:20]
    slope = central_difference(lambda t: legs(ROBOT, ROLL, t).length, inner)
    np.testing.assert_allclose(found.rate[3:20], slope, atol=1e-10)
    slope = central_difference(lambda t: legs(ROBOT, ROLL, t).rate, inner)
    np.testing.assert_allclose(found.accel[3:20], slope, atol=1e-8)


def test_forward_kinematics_returns_the_path():
    path = kinematics.poses(ROBOT, ROLL, T)
    found = kinematics.forward_kinematics(ROBOT, kinematics.inverse_kinematics(ROBOT, path).length)
    np.testing.assert_allclose(found.position, path.position, atol=1e-11)
    np.testing.assert_allclose(found.rotation, path.rotation, atol=1e-11)


def test_home_is_among_the_postures():
    found = kinematics.postures(ROBOT, ROBOT.home_lengths)
    assert np.min(np.linalg.norm(found.poses.position - [0, 0, 0.9], axis=1)) < 1e-11


def test_power_balance_of_the_roll_closes():
    """Drive power is the change of energy, to 1e-8 of its peak."""
    t = T[3:20]
    path = kinematics.poses(ROBOT, ROLL, t)
    power = np.sum(
        kinematics.inverse_dynamics(ROBOT, path).actuator_force * kinematics.inverse_kinematics(ROBOT, path).rate,
        axis=1,
    )
    change = central_difference(lambda x: sum(kinematics.energies(ROBOT, kinematics.poses(ROBOT, ROLL, x))), t, h=2e-4)
    assert np.max(np.abs(power - change)) < 1e-8 * np.max(np.abs(power))


def test_wrench_is_carried_besides_the_weight():
    home = kinematics.home_pose(ROBOT)
    plain = kinematics.inverse_dynamics(ROBOT, home)
    pushed = kinematics.inverse_dynamics(ROBOT, home, [0, 0, 60, 0, 0, 0])
    np.testing.assert_allclose(
        pushed.joint_force.sum(axis=1) - plain.joint_force.sum(axis=1), [[0, 0, -60]], atol=1e-10
    )


def test_strokes_and_pull_out_of_a_path():
    robot = make(stroke=Stroke(min=0.7, max=1.1))
    length = legs(robot, HEAVE, T).length
    found = kinematics.strokes(robot, T, length)
    assert [e.leg for e in found] == [1, 2, 3, 4, 5, 6]
    assert found[0].value == pytest.approx(np.hypot(1.2, np.linalg.norm(robot.home_vectors[0, :2])))
    assert [e.kind for e in kinematics.pull_out(robot, T, length)] == ["is pulled out of its cylinder"] * 6
    np.testing.assert_array_equal(
        kinematics.reachable(robot, kinematics.poses(robot, HEAVE, T)), np.all(length <= 0.31518 + 0.75, axis=1)
    )
    assert kinematics.strokes(ROBOT, T, length) == []  # no stroke given: no limit


def test_singularity_of_the_roll_is_far():
    found = kinematics.singularity(ROBOT, kinematics.poses(ROBOT, ROLL, T))
    assert found.smallest_singular_value.shape == T.shape
    assert np.min(found.smallest_singular_value) > 0.1
    assert len(found.sign_changes) == 0


def test_forces_do_not_depend_on_the_universal_joint_without_axial_inertia():
    """A slender leg without axial inertia does not feel how the joint turns it about its axis."""
    path = kinematics.poses(ROBOT, ROLL, T)
    turned = kinematics.inverse_dynamics(make(u_axis=[1.0, 0.2, 0.0]), path)
    plain = kinematics.inverse_dynamics(ROBOT, path)
    np.testing.assert_allclose(turned.actuator_force, plain.actuator_force, rtol=1e-11)
    np.testing.assert_allclose(turned.joint_force, plain.joint_force, atol=1e-9)
