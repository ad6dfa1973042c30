"""Cubic hexapod: six legs along edges of a cube, Preumont et al. 2007: K = k diag(2, 2, 2, L^2/2, L^2/2, 2 L^2)."""

import numpy as np
import pytest

from flexapod.kinematics.jacobian import length_jacobian, stiffness
from flexapod.verification.cases.hexapods import EDGES_MM, centre_stiffness, joints, offset_stiffness

pytestmark = pytest.mark.literature


@pytest.mark.parametrize("edge", np.sqrt(3) * 1e-3 * np.array(EDGES_MM))
def test_stiffness_at_the_centre_is_diagonal(edge):
    k = 1.7e6
    found = stiffness(length_jacobian(*joints(edge), np.zeros(3), np.eye(3)), k)
    np.testing.assert_allclose(found, k * centre_stiffness(edge), atol=1e-14 * k)


def test_stiffness_above_the_centre():
    """70 mm above the centre of the cube of edge sqrt(3) 100 mm: coupling +-0.14 k, rotation 0.0248 k."""
    found = stiffness(length_jacobian(*joints(np.sqrt(3) * 0.1), np.zeros(3), np.eye(3), [0, 0, 0.07]), 1.0)
    np.testing.assert_allclose(found, offset_stiffness(), atol=1e-14)


def test_neighbouring_legs_are_orthogonal():
    lower, upper = joints(1.0)
    axes = upper - lower
    dots = np.abs(axes @ axes.T)
    assert np.all(np.isclose(dots, 0, atol=1e-14) | np.isclose(dots, 1))
