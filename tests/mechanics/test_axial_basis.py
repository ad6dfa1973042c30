"""The axial shapes, the static one first: values, closed integrals, ends, what they converge to."""

import numpy as np
import pytest
from scipy.linalg import eigh

from flexapod.mechanics.shapes import axial_basis

pytestmark = pytest.mark.contract

COUNTS = range(1, 5)


def rule():
    x, w = np.polynomial.legendre.leggauss(60)
    return (x + 1) / 2, w / 2


@pytest.mark.parametrize("count", COUNTS)
def test_closed_integrals(count):
    b, (eta, w) = axial_basis(count), rule()
    psi = b.values(eta)
    n = np.pi * np.arange(1, count)[:, None]
    slope = np.concatenate([np.ones((1, eta.size)), n * np.cos(n * eta)])
    np.testing.assert_allclose(b.mass, (psi * w) @ psi.T, atol=1e-14)
    np.testing.assert_allclose(b.stiffness, (slope * w) @ slope.T, atol=1e-12)
    np.testing.assert_allclose(b.first, psi @ w, atol=1e-14)
    np.testing.assert_allclose(b.moment, psi @ (w * eta), atol=1e-14)


@pytest.mark.parametrize("count", COUNTS)
def test_ends(count):
    # Held at the drive, the tip moves with the first amplitude alone.
    ends = axial_basis(count).values(np.array([0.0, 1.0]))
    np.testing.assert_allclose(ends, np.stack([np.zeros(count), np.eye(count)[0]], axis=1), atol=1e-15)


@pytest.mark.parametrize("count", COUNTS)
def test_static_compliance_is_exact_with_any_count(count):
    tip = np.eye(count)[0]
    assert tip @ np.linalg.solve(axial_basis(count).stiffness, tip) == pytest.approx(1.0, abs=1e-15)


@pytest.mark.parametrize("count", COUNTS)
def test_damping_is_the_same_ratio_for_every_mode(count):
    b = axial_basis(count)
    np.testing.assert_allclose(b.damping @ np.linalg.solve(b.mass, b.damping), b.stiffness, atol=1e-12 * count**2 * 90)


def test_first_fixed_free_frequency_converges_from_above():
    # Ritz bounds; the static shape alone gives sqrt(3), two shapes 0.45 %; the slope at the free tip, which is
    # zero only in the limit, makes the error fall as count^-3.
    first = [np.sqrt(eigh(b.stiffness, b.mass, eigvals_only=True)[0]) for b in map(axial_basis, COUNTS)]
    error = np.array(first) / (np.pi / 2) - 1
    assert first[0] == pytest.approx(np.sqrt(3), rel=1e-14)
    assert error[1] == pytest.approx(4.5e-3, abs=5e-5)
    assert (np.diff(error) < 0).all()
    assert 0 < error[3] < 1e-3


def test_no_shapes_leave_the_piston_rigid():
    b = axial_basis(0)
    assert (b.count, b.mass.shape, b.values(np.zeros(3)).shape) == (0, (0, 0), (0, 3))
