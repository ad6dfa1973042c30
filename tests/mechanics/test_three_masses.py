"""Rotor, screw and nut, piston: three masses on an axis, written here, and our springs in series as their limit.

Equations (T23.31)-(T23.33), one axis: the heave of six upright-like legs has the same frequencies, with the travel of a
leg for that of the platform.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import eigh
from tests.helpers.machines import SCREW, STILL, light, symmetric

import flexapod as fx
from flexapod.mechanics.elements.springs import springs_along
from flexapod.model import Loop

pytestmark = pytest.mark.consistency


def active(robot):
    """Stiffness of shaft, twist and bearing, and of the nut, of the first leg at home [N/m]."""
    length = robot.home_lengths[:1]
    give = {x.name: float(x.at_length(length)[0]) for x in springs_along(robot.legs[0])}
    return 1 / (give["screw"] + give["twist"] + give["bearing"]), 1 / give["nut"]


def frequencies(rotor, screw, piston, k_a, k_b, loop=0.0):
    """Of three masses [kg] [Hz]; the rotor's is inf where its brake is on."""
    K = np.array([[k_b + loop, k_b, -k_b], [k_b, k_a + k_b, -k_b], [-k_b, -k_b, k_b]])
    M, chosen = np.diag([rotor, screw, piston]), slice(None)
    if np.isinf(rotor):
        M, chosen = np.diag([1.0, screw, piston]), slice(1, None)
    values = eigh(K[chosen, chosen], M[chosen, chosen], eigvals_only=True)
    return np.sqrt(np.maximum(values, 0.0)) / (2 * np.pi)


def ours(drive):
    """A machine of legs without mass and stretch: of heave its frequencies, and its numbers by a leg's travel."""
    robot = light(symmetric(drive=drive, damping=0.0), **STILL)
    stiff = robot.legs[0].piston.replace(EA=1e15)
    robot = robot.replace(legs=tuple(leg.replace(piston=stiff) for leg in robot.legs))
    share = 6 / robot.home_lengths[0] ** 2  # legs of height 1 m: cos^2 of their lean, six times
    return fx.modes(robot, fidelity="lumped").frequency.values, robot, 1000.0 / share


def nearest(found, value):
    return found[np.abs(found - value).argmin()]


def test_without_a_mass_of_the_screw_they_are_ours():
    found, robot, mass = ours(SCREW)
    k_a, k_b = active(robot)
    # Stretch of 1e15 N/m, and a screw of a milligram: 1e-6 / 167 kg.
    locked = frequencies(np.inf, 1e-6, mass, k_a, k_b)[0]
    assert nearest(found, locked) == pytest.approx(locked, rel=1e-6)
    loose = SCREW.replace(command="servo", loop=Loop(stiffness=1e-4))
    found, robot, mass = ours(loose)
    free = frequencies(loose.inertia / loose.per_turn**2, 1e-6, mass, k_a, k_b)
    assert free[0] < 1e-3 * free[1]  # all three travel together
    assert nearest(found, free[1]) == pytest.approx(free[1], rel=1e-6)


def test_the_mass_of_the_screw_hardly_counts():
    found, robot, mass = ours(SCREW)
    k_a, k_b = active(robot)
    screw = SCREW.material.density * SCREW.area * SCREW.length
    assert 4 < screw < 5  # kg
    low, high = frequencies(np.inf, screw, mass, k_a, k_b)
    ratio = nearest(found, low) / low - 1
    # First order in the mass; its square is left out.
    assert ratio == pytest.approx(0.5 * (k_b / (k_a + k_b)) ** 2 * screw / mass, rel=0.05)
    assert ratio < 0.01
    assert high == pytest.approx(np.sqrt((k_a + k_b) / screw) / (2 * np.pi), rel=0.02) and high > 1500


def test_rigid_nut_and_brake():
    stiff, mass, k_a = 1e14, 150.0, 3e8
    # With a rigid nut the screw's mass goes with l - r: with the brake on it adds to the piston's.
    low = frequencies(np.inf, 5.0, mass, k_a, stiff)[0]
    assert low == pytest.approx(np.sqrt(k_a / (mass + 5.0)) / (2 * np.pi), rel=1e-5)
    # A heavy rotor is a brake.
    assert frequencies(1e12, 5.0, mass, k_a, 5e8)[1] == pytest.approx(
        frequencies(np.inf, 5.0, mass, k_a, 5e8)[0], rel=1e-8
    )
    # A loop of the servo in series with both, under a load at rest.
    K = np.array([[5e8 + 2e7, 5e8, -5e8], [5e8, k_a + 5e8, -5e8], [-5e8, -5e8, 5e8]])
    assert np.linalg.solve(K, [0, 0, 1e3])[2] == pytest.approx(1e3 * (1 / 2e7 + 1 / k_a + 1 / 5e8), rel=1e-12)


def test_the_change_of_the_active_length_is_that_of_the_series_spring():
    """A piston let go under a force, the rotor held: three masses with k_a(l) against one spring k(l) of ours."""
    k_b, mass, force = 5e8, 150.0, 4e4

    def k_a(at):  # shaft of an active length that grows with the nut's place
        return 1 / (1 / 8e8 + at / 1.3e8)

    def slope(at, h=1e-6):
        return (k_a(at + h) - k_a(at - h)) / (2 * h)

    def three(t, y, screw):
        at, x, v, w = y
        apart = at - l0 - x
        return [v, w, (-k_b * apart - 0.5 * slope(at) * x**2 + force) / mass, (k_b * apart - k_a(at) * x) / screw]

    def one(t, y):
        at, v = y
        k = 1 / (1 / k_a(at) + 1 / k_b)
        change = k**2 * slope(at) / k_a(at) ** 2
        return [v, (-k * (at - l0) - 0.5 * change * (at - l0) ** 2 + force) / mass]

    l0 = 0.4
    t = np.linspace(0, 0.02, 50)
    exact = solve_ivp(one, (0, 0.02), [l0, 0.0], t_eval=t, rtol=1e-10, atol=1e-13).y[0] - l0
    gaps = []
    for screw in (0.04, 0.02):
        y = solve_ivp(
            three, (0, 0.02), [l0, 0, 0, 0], args=(screw,), t_eval=t, rtol=1e-8, atol=1e-12, method="DOP853"
        ).y[0]
        gaps.append(np.abs(y - l0 - exact).max())
    # What is left goes with the screw's mass.
    assert gaps[0] < 2e-3 * exact.max() and gaps[0] / gaps[1] == pytest.approx(2, rel=0.1)
