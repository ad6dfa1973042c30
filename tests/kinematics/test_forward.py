"""Forward kinematics: Newton, paths and the complex system behind all postures."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.oracles.stewart_cases import base_circle, platform_circle

from flexapod.common.errors import ComputationError, InputError
from flexapod.kinematics.forward import all_postures, newton, newton_path
from flexapod.kinematics.homotopy import Platform, quadrics
from flexapod.kinematics.inverse import leg_lengths
from flexapod.kinematics.jacobian import length_jacobian
from flexapod.kinematics.rotations import exponential
from flexapod.kinematics.trajectory import Poses, rotation_matrix

pytestmark = pytest.mark.unit

BASE, PLATFORM, HOME = base_circle(0.25, 10), platform_circle(0.15, 10), np.array([0, 0, 0.9])
RNG = np.random.default_rng(5)


def test_newton_recovers_random_poses_from_home():
    p = HOME + RNG.uniform(-0.1, 0.1, (200, 3))
    r = rotation_matrix(RNG.uniform(-0.4, 0.4, (200, 3)))
    lengths = leg_lengths(BASE, PLATFORM, p, r)
    found = newton(BASE, PLATFORM, lengths, HOME, np.eye(3))
    again = leg_lengths(BASE, PLATFORM, found.position, found.rotation)
    assert np.max(np.abs(again - lengths)) < 1e-12
    np.testing.assert_allclose(found.position, p, atol=1e-11)  # smallest singular value about 0.04
    np.testing.assert_allclose(found.rotation, r, atol=1e-11)


def test_newton_converges_quadratically():
    """The error after a full step is of the order of its square: ratio of exponents 2 within 0.2."""
    p, r = HOME + np.array([0.02, -0.01, 0.03]), rotation_matrix([0.1, -0.05, 0.08])
    lengths = leg_lengths(BASE, PLATFORM, p, r)
    x, turn, errors = HOME, np.eye(3), []
    for _ in range(4):
        error = leg_lengths(BASE, PLATFORM, x, turn) - lengths
        errors.append(np.linalg.norm(error))
        twist = -np.linalg.solve(length_jacobian(BASE, PLATFORM, x, turn), error)
        x, turn = x + twist[:3], exponential(twist[3:]) @ turn
    slope = np.log(errors[3] / errors[2]) / np.log(errors[2] / errors[1])
    assert 1.8 < slope < 2.2


def test_path_follows_large_turns():
    angle = np.linspace(0, np.deg2rad(55), 56)
    r = rotation_matrix(np.stack([0 * angle, angle, 0.5 * angle], axis=1))
    lengths = leg_lengths(BASE, PLATFORM, np.tile(HOME, (56, 1)), r)
    found = newton_path(BASE, PLATFORM, lengths, Poses.at_rest(HOME, np.eye(3)))
    np.testing.assert_allclose(found.rotation, r, atol=1e-10)


def test_quadrics_vanish_on_real_poses():
    """q = (e, t e / 2) of any pose, by SciPy's quaternions, solves the seven equations."""
    turn, t = Rotation.random(rng=np.random.default_rng(2)), RNG.normal(size=3)
    x, y, z, w = turn.as_quat()
    e = np.array([w, x, y, z])
    g = 0.5 * np.concatenate([[-t @ e[1:]], w * t + np.cross(t, e[1:])])
    a, b = RNG.normal(size=(2, 6, 3))
    squared = np.sum((t + a @ turn.as_matrix().T - b) ** 2, axis=1)
    q = np.concatenate([e, g])
    assert np.max(np.abs(np.einsum("nij,i,j->n", quadrics(Platform(a, b, squared)), q, q))) < 1e-14


@pytest.mark.parametrize("lengths", [[1, 1, 1, 1, 1], [1, 1, 1, 1, 1, -1], [1, 1, 1, 1, 1, np.nan]])
def test_lengths_are_checked(lengths):
    with pytest.raises(InputError, match="six positive leg lengths"):
        newton(BASE, PLATFORM, lengths, HOME, np.eye(3))


def test_impossible_lengths_are_reported():
    with pytest.raises(ComputationError, match="No pose fits"):
        newton(BASE, PLATFORM, [0.5, 2.0, 0.5, 2.0, 0.5, 2.0], HOME, np.eye(3))


def test_all_postures_of_a_planar_robot_hold_the_pose_and_its_mirror_image():
    """Joints in two planes: each pose above the base has its mirror image below; both are found."""
    p, r = HOME + np.array([0.03, -0.02, 0.05]), rotation_matrix([0.15, -0.1, 0.2])
    lengths = leg_lengths(BASE, PLATFORM, p, r)
    found = all_postures(BASE, PLATFORM, lengths)
    poses = found.poses
    assert np.max(np.abs(leg_lengths(BASE, PLATFORM, poses.position, poses.rotation) - lengths)) < 1e-12
    gap = np.linalg.norm(poses.position - p, axis=1) + np.linalg.norm(poses.rotation - r, axis=(1, 2))
    assert np.min(gap) < 1e-9
    assert len(poses) % 2 == 0
    np.testing.assert_allclose(poses.position[:, 2], -poses.position[::-1, 2], atol=1e-9)


def test_all_postures_of_impossible_lengths_are_none():
    found = all_postures(BASE, PLATFORM, [0.5, 2.0, 0.5, 2.0, 0.5, 2.0])
    assert len(found.poses) == 0
    assert found.complex_count == 28  # of two similar pairs of semi-regular hexagons, crossed


def test_all_postures_of_two_coinciding_legs_do_not_fail():
    """The platform can move on the five others: its solutions are not isolated, and singular equations are survived."""
    base, platform = BASE.copy(), PLATFORM.copy()
    base[1], platform[1] = base[0], platform[0]
    lengths = leg_lengths(base, platform, HOME, np.eye(3))
    found = all_postures(base, platform, lengths)
    assert found.complex_count < 40
    assert np.all(np.isfinite(found.poses.position))
