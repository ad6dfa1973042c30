"""A cylinder without mass between a soft base joint and a drive that gives way: springs in series, a mass less."""

import numpy as np
import pytest
import scipy.linalg
from tests.helpers.machines import BODY, SCREW, SOFT, machine, study

import flexapod as fx
from flexapod.kinematics import home_pose
from flexapod.model import Loop, ServoDrive
from flexapod.model.leg.joint import Joint

pytestmark = pytest.mark.consistency

NONE = BODY.replace(mass=0.0, com=0.0, inertia=0.0, axial_inertia=0.0)
SERVO, ALONG, ACROSS = 3e7, 2e8, 1e13  # N/m: drive, base joint along the leg, and across it as good as ideal
BASE = Joint(stiffness=np.diag([ACROSS, ACROSS, ALONG, 0, 0, 0]), leg_axes=True)


def robot(**parts):
    return machine(**parts).replace(gravity=np.zeros(3))


def by_hand(given):
    """Frequencies [Hz] of the payload on six springs in series; pistons are rods that turn about the base joints."""
    leg, load = given.robot.legs[0], given.robot.payload
    k = 1 / (1 / SERVO + 1 / ALONG)
    M, K = scipy.linalg.block_diag(load.mass * np.eye(3), load.inertia), np.zeros((6, 6))
    height = home_pose(given.robot).position[0]
    for base, joint in zip(given.robot.base_joints, given.robot.platform_joints, strict=True):
        along = joint + height - base
        length = np.linalg.norm(along)
        z, arm = along / length, joint - load.com
        at = np.hstack([np.eye(3), -np.cross(np.eye(3), arm).T])  # the tip's motion by the payload's: u + w x arm
        K += k * np.outer(z @ at, z @ at)
        x = np.polynomial.legendre.leggauss(4)
        share = (
            (1 - leg.piston.length * (1 + x[0]) / 2 / length) ** 2 @ x[1] / 2
        )  # of its speed across, by a mean square
        rod = leg.piston.rhoA * leg.piston.length * (np.outer(z, z) + share * (np.eye(3) - np.outer(z, z)))
        M += at.T @ rod @ at
    return np.sqrt(scipy.linalg.eigh(K, M, eigvals_only=True)) / (2 * np.pi)


def test_its_modes_are_those_of_two_springs_in_series():
    given = study(robot(cylinder=NONE, base_joint=BASE, drive=ServoDrive(stiffness=SERVO, damping=0.0)))
    found = fx.modes(given, fidelity="rigid").frequency.values
    # What gives way across the legs is 3e6 times as stiff as what gives way along them.
    np.testing.assert_allclose(found[:6], by_hand(given), rtol=3e-6)
    assert found.size == 6 + 2 * 6  # the payload, and each piston across its leg: the rank of the mass matrix


DRIVES = {
    "servo": ServoDrive(stiffness=1e8, damping=1e3),
    "screw": SCREW,
    "loop": SCREW.replace(command="servo", loop=Loop(stiffness=5000.0, damping=20.0)),
}


@pytest.mark.parametrize("fidelity", ["rigid", "lumped"])
@pytest.mark.parametrize("ends", [("base_joint",), ("base_joint", "platform_joint")], ids=["base", "both"])
@pytest.mark.parametrize("drive", DRIVES)
def test_next_to_no_mass_has_the_same_lowest_modes_and_six_more(drive, ends, fidelity):
    joints = dict.fromkeys(ends, SOFT)
    light = BODY.replace(mass=1e-6, com=0.3, inertia=1e-9, axial_inertia=0.0)
    found, more = (
        fx.modes(study(robot(cylinder=body, drive=DRIVES[drive], **joints)), fidelity=fidelity).frequency.values
        for body in (NONE, light)
    )
    np.testing.assert_allclose(found[:6], more[:6], rtol=1e-7)  # 6e-6 kg of a ton
    assert more.size == found.size + 6


def test_the_linear_model_has_the_same_poles():
    given = study(
        robot(cylinder=NONE, base_joint=BASE, drive=ServoDrive(stiffness=SERVO, damping=0.0)), fidelity="rigid"
    )
    system = fx.linearize(given, inputs=["wrench"], outputs=["tool"])
    poles = np.sort(np.abs(system.poles()))[:12:2] / (2 * np.pi)
    np.testing.assert_allclose(poles, by_hand(given), rtol=3e-6)


@pytest.mark.parametrize("drive", DRIVES)
def test_a_motion_in_time_is_refused_with_the_key(drive):
    given = study(robot(cylinder=NONE, base_joint=SOFT, drive=DRIVES[drive]))
    with pytest.raises(fx.InputError, match=r"leg\.cylinder\.mass = 0: of leg 1 has no mass between a base joint"):
        fx.simulate(given, fidelity="lumped")
