"""Compensated commands of a robot that is six springs and a weight, against its energy minimised by SciPy."""

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation
from tests.helpers.six_springs import lengths, springs

import flexapod as fx
from flexapod.commissioning.feedforward.compensation import compensation
from flexapod.kinematics import coordinates

pytestmark = pytest.mark.analytic

# The equations are solved by both sides to rounding: forces of 1e3 N to 1e-12, over 1e8 N/m and a condition below 1e3.
PLACE = 1e-12
# Series leave out 1e-7 of the largest correction, two corrections 1e-8 of it: of some 20 um.
LEFT = 1e-11


def rigid(robot: fx.model.Robot, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Place and attitude of coordinates (6,) about the platform's origin, R = Rz Ry Rx."""
    return robot.home_position + x[:3], Rotation.from_euler("xyz", x[3:]).as_matrix()


def balance(robot: fx.model.Robot, unloaded: np.ndarray, p: np.ndarray, R: np.ndarray) -> np.ndarray:
    """Force and moment about the platform's origin of six springs and a weight."""
    piston = robot.legs[0].piston
    legs = lengths(robot, p, R)
    long = np.linalg.norm(legs, axis=1)
    push = (piston.EA / piston.length * (unloaded - long) / long)[:, None] * legs
    weight = robot.payload.mass * robot.gravity
    arms = robot.platform_joints @ R.T
    return np.concatenate(
        [push.sum(axis=0) + weight, np.cross(arms, push).sum(axis=0) + np.cross(R @ robot.com, weight)]
    )


def loaded(robot: fx.model.Robot, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where six springs of the lengths of the rigid robot at coordinates x carry the weight."""
    p0, R0 = rigid(robot, x)
    unloaded = np.linalg.norm(lengths(robot, p0, R0), axis=1)

    def turned(y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return p0 + 1e-5 * y[:3], Rotation.from_rotvec(1e-5 * y[3:]).as_matrix() @ R0

    found = least_squares(
        lambda y: balance(robot, unloaded, *turned(y)), np.zeros(6), xtol=1e-15, ftol=1e-15, gtol=1e-15
    )
    return turned(found.x)


def test_the_weight_on_six_springs_is_carried_along_the_path() -> None:
    study = springs()
    found = compensation(study)
    robot = study.robot
    for t in (0.0, 0.13, 0.5, 0.77, 1.0):
        wanted = rigid(robot, coordinates(study.motion, t).position[0])
        own = loaded(robot, coordinates(study.motion, t).position[0])
        assert np.linalg.norm(own[0] - wanted[0]) > 1e-6
        there = loaded(robot, coordinates(found.study.motion, t).position[0])
        np.testing.assert_allclose(there[0], wanted[0], rtol=0, atol=PLACE + LEFT)
        np.testing.assert_allclose(there[1], wanted[1], rtol=0, atol=PLACE + 10 * LEFT)


def test_the_miss_before_is_that_of_the_springs() -> None:
    study = springs()
    robot, found = study.robot, compensation(study)
    misses, turns = [], []
    for t in np.linspace(0.0, 1.0, 41):
        x = coordinates(study.motion, t).position[0]
        (p, R), (q, S) = rigid(robot, x), loaded(robot, x)
        misses.append(np.linalg.norm(q - p + (S - R) @ robot.tool))
        turns.append(np.linalg.norm(Rotation.from_matrix(S).as_euler("xyz") - x[3:]))
    assert abs(found.tool[0] - max(misses)) < PLACE + LEFT
    _, turn = found.commanded
    assert abs(turn[0] - max(turns)) < PLACE + LEFT < 1e-3 * max(turns)
