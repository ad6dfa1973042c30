"""Pistons that would shear, in legs that keep them straight: their sections turn with the leg."""

import numpy as np
import pytest
from tests.helpers.mechanisms import three_rps
from tests.helpers.moving import moving
from tests.helpers.runs import with_legs

import flexapod as fx
from flexapod.model import MATERIALS, Tube
from flexapod.model.leg.piston import Piston

pytestmark = pytest.mark.analytic

LENGTH, D, d = 0.75, 0.12, 0.05
STEEL = MATERIALS["steel"]
#: rho I of a ring times the length [kg m^2]
ROTARY = STEEL.density * np.pi / 64 * (D**4 - d**4) * LENGTH


def bar(**more):
    return Piston.round(length=LENGTH, section=Tube(diameter=D, inner_diameter=d), material=STEEL, **more)


def test_its_rotary_inertia_is_that_of_a_ring():
    np.testing.assert_allclose(bar(shear=True).rotary_inertia, ROTARY, rtol=1e-12)
    np.testing.assert_array_equal(bar().rotary_inertia, 0.0)


@pytest.mark.parametrize("kind", ["6-UPS", "3-RPS"])
@pytest.mark.parametrize("fidelity", ["rigid", "lumped"])
def test_straight_pistons_turn_as_cylinders_with_that_inertia(kind, fidelity):
    """The other side: a slender piston beside a cylinder with so much more inertia about its centre of mass."""
    given = moving(kind, step=None, tolerance=1e-8)
    thick = with_legs(given, piston=bar(shear=True))
    inertia = given.robot.legs[0].cylinder.inertia + ROTARY
    other = with_legs(given, lambda leg: leg.replace(piston=bar(), cylinder=leg.cylinder.replace(inertia=inertia)))
    slender = with_legs(given, piston=bar())
    found, right, without = (fx.simulate(x, fidelity=fidelity, duration=0.06) for x in (thick, other, slender))
    off = 1e-8 if fidelity == "rigid" else 1e-7  # stretch rings: steps of the two runs are not the same
    for name in ("joint_force", "energy_kinetic", "actuator_force_rigid"):
        np.testing.assert_allclose(found[name], right[name], rtol=0, atol=off * np.abs(right[name].values).max())
    assert np.abs(found.energy_kinetic - without.energy_kinetic).max() > 1e-5 * without.energy_kinetic.max()


def test_modes_of_lumped_legs_have_it():
    robot = three_rps()
    robot = robot.replace(legs=tuple(leg.replace(piston=bar(shear=True)) for leg in robot.legs))
    inertia = robot.legs[0].cylinder.inertia + ROTARY
    legs = tuple(leg.replace(piston=bar(), cylinder=leg.cylinder.replace(inertia=inertia)) for leg in robot.legs)
    found, right = (fx.modes(x, fidelity="lumped").frequency.values for x in (robot, robot.replace(legs=legs)))
    np.testing.assert_allclose(found, right, rtol=1e-10)
