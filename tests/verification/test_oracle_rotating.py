"""The oracle of rotating beams reproduces the tables of flap and lag frequencies."""

import numpy as np
import pytest
from tests.oracles import rotating

from flexapod.verification.cases.turning import FAST, FLAP, LAG

pytestmark = pytest.mark.literature

# hub radius and tip mass: half a unit of the last digit printed of flap and lag, rounded up
FLAP_DIGIT = {(0.0, 0.0): 7e-7, (0.0, 1.0): 6e-6, (1.0, 0.0): 6e-5, (5.0, 0.0): 6e-5, (0.5, 1.0): 7e-7}
LAG_DIGIT = {(0.0, 0.0): 6e-5, (0.5, 1.0): 7e-7}


@pytest.mark.parametrize(("g", "hub", "mass", "printed"), FLAP)
def test_flap(g, hub, mass, printed):
    ours = rotating.flap(g, hub, mass, n=len(printed))
    np.testing.assert_allclose(ours, printed, rtol=0, atol=FLAP_DIGIT[hub, mass])


@pytest.mark.parametrize(("g", "hub", "mass", "printed"), LAG)
def test_lag(g, hub, mass, printed):
    ours = rotating.lag(g, hub, mass, n=len(printed))
    np.testing.assert_allclose(ours, printed, rtol=0, atol=LAG_DIGIT[hub, mass])
    np.testing.assert_allclose(rotating.flap(g, hub, mass) ** 2 - rotating.lag(g, hub, mass) ** 2, g**2, rtol=1e-8)


@pytest.mark.parametrize(("g", "hub", "printed"), [row[:3] for row in FAST])
def test_boundary_layer_at_the_root(g, hub, printed):
    # the layer is thin and the tabulated value stems from fewer shapes, so it lies above (Ritz) by up to 6e-5
    assert rotating.flap(g, hub)[0] == pytest.approx(printed, rel=7e-5)


def test_fast_rotation_against_a_boundary_value_solver():
    # scipy.integrate.solve_bvp on y'''' = (N y')' + W^2 y at tolerance 1e-9
    assert rotating.flap(50, 5)[0] == pytest.approx(144.38172046, rel=1e-7)
