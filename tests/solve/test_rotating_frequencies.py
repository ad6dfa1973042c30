"""Flap and lag of the steadily turning actuator against a spectral solution that knows nothing of its bases.

Flap is bending out of the plane of rotation; the actuator computes lag, and flap^2 = lag^2 + g^2 in dimensionless
terms. A turning beam has a boundary layer at its root, of length L / (g sqrt(delta + 1/2)): a hundredth of the beam at
delta = 5, g = 50. Basis tip-load is made of static shapes of the beam under its tension, Eq. (T1.16), and contains it.
"""

import numpy as np
import pytest
from tests.oracles import rotating

from flexapod.model import Actuator, Simulation
from flexapod.solve.modal.actuator_modes import actuator_modes

pytestmark = pytest.mark.analytic

SLOW = (1, 2, 3, 4, 5, 6, 8, 10)
# delta, mu, g: every row of the published tables
ROWS = [
    *[(0.0, 0.0, g) for g in (*SLOW, 12)],
    *[(delta, 0.0, g) for delta in (1.0, 5.0) for g in (2, 10, 50)],
    *[(0.0, 1.0, g) for g in (1, 2, 4, 8)],
    (0.5, 1.0, 5),
]


def lag(basis, modes, g, delta=0.0, mu=0.0):
    beam = Actuator(length=1.0, rhoA=1.0, EI=1.0, free_length=1.0, hub_radius=delta, tip_mass=mu)
    return 2 * np.pi * actuator_modes(beam, Simulation(basis=basis, modes=modes), rate=g).frequency


def flap(basis, modes, g, delta=0.0, mu=0.0):
    return np.sqrt(lag(basis, modes, g, delta, mu) ** 2 + g**2)


@pytest.mark.parametrize(("delta", "mu", "g"), ROWS)
def test_first_frequencies(delta, mu, g):
    # k = 3: the bound of 1e-5 is twice the worst case (delta = 5, g = 50). k = 6: exact to the reference's own 1e-8
    exact, slow = rotating.flap(g, delta, mu, n=1)[0], rotating.lag(g, delta, mu, n=1)[0]
    for modes, bound in ((3, 1e-5), (6, 2e-8), (12, 2e-8)):
        assert -2e-8 < flap("tip-load", modes, g, delta, mu)[0] / exact - 1 < bound
        # the same error of W^2 weighs more on the smaller one
        assert -2e-8 < lag("tip-load", modes, g, delta, mu)[0] / slow - 1 < bound * (exact / slow) ** 2


@pytest.mark.parametrize("g", [10, 50])
def test_shapes_without_the_layer_miss_it(g):
    # The polynomials of a leg's basis (no speed in them) on the same beam: what the load-dependent shapes are for.
    from scipy.linalg import eigh

    from flexapod.mechanics.shapes import lateral_basis

    b = lateral_basis("tip-load", 3)
    stiffness = b.stiffness + g**2 * (5.0 * b.slope_first + b.slope_moment)
    missed = np.sqrt(eigh(stiffness, b.mass[:3, :3], eigvals_only=True)[0]) / rotating.flap(g, 5.0, 0.0, n=1)[0] - 1
    assert missed > 5e-3
    assert abs(flap("tip-load", 3, g, 5.0)[0] / rotating.flap(g, 5.0, 0.0, n=1)[0] - 1) < 1e-3 * missed


def test_a_printed_value_that_is_not_converged():
    # delta = 5, g = 50 is printed as 144.3906: the Ritz value of 16 polynomials. The limit is 144.381720.
    def ritz(shapes):
        mass, bending, geometric = rotating.matrices(5.0, 0.0, shapes)
        return rotating.lowest(bending + 2500 * geometric, mass, 1)[0]

    values = [ritz(n) for n in (16, 24, 30, 40)]
    assert values[0] == pytest.approx(144.3906, abs=5e-5)
    np.testing.assert_allclose(values[1:], [144.381755, 144.381721, 144.381720], rtol=0, atol=1e-6)
    assert flap("tip-load", 6, 50, 5.0)[0] == pytest.approx(values[-1], rel=2e-8)


@pytest.mark.parametrize(("modes", "bound"), [(3, 2.6e-3), (6, 2.1e-4)])
def test_eigenfunctions_of_the_beam_at_rest(modes, bound):
    # They lack the third derivative at the tip that tension brings; twice to a hundred times the error of tip-load.
    errors = [flap("clamped-free", modes, g)[0] / rotating.flap(g, n=1)[0] - 1 for g in (*SLOW, 12)]
    assert 0 < min(errors)
    assert 0.9 * bound < max(errors) < bound
    assert (np.diff(errors) > 0).all()


@pytest.mark.parametrize(("delta", "mu"), [(0.0, 0.0), (1.0, 0.0), (5.0, 0.0), (0.0, 1.0), (0.5, 1.0)])
def test_twelve_shapes_agree_in_the_first_three_modes(delta, mu):
    for g in (2, 5):
        np.testing.assert_allclose(flap("tip-load", 12, g, delta, mu)[:3], rotating.flap(g, delta, mu), rtol=1e-8)
        np.testing.assert_allclose(lag("tip-load", 12, g, delta, mu)[:3], rotating.lag(g, delta, mu), rtol=1e-8)


def test_stiffening_is_the_difference_between_flap_and_rest():
    # Slow rotation: flap^2 = W^2 + g^2 (phi, S phi) with the tension of unit rotation, S_c[0, 0] of the first mode.
    from tests.oracles.sliding import constants

    rest, g = lag("clamped-free", 6, 0.0)[0], 1e-3
    rise = (flap("clamped-free", 6, g)[0] ** 2 - rest**2) / g**2
    assert rise == pytest.approx(constants(1).G1[0, 0], rel=1e-6)  # 1.1933364, Southwell's coefficient


@pytest.mark.parametrize(("inertia", "delta"), [(0.01, 0.0), (0.1, 0.5), (1.0, 0.0)])
def test_turning_about_its_own_axis_loads_a_tip_body_with_no_centrifugal_moment(inertia, delta):
    # lag^2 = flap^2 - g^2 holds without J only: J adds to the mass, neither to the tension nor to the field across.
    from scipy.linalg import eigh
    from tests.oracles.ritz import polynomial_shapes

    g, mu = 2.0, 1.0
    mass, bending, geometric = rotating.matrices(delta, mu)
    slope = polynomial_shapes(30)(np.array([1.0]), 1)[:, 0]
    square = eigh(mass + inertia * np.outer(slope, slope), bending + g**2 * (geometric - mass), eigvals_only=True)
    exact = 1 / np.sqrt(square[::-1][:2])
    beam = Actuator(length=1.0, rhoA=1.0, EI=1.0, free_length=1.0, hub_radius=delta, tip_mass=mu, tip_inertia=inertia)
    # eigenfunctions at rest converge at order 5; shapes under the load of force and moment exponentially
    for basis, modes, bound in (
        ("tip-mass", 3, 1e-3),
        ("tip-mass", 6, 2.5e-5),
        ("tip-mass", 12, 6e-7),
        ("tip-load", 3, 1e-6),
        ("tip-load", 6, 1e-9),
    ):
        found = actuator_modes(beam, Simulation(basis=basis, modes=modes), rate=g)
        assert -1e-9 < 2 * np.pi * found.frequency[0] / exact[0] - 1 < bound
