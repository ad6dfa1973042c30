"""Cubic hexapod: six legs along edges of a cube, Preumont et al. 2007: K = k diag(2, 2, 2, L^2/2, L^2/2, 2 L^2)."""

import numpy as np
import pytest

from flexapod.rigid.jacobian import length_jacobian, stiffness


def cubic(edge):
    """Base and platform joints (6, 3) of the legs on the six edges between the lower and the upper three corners.

    The cube stands on a corner, its centre is the origin, a space diagonal is the z axis.
    """
    corners = np.array([[1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) * edge / 2  # neighbours of the lowest corner
    z = np.ones(3) / np.sqrt(3)
    x = np.array([1, -1, 0]) / np.sqrt(2)
    axes = np.stack([x, np.cross(z, x), z])
    pairs = [(i, j) for i in range(3) for j in range(3) if i != j]
    lower = np.array([corners[i] for i, _ in pairs])
    upper = np.array([corners[i] + edge * np.eye(3)[j] for i, j in pairs])
    return lower @ axes.T, upper @ axes.T


@pytest.mark.parametrize("edge", np.sqrt(3) * np.array([0.04, 0.1, 0.15, 0.25]))
def test_stiffness_at_the_centre_is_diagonal(edge):
    lower, upper = cubic(edge)
    k = 1.7e6
    found = stiffness(length_jacobian(lower, upper, np.zeros(3), np.eye(3)), k)
    expected = k * np.diag([2, 2, 2, edge**2 / 2, edge**2 / 2, 2 * edge**2])
    np.testing.assert_allclose(found, expected, atol=1e-14 * k)


def test_stiffness_above_the_centre():
    """70 mm above the centre of the cube of edge sqrt(3) 100 mm: coupling +-0.14 k, rotation 0.0248 k."""
    lower, upper = cubic(np.sqrt(3) * 0.1)
    found = stiffness(length_jacobian(lower, upper, np.zeros(3), np.eye(3), [0, 0, 0.07]), 1.0)
    expected = np.diag([2, 2, 2, 0.0248, 0.0248, 0.06])
    expected[0, 4] = expected[4, 0] = -0.14
    expected[1, 3] = expected[3, 1] = 0.14
    np.testing.assert_allclose(found, expected, atol=1e-14)


def test_neighbouring_legs_are_orthogonal():
    lower, upper = cubic(1.0)
    axes = upper - lower
    dots = np.abs(axes @ axes.T)
    assert np.all(np.isclose(dots, 0, atol=1e-14) | np.isclose(dots, 1))
