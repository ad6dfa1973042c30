"""Dietmaier 1998: a Stewart platform with 40 real postures, as many as it has complex ones."""

import numpy as np
import pytest

from flexapod.kinematics.forward import all_postures
from flexapod.kinematics.inverse import leg_lengths
from flexapod.kinematics.jacobian import length_jacobian
from flexapod.verification.cases.hexapods import BASE, LENGTHS, PLATFORM

pytestmark = pytest.mark.literature


@pytest.fixture(scope="module")
def found():
    return all_postures(BASE, PLATFORM, LENGTHS)


def test_exactly_40_distinct_real_postures(found):
    """The closest pair is 0.3 apart in position and rotation matrix; 1e-6 tells it from a pose found twice."""
    poses = found.poses
    assert (len(poses), found.complex_count) == (40, 40)
    x = np.concatenate([poses.position, poses.rotation.reshape(-1, 9)], axis=1)
    gap = np.linalg.norm(x[:, None] - x, axis=-1) + np.eye(40)
    assert np.min(gap) > 1e-6


def test_postures_fit_the_leg_lengths(found):
    lengths = leg_lengths(BASE, PLATFORM, found.poses.position, found.poses.rotation)
    assert np.max(np.abs(lengths - LENGTHS)) < 1e-11
    r = found.poses.rotation
    np.testing.assert_allclose(r @ np.swapaxes(r, 1, 2), np.broadcast_to(np.eye(3), r.shape), atol=1e-13)
    np.testing.assert_allclose(np.linalg.det(r), 1, atol=1e-13)


def test_half_of_the_postures_have_a_positive_determinant(found):
    determinant = np.linalg.det(length_jacobian(BASE, PLATFORM, found.poses.position, found.poses.rotation))
    assert np.sum(determinant > 0) == np.sum(determinant < 0) == 20
    assert np.min(np.abs(determinant)) == pytest.approx(1.5e-5, rel=0.05)  # printed with two digits


def test_known_posture_is_among_them(found):
    """Position given with six digits."""
    gap = np.linalg.norm(found.poses.position - [0.955868, -0.046996, -0.290013], axis=1)
    assert np.min(gap) < 2e-6
