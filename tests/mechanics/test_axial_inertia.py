"""Inertia of pistons about their axis: as given, or that of a round section where a leg twists, as the page says."""

from pathlib import Path

import numpy as np
import pytest
from tests.helpers.mechanisms import hexapod

import flexapod as fx
from flexapod.model import MATERIALS
from flexapod.model.leg.material import Tube
from flexapod.model.leg.piston import Piston

pytestmark = pytest.mark.consistency

STEEL = MATERIALS["steel"]
ROUND = Piston.round(length=0.75, section=Tube(diameter=0.04, inner_diameter=0.02), material=STEEL)
OWN = np.pi / 32 * (0.04**4 - 0.02**4) * STEEL.density * 0.75  # kg m^2, rho I_p L


def frequencies(chain, axial_inertia):
    piston = ROUND if axial_inertia is None else ROUND.replace(axial_inertia=axial_inertia)
    robot = hexapod(chain)
    robot = robot.replace(legs=tuple(leg.replace(piston=piston) for leg in robot.legs))
    return fx.modes(robot, {"surge": 0.05, "yaw": 0.1}, modes=2).frequency.values


@pytest.mark.parametrize("chain", ["UPF", "FPF"])
def test_a_leg_that_twists_has_the_inertia_of_its_section(chain):
    own = frequencies(chain, OWN)
    for given in (None, 0.0):
        np.testing.assert_allclose(frequencies(chain, given), own, rtol=1e-12)
    assert np.abs(frequencies(chain, 1.5 * OWN) / own - 1).max() > 1e-6


def test_a_leg_that_a_ball_leaves_free_has_what_is_given():
    none = frequencies("UPS", 0.0)
    np.testing.assert_allclose(frequencies("UPS", None), none, rtol=1e-12)
    assert np.abs(frequencies("UPS", OWN) / none - 1).max() > 1e-9


def test_the_page_says_so():
    page = (Path(__file__).parents[2] / "docs" / "study-file.md").read_text(encoding="utf-8")
    rows = [line for line in page.splitlines() if line.startswith("| `axial_inertia` |") and "0 counts" in line]
    assert len(rows) == 2  # piston and strut
    assert all("| 0; of a round section where the leg twists" in row for row in rows)
