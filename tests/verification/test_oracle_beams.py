"""The oracle of beam frequencies reproduces textbook values before anything is tested against it."""

import numpy as np
import pytest
from tests.oracles import beams

pytestmark = pytest.mark.literature

# printed digits: half a unit of the last one, rounded up
ROOTS = {
    ("clamped", "free"): [1.875104068712, 4.694091132974, 7.854757438238, 10.99554073488, 14.13716839105],
    ("clamped", "clamped"): [4.730040744863, 7.853204624096, 10.995607838, 14.13716549126, 17.2787596574],
    ("free", "free"): [4.730040744863, 7.853204624096, 10.995607838, 14.13716549126, 17.2787596574],
    ("clamped", "pinned"): [3.926602312048, 7.068582745629, 10.21017612281, 13.35176877775, 16.49336143135],
    ("free", "pinned"): [3.926602312048, 7.068582745629, 10.21017612281, 13.35176877775, 16.49336143135],
    ("pinned", "pinned"): np.pi * np.arange(1, 6),
    ("clamped", "guided"): [2.365020372431, 5.497803919001, 8.6393798287],
}
TIP_MASS = {
    0.1: [2.9678383, 19.355801, 55.5182455],
    0.5: [2.016299, 16.9014177, 51.7009209],
    1: [1.5572979, 16.2500852, 50.8958428],
    2: [1.1581971, 15.86089, 50.4476397],
    5: [0.7569373, 15.6023459, 50.1623389],
    10: [0.541375, 15.5115131, 50.064347],
}
TIP_INERTIA = {
    0.01: [1.5436768, 13.2395886, 32.0695808],
    0.1: [1.4296263, 6.2753257, 24.7516045],
    1: [0.8678998, 3.3905722, 24.0185577],
    10: [0.3115388, 2.9978154, 23.9471132],
}
LEGS = [
    (0.3, 3, 0.6, [67.976401, 321.006353, 844.644953]),
    (0.4, 5, 0.6, [54.579565, 291.10741, 810.989844]),
    (0.5, 8, 0.6, [43.768985, 271.284004, 790.6379]),
    (0.4, 5, 0.34, [113.893634, 823.028156]),
    (0.4, 5, 0.47, [75.104984, 452.327661]),
]
PISTON = beams.round_section(0.027, 200e9, 7800.0)


@pytest.mark.parametrize(("ends", "expected"), ROOTS.items())
def test_roots_of_the_classical_ends(ends, expected):
    np.testing.assert_allclose(beams.beam_roots(*ends, len(expected)), expected, rtol=0, atol=6e-11)


@pytest.mark.parametrize("mu", TIP_MASS)
def test_tip_mass(mu):
    np.testing.assert_allclose(beams.tip_body_roots(mu, 3) ** 2, TIP_MASS[mu], rtol=0, atol=6e-8)


@pytest.mark.parametrize("inertia", TIP_INERTIA)
def test_tip_mass_with_rotary_inertia(inertia):
    np.testing.assert_allclose(beams.tip_body_roots(1, 3, inertia) ** 2, TIP_INERTIA[inertia], rtol=0, atol=6e-8)


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


@pytest.mark.parametrize(("c", "mass", "free", "expected"), LEGS)
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
    np.testing.assert_allclose(f["pinned", "pinned"], [149.138, 596.553], atol=6e-4)
    np.testing.assert_allclose(f["clamped", "pinned"], [232.982, 755.012], atol=6e-4)
    loaded = beams.pinned_pinned_under_load(1, 1000.0, 0.6, PISTON["EI"], PISTON["rhoA"])
    assert loaded / f["pinned", "pinned"][0] == pytest.approx(0.996498, abs=6e-7)
