"""Beam elements on the free length and assumed modes: one motion of the sliding beam of the paper's Table 2, 10 s."""

from functools import cache

import numpy as np
import pytest
from tests.helpers.runs import run_actuator
from tests.oracles import beams
from tests.oracles.ritz import clamped_free

import flexapod as fx
from flexapod.model import override, preset

ELEMENTS, STEP = 12, 5e-5
LENGTH, FEED = 1.83, 0.1
pytestmark = [pytest.mark.consistency, pytest.mark.optimised]  # 700,000 steps
TIP_MM = [5, 1.46875, 2.52914, 3.4969, -9.29794, 3.92053, -8.32143, -9.74686, -4.10753, -1.73481, -2.7728]


@cache
def tip(fidelity, modes, step=STEP):
    """Deflection each 5 ms over 10 s: 12 points in a period of the third mode at its fastest (40 Hz, 16 um)."""
    settings = {"fidelity": fidelity, "modes": modes, "step": step, "output_step": 5e-3}
    basis = {"basis": "clamped-free"} if fidelity == "assumed-modes" else {}
    return fx.simulate_actuator(preset("paper-actuator"), **settings, **basis).tip_deflection.values


def runs_ahead(elements):
    """What the tip may be off, as a share of its start: modes that run ahead, weighted by their share of the shape.

    Mode i of n cubics is fast by (lam / n)^4 / 1440 and runs ahead by that of its angle, the integral of omega over
    the 10 s, c / L^2 with L = 1.83 to 2.83 m. Its share of a beam let go from a tip force goes with lam^-4; a gap of
    two vibrations apart is at most twice that; over lam = 1.2 n per element the leading term ends, and so do modes.
    """
    lam = beams.beam_roots("clamped", "free", 8)
    beam = preset("paper-actuator").actuator
    angle = lam**2 * np.sqrt(beam.EI / beam.rhoA) * (1 / LENGTH - 1 / (LENGTH + FEED * 10)) / FEED
    share = lam**-4 / (lam**-4).sum()
    return np.minimum(angle * (lam / elements) ** 4 / 1440, 2) @ share


def test_ten_seconds_agree_within_a_thousandth_of_the_peak():
    # Both have the integrator's period elongation in common; halving the step moves either by 0.02 % of the peak.
    elements, modes = tip("beam-fem", 2 * ELEMENTS), tip("assumed-modes", 6)
    gap, peak = np.abs(elements - modes).max(), np.abs(modes).max()
    assert peak == pytest.approx(0.01373, rel=1e-3)
    assert gap < 1e-3 * peak
    # The gap is the elements' own: of the size that modes running ahead explain, amplitudes growing with the length.
    explained = 5e-3 * runs_ahead(ELEMENTS)
    assert explained / 10 < gap < explained * (1 + FEED * 10 / LENGTH)


def test_half_the_elements_are_farther_off():
    modes = tip("assumed-modes", 6)
    coarse, fine = (np.abs(tip("beam-fem", 2 * n) - modes).max() for n in (ELEMENTS // 2, ELEMENTS))
    # between the order four of modes in step and the standstill of modes that have lost it: the second is in step
    assert 2 < coarse / fine < 16


def test_the_table_of_the_exact_first_mode():
    # From the exact first mode at 5 mm with q' = 0, q = sqrt(rho L) a: nodal values of the mode, a' = -L'/(2 L) a.
    phi, node = clamped_free(1), np.arange(1, ELEMENTS + 1) / ELEMENTS
    a = 2.5e-3 * np.column_stack([phi(node, 0), phi(node, 1) / ELEMENTS]).ravel()
    study = override(preset("paper-actuator"), fidelity="beam-fem", modes=2 * ELEMENTS, step=STEP, output_step=0.1)
    run = run_actuator(study, a, -FEED / (2 * LENGTH) * a)
    found = 1e3 * run["q"][::10, 0, -2]  # deflection of the last node
    np.testing.assert_allclose(found, TIP_MM, rtol=0, atol=1e-3 * 13.9986)  # 0.1 % of the table's peak
