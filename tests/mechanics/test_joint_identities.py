"""Joints that must be others: flexures that are soft or stiff, cranks of great radius, mirrored robots."""

from dataclasses import replace
from unittest.mock import patch

import numpy as np
import pytest
from tests.helpers.mechanisms import LOWER, UPPER, built, hexapod, leg, ring, rod, sliders, tricept
from tests.helpers.runs import uncompiled_kernel
from tests.helpers.systems import hold, robot, solved, tangents
from tests.helpers.systems import ring as circle

from flexapod import kinematics
from flexapod.analysis.results.poses import poses_about_home
from flexapod.model import Simulation
from flexapod.model.leg.joint import Carriage, Joint
from flexapod.solve.modal.at_poses import robot_stiffness
from flexapod.solve.statics.ideal_robot import rigid_forces

pytestmark = pytest.mark.consistency

FLEXIBLE = Simulation(fidelity="assumed-modes", modes=2)


@pytest.fixture(autouse=True)
def interpreted():
    with patch("flexapod.solve.robot_system.kernel", uncompiled_kernel):
        yield


def flexures(base, platform):
    """6-FPF with springs (bending, torsion) [N m/rad] at the ends of the legs."""
    ends = {
        "base_joint": Joint(bending=base[0], torsion=base[1]),
        "platform_joint": Joint(bending=platform[0], torsion=platform[1]),
    }
    found = hexapod("FPF")
    return found.replace(legs=tuple(x.replace(**ends) for x in found.legs), gravity=[0, 0, 0])


def tool_stiffness(model):
    return robot_stiffness(model.replace(gravity=[0, 0, 0]), FLEXIBLE).total


def test_flexures_without_stiffness_are_universal_joints_and_balls():
    """Springs of 1e-3 N m/rad beside a tilting stiffness of 1e7; the base's torsion alone is held by a stiff one."""
    expected = tool_stiffness(hexapod())
    found = tool_stiffness(flexures((1e-3, 1e9), (1e-3, 1e-3)))
    np.testing.assert_allclose(found, expected, atol=1e-9 * np.abs(expected).max())


def test_stiff_flexures_are_welds():
    """What is lacking is inversely proportional to the springs; extrapolated it vanishes."""
    welded = tool_stiffness(hexapod("FPF"))
    one, ten = (tool_stiffness(flexures((k, k), (k, k))) - welded for k in (1e9, 1e10))
    size, share = np.abs(welded).max(), np.abs(one).max() / np.abs(ten).max()
    assert share == pytest.approx(10.0, rel=1e-3)
    np.testing.assert_allclose((10 * ten - one) / 9, 0.0, atol=1e-9 * size)


def test_a_passive_leg_without_mass_carries_nothing_along_itself():
    found = tricept()
    light = found.legs[3].replace(
        cylinder=found.legs[3].cylinder.replace(mass=0, com=0, inertia=0), piston=found.legs[3].piston.replace(rhoA=0.0)
    )
    found = found.replace(legs=(*found.legs[:3], light))
    path = kinematics.home_pose(found)
    forces = rigid_forces(kinematics.RigidPoses(found, path), np.array([30.0, -20, -100, 5, 4, 3]))
    axes = kinematics.leg_axes(found, path, kinematics.inverse_kinematics(found, path))
    along = (forces.joint_force[:, 3] * axes[:, 3]).sum(axis=-1)
    assert np.abs(along).max() < 1e-12 * np.abs(forces.joint_force).max()
    assert forces.drive_force[0, 3] == 0
    assert np.abs(forces.joint_force[0, 3]).max() > 10  # it guides all the same


def cranks(radius, feet):
    """The legs of `sliders` on cranks whose ends, at `feet` at home, move along the rails to first order."""
    arms, legs = radius * ring(1.0, LOWER), []
    for arm in arms:
        axis = np.cross(arm / radius, [0.0, 0.0, 1.0])
        carriage = Carriage(kind="crank", axis=axis, arm=arm, home=0.0)
        legs.append(leg("RUS", carriage=carriage, strut=rod(0.65)))
    return built("6-RUS", feet - arms, ring(0.15, UPPER), 0.6, legs)


def test_cranks_of_great_radius_are_sliders():
    """Without weight of their own: that of a slider acts along its rail, that of a balanced crank not at all."""
    model = sliders("PUS")
    model = model.replace(legs=tuple(x.replace(carriage=x.carriage.replace(mass=0.0)) for x in model.legs))
    wrench, way = np.array([30.0, -20, -100, 5, 4, 3]), np.array([[0.02, -0.01, 0.03, 0.05, -0.04, 0.1]])
    expected = rigid_forces(kinematics.RigidPoses(model, poses_about_home(model, way)), wrench).drive_force
    errors = []
    for radius in (100.0, 1000.0):
        found = cranks(radius, model.home_bases)
        force = rigid_forces(kinematics.RigidPoses(found, poses_about_home(found, way)), wrench).drive_force / radius
        errors.append(np.abs(force - expected).max() / np.abs(expected).max())
    assert errors[0] < 0.01
    assert errors[0] / errors[1] == pytest.approx(10.0, rel=0.05)


def test_a_mirrored_tripod_does_the_mirrored_thing():
    mirror, places = np.array([1.0, -1.0, 1.0]), [10.0, 130.0, 250.0]
    wrench = np.array([50.0, -30, -100, 3, -2, 4.0])
    poses = []
    for side in (1.0, -1.0):
        turned = side * np.array(places)
        joints = circle(0.2, side * (np.array(places) + 5.0))
        system, x = robot(circle(0.35, turned), joints, tangents(turned), com=(0.02, side * 0.03, 0.1))
        tool = system.payload_p.copy()
        tool[-3:] *= [1, side, 1]
        system, x = hold(replace(system, payload_p=tool), x, "beta")
        own = wrench * (1.0 if side > 0 else np.append(mirror, -mirror))
        states, *_ = solved(system, x, wrench=own)
        poses.append(states.pose[0])
    np.testing.assert_allclose(poses[1][:3], mirror * poses[0][:3], atol=1e-12)
    np.testing.assert_allclose(poses[1][3:], poses[0][3:] * [1, -1, 1, -1], atol=1e-12)
