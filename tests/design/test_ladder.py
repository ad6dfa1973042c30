"""One robot and one beam on every rung of the ladder: elements and segments approach assumed modes with their order."""

from functools import cache

import numpy as np
import pytest
from tests.helpers.runs import paper_robot
from tests.oracles import beams

import flexapod as fx

pytestmark = pytest.mark.convergence

POSE = {"roll": 0.3}
ROLL = {"duration": 0.3, "step": 1e-3, "output_step": 5e-3}
LADDER = [("beam-fem", 4.0), ("finite-segment", 2.0)]


@cache
def frequencies(fidelity, modes):
    """The lowest 17: six of the payload and the first bending modes of the legs, all below 120 Hz."""
    return fx.modes(paper_robot(), POSE, fidelity=fidelity, modes=modes).frequency.values[:17]


def error(fidelity, modes):
    return np.abs(frequencies(fidelity, modes) / frequencies("assumed-modes", 6) - 1).max()


@pytest.mark.parametrize(("fidelity", "order"), LADDER)
def test_modes_of_the_robot(fidelity, order):
    coarse, fine = error(fidelity, 4), error(fidelity, 8)
    assert np.log2(coarse / fine) == pytest.approx(order, abs=0.15)


def test_bending_modes_of_the_robot_in_beam_elements():
    # Ritz values, high by (lam / n)^4 / 1440; lam^4 = omega^2 rhoA s^4 / EI < 20 in the first bending mode of a leg.
    gap = frequencies("beam-fem", 8) / frequencies("assumed-modes", 6) - 1
    assert (gap > 0).all()
    assert gap.max() < 20 / 4**4 / 1440


@cache
def roll(fidelity, modes):
    return fx.simulate(paper_robot(), fidelity=fidelity, modes=modes, **ROLL)


@pytest.mark.parametrize("name", ["tip_deflection", "com_deviation"])
@pytest.mark.parametrize(("fidelity", "order"), LADDER)
def test_a_short_roll_of_the_robot(fidelity, order, name):
    reference = roll("assumed-modes", 6)[name]
    scale = np.abs(reference).max()
    coarse, fine = (float(np.abs(roll(fidelity, k)[name] - reference).max() / scale) for k in (4, 8))
    assert np.log2(coarse / fine) == pytest.approx(order, abs=0.15)
    # Legs bend under their weight and inertia. Segments: compliance low by 1 / (4 n^2) = 4e-3. Cubics: exact there;
    # what vibrates has the error of omega^2, twice that of the modes above. The payload feels no more than the legs.
    assert fine < {"beam-fem": 2 * 20 / 4**4 / 1440, "finite-segment": 0.25 / 8**2}[fidelity]


def test_a_sliding_beam_in_elements():
    # Table 2, undamped, 2 s: mode i of n = 3 elements is fast by (lam / n)^4 / 1440 and runs ahead by 2 pi f t of that,
    # f at most that of the shortest beam; its share of a beam let go from a tip force is 1 / lam^4, of a gap twice it.
    beam = fx.preset("paper-actuator")
    ours, reference = (
        fx.simulate_actuator(beam, fidelity=f, modes=6, duration=2.0, step=5e-4, output_step=5e-3).tip_deflection
        for f in ("beam-fem", "assumed-modes")
    )
    lam = beams.beam_roots("clamped", "free", 5)
    ahead = 2 * np.pi * np.array([2.292, 14.37, 40.23, 78.8, 130.3]) * 2.0 * (lam / 3) ** 4 / 1440
    bound = np.minimum(ahead, 2) @ lam**-4 / (lam**-4).sum()
    gap = float(np.abs(ours - reference).max() / np.abs(reference).max())
    assert bound / 10 < gap < bound
