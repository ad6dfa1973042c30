"""A lateral basis from a solid piston."""

import numpy as np
import pytest
from scipy.linalg import eigh, expm
from scipy.optimize import brentq

from flexapod.common.errors import InputError
from flexapod.mechanics.shapes import lateral_basis
from flexapod.model import Rectangle, Tube
from flexapod.solve.fem.reduction import solid_leg_shapes

pytestmark = pytest.mark.unit

PISTON = Tube(diameter=0.027)


@pytest.mark.parametrize("count", [1, 4, 12])
def test_shapes_keep_the_contract_of_a_basis(count):
    b = solid_leg_shapes(PISTON, 0.6, count, 0.009)
    assert b.count == count
    np.testing.assert_allclose(b.values(np.zeros(1)), 0, atol=1e-14)
    np.testing.assert_allclose(b.values(np.zeros(1), 1), 0, atol=1e-13)
    np.testing.assert_allclose(b.tip, np.eye(count)[0], atol=1e-12)
    bend = np.sqrt(np.diag(b.stiffness))
    np.testing.assert_allclose(b.stiffness / np.outer(bend, bend), np.eye(count), atol=1e-7)  # a held tip does no work
    x, w = np.polynomial.legendre.leggauss(6)
    z = ((np.arange(24)[:, None] + (x + 1) / 2) / 24).ravel()
    phi = b.values(z)
    np.testing.assert_allclose(b.mass[:count, :count], (phi * np.tile(w / 48, 24)) @ phi.T, atol=1e-12)
    assert (b.values(np.array([1e-2]))[:, 0] > 0).all()


def test_slender_pistons_are_beams():
    # Slenderness 1:500 (nu = 0): shear 1e-5; the reduction leaves (lam / 24)^4 / 720 of the second root, 7.07.
    solid, beam = (
        solid_leg_shapes(Rectangle(width=0.002, height=0.002), 1.0, 3, 0.005, poisson=0.0),
        lateral_basis("tip-load", 12),
    )
    assert solid.stiffness[0, 0] == pytest.approx(3.0, rel=1e-4)
    np.testing.assert_allclose(solid.values(np.linspace(0, 1, 9))[0], beam.values(np.linspace(0, 1, 9))[0], atol=1e-5)
    held = [eigh(b.stiffness[1:, 1:], b.mass[1 : b.count, 1 : b.count], eigvals_only=True)[:2] for b in (solid, beam)]
    np.testing.assert_allclose(held[0], held[1], rtol=1e-4)


@pytest.mark.parametrize("count", [2, 4])
def test_the_tip_gives_way_to_a_moment_as_a_beam(count):
    # Force and moment at the tip of a slender piston: 1/3, 1/2, 1/2, 1 as of a cantilever; with modes alone 10 % miss.
    thin = Rectangle(width=0.002, height=0.002)
    b = solid_leg_shapes(thin, 1.0, count, 0.005, moment=True)
    loads = np.stack([b.tip, b.tip_slope])
    np.testing.assert_allclose(loads @ np.linalg.solve(b.stiffness, loads.T), [[1 / 3, 1 / 2], [1 / 2, 1]], rtol=2e-4)
    bare = solid_leg_shapes(thin, 1.0, count, 0.005)
    assert bare.tip_slope @ np.linalg.solve(bare.stiffness, bare.tip_slope) < 0.99
    np.testing.assert_allclose(b.mass[1:count, 1:count], np.eye(count - 1), atol=1e-3)


def test_thick_pistons_give_by_shear():
    # Tip force: 3 EI / (kappa G A s^2) = 3 * 2 (1 + nu) / kappa * (d / 4 s)^2 more compliance, kappa = 6/7 at nu = 0.
    # The guide holds averages and adds the turn of its mouth, of the size of shear over a radius: as much again.
    b = solid_leg_shapes(PISTON, 0.3, 1, 0.0045, poisson=0.0)
    shear = 3 * 2 * 7 / 6 * (0.027 / 4 / 0.3) ** 2
    assert shear < 3 / b.stiffness[0, 0] - 1 < 2 * shear


def test_modes_with_the_tip_held_are_timoshenkos():
    """Clamped-pinned, nu = 0, shear but no rotary inertia, which the basis leaves out as the theory does."""
    r = 0.027 / 4 / 0.6

    def held(W):
        A = np.array([[0, 1, 0, 2 * 7 / 6 * r**2], [0, 0, 1, 0], [0, 0, 0, -1], [-(W**2), 0, 0, 0]])
        return np.linalg.det(expm(A)[np.ix_([0, 2], [2, 3])])

    exact = [brentq(held, 0.97 * W, 1.003 * W) for W in (15.4182, 49.9, 103.0)]
    b = solid_leg_shapes(PISTON, 0.6, 6, 0.0045, poisson=0.0)
    ours = np.sqrt(eigh(b.stiffness[1:, 1:], b.mass[1:6, 1:6], eigvals_only=True))[:3]
    # Arcs of the mesh: 2e-5; the reduction: (lam / 24)^4 / 1440 with lam = 10.2, 2e-5, and slope for rotation: shear
    # over the 24th of the length, 1e-5.
    np.testing.assert_allclose(ours, exact, rtol=2e-4)


@pytest.mark.parametrize("changes", [{"count": 0}, {"count": 13}, {"length": 0.0}, {"size": -1.0}, {"size": 0.5}])
def test_what_does_not_fit_is_refused(changes):
    with pytest.raises(InputError):
        solid_leg_shapes(**({"section": PISTON, "length": 0.6, "count": 3} | changes))
