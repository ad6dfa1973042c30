"""What thick legs lose by having no shear: closed forms against the transfer matrix of Timoshenko's beam."""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from flexapod.analysis.checks.estimates import BendingSection, beam_section, bending_errors, piston_section
from flexapod.model import MATERIALS, Actuator, Piston, Rectangle, Tube

pytestmark = pytest.mark.analytic

KAPPAS = [0.4, 0.886, 1.0]
SLENDER = [0.004, 0.025, 0.1]  # radius of gyration over length; the last of a bar 2.5 times as long as wide


def transfer(r, e, W):
    """(w, psi, M, Q) from end to end with EI = rhoA = L = 1: w' = psi + e r^2 Q, psi' = M, M' = -Q - r^2 W^2 psi,
    Q' = -W^2 w.
    """
    return expm(np.array([[0, 1, 0, e * r**2], [0, 0, 1, 0], [0, -((r * W) ** 2), 0, -1], [-(W**2), 0, 0, 0]]))


@pytest.mark.parametrize("kappa", KAPPAS)
@pytest.mark.parametrize("r", SLENDER)
def test_against_the_transfer_matrix(kappa, r):
    """Rounding of expm and brentq, 1e-10, over the smallest error, 1e-4."""
    e = 2.6 / kappa
    deflection, frequency, inertia = bending_errors(BendingSection(gyration=r, kappa=kappa), 1.0)
    T = transfer(r, e, 0.0)  # clamped at 0: w = psi = 0; M = 0, Q = 1 at 1
    M, Q = np.linalg.solve(T[2:, 2:], [0.0, 1.0])
    assert abs(T[0, 2:] @ [M, Q]) * 3 - 1 == pytest.approx(deflection, rel=1e-6)

    def pinned(W, e):
        return np.linalg.det(transfer(r, e, W)[np.ix_([0, 2], [1, 3])])

    for found, with_shear in ((frequency, e), (inertia, 0.0)):
        W = brentq(pinned, 0.2 * np.pi**2, 1.001 * np.pi**2, args=(with_shear,), xtol=1e-13)
        assert np.pi**2 / W - 1 == pytest.approx(found, rel=1e-5)


def test_cowpers_printed_coefficients():
    """At nu = 0.3: circle 0.886, thin tube 0.531, rectangle 0.850 (Cowper 1966; six sevenths and 5/6 at nu = 0)."""
    steel = MATERIALS["steel"]

    def kappa(**section):
        return piston_section(Piston.round(length=1.0, section=Tube(**section), material=steel)).kappa

    assert kappa(diameter=0.02) == pytest.approx(0.886, abs=5e-4)
    assert kappa(diameter=0.02, inner_diameter=0.01999) == pytest.approx(0.531, abs=1e-3)
    flat = Actuator.from_section(section=Rectangle(width=0.1, height=0.02), material=steel, length=1.0, free_length=0.5)
    found = beam_section(flat)
    assert found.kappa == pytest.approx(0.850, abs=5e-4)
    assert found.gyration == pytest.approx(0.02 / np.sqrt(12))
    assert beam_section(Actuator(length=1.0, EI=1.0, rhoA=1.0, free_length=0.5)) is None


def test_pistons_given_by_stiffness_are_round_bars():
    round_bar = Piston.round(length=1.0, section=Tube(diameter=0.02), material=MATERIALS["steel"])
    bare = Piston(length=1.0, EA=round_bar.EA, EI=round_bar.EI, rhoA=1.0)
    assert piston_section(bare) == piston_section(round_bar)
    assert piston_section(bare).gyration == pytest.approx(0.005)


def test_ten_widths_are_where_it_begins_to_count():
    deflection, frequency, inertia = bending_errors(BendingSection(gyration=0.25, kappa=0.886), 10.0)
    assert (deflection, frequency, inertia) == pytest.approx((0.0055, 0.0121, 0.0031), rel=0.02)
