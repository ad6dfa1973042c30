"""Dietmaier 1998: a Stewart platform with 40 real postures, as many as it has complex ones."""

import numpy as np
import pytest

from flexapod.kinematics.forward import all_postures
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


def test_rotations_of_the_postures_are_rotations(found):
    r = found.poses.rotation
    np.testing.assert_allclose(r @ np.swapaxes(r, 1, 2), np.broadcast_to(np.eye(3), r.shape), atol=1e-13)
    np.testing.assert_allclose(np.linalg.det(r), 1, atol=1e-13)
