"""Orders of the solid actuator: distance of the stations 4 in a frequency, time step 4, elements."""

import numpy as np
import pytest

import flexapod as fx
from flexapod.analysis.solid import simulate_solid
from flexapod.model import Rectangle
from flexapod.solve.fem.frequencies import frequencies
from flexapod.solve.fem.hexahedra import beam_mesh
from flexapod.solve.fem.reduction import reduced_beam
from flexapod.solve.fem.sliding import HubMotion, SlidingBeam, gauss_step

pytestmark = pytest.mark.convergence

FLAT, LENGTH = Rectangle(width=0.1524, height=0.0095), 3.66
MATERIAL = {"E": 756.65 / FLAT.second_moment, "density": 4.02 / FLAT.area}


def orders(errors, ratio=2.0):
    return np.log(np.array(errors[:-1]) / np.array(errors[1:])) / np.log(ratio)


def test_stations_are_of_order_four():
    def third(intervals):
        model = reduced_beam(FLAT, LENGTH, LENGTH / 96, **MATERIAL, kind="hex8", spacing=LENGTH / intervals)
        still = {"length_rate": 0.0, "length_acceleration": 0.0, "angle_rate": 0.0, "angle_acceleration": 0.0}
        return SlidingBeam(model=model).frequencies(HubMotion(length=LENGTH / 2, angle=0.0, **still))[2]

    limit = third(96)  # one linear element an interval: nothing is condensed but what bending does not move
    errors = [third(n) / limit - 1 for n in (12, 24, 48)]
    # Approached from below: with 2 stations per half wave at first, 8 at last, the next order is seen.
    rates = orders(errors)
    np.testing.assert_allclose(rates, 4.0, atol=0.2)
    assert rates[1] > rates[0]


def test_time_steps_are_of_order_four():
    mass, stiff = np.diag([1.0, 2.0]), np.array([[3.0, -1.0], [-1.0, 4.0]])

    def stage(t):
        return (1 + 0.5 * np.sin(t)) * stiff, np.array([np.cos(t), 0.0])

    def end(n):
        a, v = np.array([1.0, 0.0]), np.array([0.0, 1.0])
        for i in range(n):
            a, v = gauss_step(mass, stage, i * 4.0 / n, 4.0 / n, a, v)
        return np.concatenate([a, v])

    limit = end(1280)
    errors = [np.abs(end(n) - limit).max() for n in (20, 40, 80)]
    np.testing.assert_allclose(orders(errors), 4.0, atol=0.1)


def test_steps_keep_the_energy_of_a_steady_system():
    mass, stiff = np.diag([1.0, 2.0]), np.array([[3.0, -1.0], [-1.0, 4000.0]])
    a, v = np.array([1.0, 0.1]), np.array([0.0, 1.0])
    begin = v @ mass @ v + a @ stiff @ a
    for i in range(200):
        a, v = gauss_step(mass, lambda t: (stiff, np.zeros(2)), 0.1 * i, 0.1, a, v)
    assert v @ mass @ v + a @ stiff @ a == pytest.approx(begin, rel=1e-11)


def test_linear_elements_are_of_order_two():
    # Their stiffness is high by 1 + (l / h)^2 / 2, a frequency by (l / h)^2 / 4 once that is small.
    section, exact = Rectangle(width=0.01, height=0.0095), 2.29246755
    errors = []
    for layers in (400, 800):
        mesh = beam_mesh(section, 1.83, 1.83 / layers, kind="hex8", whole=False)
        errors.append(frequencies(mesh, **MATERIAL, count=1)[0] / exact - 1)
    assert errors[0] == pytest.approx(0.25 * (1.83 / 400 / 0.0095) ** 2, rel=0.05)
    np.testing.assert_allclose(orders(errors), 2.0, atol=0.1)


def test_the_response_does_not_depend_on_the_stations():
    """Stations every 102 and every 51 mm: the mouth passes twice as many."""
    study = fx.preset("paper-actuator")
    coarse, fine = (
        simulate_solid(study, size=0.025, spacing=LENGTH / n, duration=1.0, output_step=0.01).tip_deflection.values
        for n in (36, 72)
    )
    # Third mode, 16 um, wrong by 1e-4 of 40 cycles at most: 0.4 um; fourth, 4 um, by 4e-4 of 80: 0.8 um; a few more.
    assert np.abs(coarse - fine).max() < 2.5e-6
