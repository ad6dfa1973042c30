"""Decks of robots of many kinds by CalculiX against our modes and sag."""

import numpy as np
import pytest
from tests.mechanisms import ROBOTS

import flexapod as fx
from flexapod.exchange.export import abaqus_deck
from flexapod.proof.engines import calculix
from flexapod.proof.engines.engine import CALCULIX

pytestmark = pytest.mark.skipif(not CALCULIX.found(), reason="needs CalculiX")

#: Frequencies that are compared, and how much solid bars may differ from beams: ten elements bend 3e-4 too stiffly at
#: most, shear and rotary inertia of bars 20 to 40 times as long as thick take (thickness / length)^2, 1e-3 to 2e-3, off
#: where bending stiffness counts, and twist of a square bar is another where joints twist their legs.
COMPARED = {
    "3-RPS": (6, 5e-3),
    "8-UPS": (10, 1e-3),
    "6-PUS": (10, 3e-3),
    "6-RUS": (10, 3e-3),
    "6-UCU": (10, 1e-3),
    "planar 3-RPR": (8, 1e-2),
    "planar 3-PRR": (8, 3e-3),
}


@pytest.mark.parametrize("name", COMPARED)
def test_frequencies_and_sag(name):
    robot, (count, tolerance) = ROBOTS[name](), COMPARED[name]
    run = calculix.run(abaqus_deck(robot, elements=10, modes=count + 2))
    ours = fx.modes(robot)
    np.testing.assert_allclose(run.frequencies()[:count], ours.frequency.values[:count], rtol=tolerance)
    sag, theirs = ours.com_sag.values, run.displacements("PAYLOAD")[1][0].mean(axis=0)
    # A hundredth part of bending is shear; planar robots, whose weight is across their plane, do not sag: below 10 pm.
    np.testing.assert_allclose(theirs, sag, rtol=0, atol=0.01 * np.abs(sag).max() + 1e-11)
