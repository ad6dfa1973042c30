"""Length Jacobian and the measures of singularity."""

import numpy as np
import pytest
from tests.oracles.stewart_cases import base_circle, platform_circle

from flexapod.kinematics.inverse import leg_frames, leg_state
from flexapod.kinematics.jacobian import (
    characteristic_length,
    dimensionless_jacobian,
    length_jacobian,
    scaled_path,
    singularity_measures,
    stiffness,
)
from flexapod.kinematics.trajectory import Poses, rotation_matrix

pytestmark = pytest.mark.unit

BASE, PLATFORM, HOME = base_circle(0.25, 10), platform_circle(0.15, 10), 0.9
RNG = np.random.default_rng(11)


def random_poses(n):
    p = RNG.uniform([-0.1, -0.1, 0.8], [0.1, 0.1, 1.0], (n, 3))
    v, w = RNG.normal(size=(2, n, 3))
    r = rotation_matrix(RNG.uniform(-0.4, 0.4, (n, 3)))
    return Poses(position=p, rotation=r, velocity=v, omega=w, acceleration=np.zeros((n, 3)), alpha=np.zeros((n, 3)))


def test_jacobian_times_twist_is_the_leg_rate_about_any_point():
    poses = random_poses(20)
    rate = leg_state(BASE, PLATFORM, leg_frames(BASE, PLATFORM + np.array([0, 0, HOME])), poses).rate
    for point in ([0, 0, 0], [0.1, 0.4, -0.2]):
        twist = np.concatenate([poses.point(point)[1], poses.omega], axis=1)
        jacobian = length_jacobian(BASE, PLATFORM, poses.position, poses.rotation, point)
        np.testing.assert_allclose(np.einsum("tij,tj->ti", jacobian, twist), rate, atol=1e-14)


def test_measures_depend_neither_on_the_unit_of_length_nor_on_the_platform_frame():
    poses = random_poses(10)
    first = singularity_measures(scaled_path(BASE, PLATFORM, poses))
    again = singularity_measures(
        scaled_path(1e3 * BASE, 1e3 * PLATFORM, Poses.at_rest(1e3 * poses.position, poses.rotation))
    )
    shift = np.array([0.3, -0.2, 0.5])
    there = Poses.at_rest(poses.position - poses.rotation @ shift, poses.rotation)
    moved = singularity_measures(scaled_path(BASE, PLATFORM + shift, there))
    for other in (again, moved):
        np.testing.assert_allclose(other.smallest_singular_value, first.smallest_singular_value, rtol=1e-11)
        np.testing.assert_allclose(other.determinant, first.determinant, rtol=1e-11)
    np.testing.assert_allclose(
        first.condition * first.smallest_singular_value,
        np.linalg.norm(
            dimensionless_jacobian(length_jacobian(BASE, PLATFORM, poses.position, poses.rotation), 0.15),
            ord=2,
            axis=(1, 2),
        ),
        rtol=1e-12,
    )


def test_characteristic_length_of_a_circle_is_its_radius():
    assert np.isclose(characteristic_length(PLATFORM), 0.15)


def test_path_through_yaw_of_90_degrees_changes_the_sign():
    yaw = np.deg2rad(np.linspace(60, 120, 60))  # misses 90 deg itself
    poses = Poses.at_rest(np.tile([0, 0, HOME], (60, 1)), rotation_matrix(np.stack([0 * yaw, 0 * yaw, yaw], axis=1)))
    path = singularity_measures(scaled_path(BASE, PLATFORM, poses))
    np.testing.assert_array_equal(path.sign_changes, [29])
    assert path.worst in (29, 30)


def test_stiffness_is_energy_of_the_leg_springs():
    jacobian = length_jacobian(BASE, PLATFORM, [0, 0, HOME], np.eye(3))
    k, x = RNG.uniform(1, 2, 6), RNG.normal(size=6)
    assert np.isclose(x @ stiffness(jacobian, k) @ x, np.sum(k * (jacobian @ x) ** 2))
