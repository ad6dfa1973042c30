"""Stiffness of weightless hexapods whose joints carry moments, against compliances in series and stiffnesses in sum."""

import numpy as np
import pytest
from tests.helpers.mechanisms import CYLINDER, PISTON, hexapod

from flexapod.kinematics.leg_geometry import limbs
from flexapod.model import Simulation
from flexapod.model.leg.joint import Joint
from flexapod.model.study.payload import Payload
from flexapod.solve.modal.at_poses import robot_stiffness

pytestmark = pytest.mark.analytic

NOTHING = Payload(mass=1.0, inertia=[1.0, 1.0, 1.0], com=[0.0, 0.05, 0.1], tool=[0.1, 0.0, 0.2])


def hat(r):
    return np.cross(np.eye(3), r)


def series(foot, tip, axes, end):
    """Compliance (6, 6) of a leg at its tip, in world axes: cantilever, bar and shaft, then a flexure at either end."""
    p, s = PISTON, np.linalg.norm(tip - foot) - CYLINDER.mouth
    shear, both, turn = s**3 / (3 * p.EI), s**2 / (2 * p.EI), s / p.EI
    C = np.diag([shear, shear, p.length / p.EA, turn, turn, p.length / p.torsional_stiffness])
    C[0, 4] = C[4, 0] = both
    C[1, 3] = C[3, 1] = -both
    lever = np.eye(6)
    lever[:3, 3:] = hat(tip - foot).T  # what a turn of the base does at the tip
    six = np.kron(np.eye(2), axes)
    C = six @ C @ six.T
    return C + six @ end @ six.T + lever @ six @ end @ six.T @ lever.T


def expected(robot, end):
    total, tool = np.zeros((6, 6)), robot.home_position + robot.payload.tool
    for foot, tip, axes in zip(robot.home_bases, robot.home_tips, limbs(robot).frames, strict=True):
        at_tip = np.eye(6)
        at_tip[:3, 3:] = hat(tip - tool).T
        total += at_tip.T @ np.linalg.solve(series(foot, tip, axes, end), at_tip)
    return total


def with_joints(joint):
    robot = hexapod("FPF")
    legs = tuple(leg.replace(base_joint=joint, platform_joint=joint) for leg in robot.legs)
    return robot.replace(legs=legs, gravity=np.zeros(3), payload=NOTHING)


SIX = np.diag([1.3e7, 1.3e7, 9.4e7, 150.0, 150.0, 200.0])
SIX[0, 4] = SIX[4, 0] = 9e3
CASES = {
    "welded": (Joint(), np.zeros((6, 6))),
    "bending and torsion": (Joint(bending=150.0, torsion=200.0), np.diag([0, 0, 0, 1 / 150, 1 / 150, 1 / 200])),
    "six by six": (Joint(stiffness=SIX, leg_axes=True), np.linalg.inv(SIX)),
}


@pytest.mark.parametrize("case", CASES)
def test_stiffness_is_the_sum_of_compliances_in_series(case):
    # Two shapes in a plane contain the static answers, so that rounding and the springs' condition are what is left.
    joint, end = CASES[case]
    robot = with_joints(joint)
    found = robot_stiffness(robot, Simulation(fidelity="assumed-modes", modes=2)).total
    reference = expected(robot, end)
    np.testing.assert_allclose(found, reference, atol=1e-9 * np.abs(reference).max())
