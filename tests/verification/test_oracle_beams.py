"""The oracle of beam frequencies reproduces textbook values before anything is tested against it."""

import numpy as np
import pytest
from tests.oracles import beams

from flexapod.verification.cases import bending, turning

pytestmark = pytest.mark.literature

# printed digits: half a unit of the last one, rounded up
ROOTS = {
    ("clamped", "free"): bending.ROOTS,
    ("clamped", "clamped"): [4.730040744863, 7.853204624096, 10.995607838, 14.13716549126, 17.2787596574],
    ("free", "free"): [4.730040744863, 7.853204624096, 10.995607838, 14.13716549126, 17.2787596574],
    ("clamped", "pinned"): [3.926602312048, 7.068582745629, 10.21017612281, 13.35176877775, 16.49336143135],
    ("free", "pinned"): [3.926602312048, 7.068582745629, 10.21017612281, 13.35176877775, 16.49336143135],
    ("pinned", "pinned"): np.pi * np.arange(1, 6),
    ("clamped", "guided"): [2.365020372431, 5.497803919001, 8.6393798287],
}
PISTON = beams.round_section(0.027, 200e9, 7800.0)


@pytest.mark.parametrize(("ends", "expected"), ROOTS.items())
def test_roots_of_the_classical_ends(ends, expected):
    np.testing.assert_allclose(beams.beam_roots(*ends, len(expected)), expected, rtol=0, atol=6e-11)


@pytest.mark.parametrize(("mu", "inertia", "expected"), bending.BODIES)
def test_tip_body(mu, inertia, expected):
    np.testing.assert_allclose(beams.tip_body_roots(mu, 3, inertia) ** 2, expected, rtol=0, atol=6e-8)


def test_tip_mass_satisfies_the_printed_equation():
    for mu in (0.3, 3.0):
        lam = beams.tip_body_roots(mu, 3)
        bracket = np.cos(lam) * np.sinh(lam) - np.sin(lam) * np.cosh(lam)
        # cosh(8) = 1,500 magnifies the rounding of lam
        np.testing.assert_allclose(1 + np.cos(lam) * np.cosh(lam) + mu * lam * bracket, 0, atol=1e-10)


def test_offset_body_is_a_rigid_body_about_the_tip():
    # a pure mass at distance c adds mass, mu c of first moment and mu c^2 of inertia: never a higher frequency
    straight, offset = beams.tip_body_roots(1, 3), beams.tip_body_roots(1, 3, 0.0, 0.1)
    assert (offset < straight).all()
    # slow limit (Rayleigh): heavy body far out on a massless beam, omega^2 = 3 EI / (M L^3 (1 + 3 c + 3 c^2))
    mu, c = 1e5, 0.3
    lam = beams.tip_body_roots(mu, 1, 0.0, c)[0]
    assert lam**4 == pytest.approx(3 / (mu * (1 + 3 * c + 3 * c**2)), rel=1e-4)  # beam's own mass: order 1/mu


@pytest.mark.parametrize(("c", "mass", "free", "expected"), turning.LEGS)
def test_leg_with_locked_actuator(c, mass, free, expected):
    ours = beams.ups_leg_frequencies(c, mass, free, PISTON["EI"], PISTON["rhoA"], len(expected))
    np.testing.assert_allclose(ours, expected, rtol=0, atol=6e-7)


def test_leg_with_heavy_cylinder_is_clamped_and_pinned():
    leg = beams.ups_leg_frequencies(0.4, 1.0, 0.6, PISTON["EI"], PISTON["rhoA"], 3, cylinder_inertia_about_pivot=1e4)
    fixed = beams.frequency(beams.beam_roots("clamped", "pinned", 2), 0.6, PISTON["EI"], PISTON["rhoA"])
    # below them the cylinder swings slowly on the piston; the difference falls with the piston's share of inertia, 1e-5
    np.testing.assert_allclose(leg[1:], fixed, rtol=2e-5)
    assert leg[0] < 1


def test_piston_of_the_paper():
    assert PISTON["EI"] == pytest.approx(5217.4, abs=0.05)
    assert PISTON["EA"] == pytest.approx(1.1451e8, abs=5e3)
    assert PISTON["rhoA"] == pytest.approx(4.466, abs=5e-4)
    f = {
        ends: beams.frequency(beams.beam_roots(*ends, 2), 0.6, PISTON["EI"], PISTON["rhoA"])
        for ends in [("clamped", "free"), ("pinned", "pinned"), ("clamped", "pinned")]
    }
    assert f["clamped", "free"][0] == pytest.approx(53.1, abs=0.05)
    np.testing.assert_allclose(f["pinned", "pinned"], bending.PINNED, atol=6e-4)
    np.testing.assert_allclose(f["clamped", "pinned"], bending.CLAMPED, atol=6e-4)
    loaded = beams.pinned_pinned_under_load(1, bending.THRUST, 0.6, PISTON["EI"], PISTON["rhoA"])
    assert loaded / f["pinned", "pinned"][0] == pytest.approx(bending.FACTOR, abs=6e-7)
