"""Decks of robots of many kinds by CalculiX against our modes and sag."""

import numpy as np
import pytest
from tests.helpers.mechanisms import ROBOTS

import flexapod as fx
from flexapod.model import AxialSpring
from flexapod.output.exchange.pose_deck import abaqus_deck
from flexapod.verification.engines import calculix
from flexapod.verification.engines.engine import CALCULIX

pytestmark = [pytest.mark.consistency, pytest.mark.skipif(not CALCULIX.is_available(), reason="needs CalculiX")]

#: Frequencies that are compared, and how much solid bars may differ from beams: ten elements bend 3e-4 too stiffly at
#: most, shear and rotary inertia of bars 20 to 40 times as long as thick take (thickness / length)^2, 1e-3 to 2e-3, off
#: where bending stiffness counts, and twist of a square bar is another where joints twist their legs.
COMPARED = {
    "3-RPS": (6, 5e-3),
    "8-UPS": (10, 1e-3),
    "6-PUS": (10, 3e-3),
    "6-RUS": (10, 3e-3),
    "6-UCU": (10, 1e-3),
    "planar 3-RPR": (6, 1e-2),
    "planar 3-PRR": (6, 3e-3),
}


@pytest.mark.parametrize("name", COMPARED)
def test_frequencies_and_sag(name):
    robot, (count, tolerance) = ROBOTS[name](), COMPARED[name]
    run = calculix.run(abaqus_deck(robot, elements=10, modes=2 * count + 2))
    ours, found = fx.modes(robot), np.array(run.frequencies())
    frequency = ours.frequency.values[:count]
    if robot.plane:  # solid legs bend across the plane, too: what they do in it is among the rest
        found = found[np.abs(found - frequency[:, None]).argmin(axis=1)]
    np.testing.assert_allclose(found[:count], frequency, rtol=tolerance)
    sag, theirs = ours.com_sag.values, run.displacements("PAYLOAD")[1][0].mean(axis=0)
    # A hundredth part of bending is shear. The weight of planar robots is across their plane: their solid legs sag
    # by w = 5 q L^4 / 384 EI = 13 um and shorten by 2.4 w^2 / L = 1 nm.
    np.testing.assert_allclose(theirs, sag, rtol=0, atol=0.01 * np.abs(sag).max() + (2e-9 if robot.plane else 0.0))


@pytest.mark.parametrize("name", ["3-RPS", "8-UPS", "6-PUS"])
def test_joints_that_give_way_along_and_across_their_legs(name):
    robot, at = ROBOTS[name](), {"stiffness": np.diag([5e6, 5e6, 8e6, 0, 0, 0]), "leg_axes": True}
    plate = AxialSpring(name="plate", stiffness=1e7, at="base")

    def soft(leg):
        ends = {end: getattr(leg, end).replace(**at) for end in ("base_joint", "platform_joint")}
        return leg.replace(springs=(plate,), **ends)

    robot = robot.replace(legs=tuple(soft(leg) for leg in robot.legs))
    run = calculix.run(abaqus_deck(robot, elements=10, modes=20))
    ours = fx.modes(robot)
    # Joints make these up for the most part, springs in both: what solid bars differ by counts less. What linear
    # equations leave out is the weight times its distance over the rotational stiffness: 1e-4.
    np.testing.assert_allclose(run.frequencies()[:3], ours.frequency.values[:3], rtol=COMPARED[name][1])
    sag, theirs = ours.com_sag.values, run.displacements("PAYLOAD")[1][0].mean(axis=0)
    np.testing.assert_allclose(theirs, sag, rtol=0, atol=0.01 * np.abs(sag).max())
