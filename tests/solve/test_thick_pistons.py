"""Pistons that shear and whose sections have rotary inertia against Timoshenko's beam."""

import numpy as np
import pytest
from scipy.linalg import expm
from tests.helpers.stepped import (
    function,
    leg_of,
    outside,
    root_near,
    section,
    shapes_of,
    squared_frequencies,
    steps_of,
    vector,
)

from flexapod.analysis.checks.estimates import bending_errors, piston_section
from flexapod.mechanics.elements.steps import tip_elimination
from flexapod.solve.sections import numeric_pieces, section_rotary_inertia

pytestmark = pytest.mark.analytic


def spectra(n, length, step):
    """Both angular frequencies of n half waves between pinned ends."""
    k, turn, mass = n * np.pi / length, section_rotary_inertia(step, 0), step.rhoA
    middle = mass + mass * step.EI[0] * k**2 / step.shear + turn * k**2
    return np.sqrt(np.sort(np.roots([mass * turn / step.shear, -middle, step.EI[0] * k**4])))


def misfit(leg, free, omega):
    """Vanishes at frequencies of the leg with pinned ends, by transfer matrices of Timoshenko's beam."""
    pieces, inertia = outside(leg, free)
    mouth, out = leg.cylinder.mouth, {step: length for length, step in pieces}
    inertia += sum(section_rotary_inertia(step, 0) * (step.length - out.get(step, 0.0)) for step in steps_of(leg))
    ends = []
    for slope, force in ((1.0, 0.0), (0.0, 1.0)):
        ends.append([mouth * slope, slope, force * mouth - inertia * omega**2 * slope, force])
    state = np.array(ends).T  # deflection, turn of the section, moment, dM/dX + rho I omega^2 turn
    for length, step in pieces:
        A = np.zeros((4, 4))
        A[0, 1], A[0, 3], A[1, 2] = 1.0, -1 / step.shear, 1 / step.EI[0]
        A[2, 3], A[2, 1], A[3, 0] = 1.0, -section_rotary_inertia(step, 0) * omega**2, step.rhoA * omega**2
        state = expm(A * length) @ state
    return np.linalg.det(state[[0, 2]])


def test_both_spectra_of_a_pinned_beam():
    # A strut of length to diameter 5; six shapes of bending and six of shear give sines to 1e-9 at one half wave
    leg = leg_of([section(0.6, 0.12)], 0.0, 0.0)
    found = np.sqrt(squared_frequencies(leg, 0.6, shear=True)[::2])
    first, second = zip(*(spectra(n, 0.6, leg.piston.steps[0]) for n in (1, 2)), strict=True)
    assert found[0] == pytest.approx(first[0], rel=1e-6)
    assert found[1] == pytest.approx(first[1], rel=2e-4)
    assert np.abs(found / second[0] - 1).min() < 1e-6
    assert np.abs(found / spectra(0, 0.6, leg.piston.steps[0])[1] - 1).min() < 1e-6  # pure shear, no deflection
    slender = np.sqrt(squared_frequencies(leg, 0.6)[0])
    assert slender / found[0] - 1 == pytest.approx(bending_errors(piston_section(leg.piston), 0.6)[1], rel=1e-3)


@pytest.mark.parametrize("free", [0.6, 0.4])  # a cut outside, a cut inside
def test_thick_sections(free):
    leg = leg_of([section(0.3, 0.12), section(0.45, 0.09)])
    found = np.sqrt(squared_frequencies(leg, free, shear=True)[0])
    assert root_near(lambda w: misfit(leg, free, w), found) == pytest.approx(found, rel=1e-6)


def test_thin_pistons_do_not_shear():
    # What shear and rotary inertia take off falls with the square of the diameter
    off = []
    for diameter in (0.02, 0.01):
        leg = leg_of([section(0.75, diameter)], mass=0.0)
        thick, thin = (squared_frequencies(leg, 0.6, modes=3, shear=x)[0] for x in (True, False))
        off.append(1 - thick / thin)
    assert off[0] / off[1] == pytest.approx(4, rel=0.05)
    assert 0 < off[1] < 5e-3


def test_a_force_at_the_tip_deflects_by_bending_and_shear():
    leg = leg_of([section(0.3, 0.12), section(0.45, 0.09)], mass=1.0)
    shapes = shapes_of(2, 0, 2, shear=True)
    q = np.zeros(shapes.size)
    q[2] = 1.0
    _, _, K, J = function(shapes, 1)(q, np.zeros(3), vector(leg, shapes, 1.0))
    free = [k for k in range(shapes.size) if k > 2]  # bending and shear of both planes
    give = J[0, free] @ np.linalg.solve(K[np.ix_(free, free)], J[0, free])
    (inner, thick), (outer, thin) = outside(leg, 0.6)[0]
    whole, EI, ei = inner + outer, thick.EI[0], thin.EI[0]
    bending = (whole**3 - outer**3) / (3 * EI) + outer**3 / (3 * ei)
    assert give == pytest.approx(bending + inner / thick.shear + outer / thin.shear, rel=1e-10)


def test_kinetic_energy_of_turning_sections():
    # Without amplitudes of shear: what thick pistons have more than slender ones, by slopes of material points
    leg = leg_of([section(0.3, 0.12), section(0.45, 0.09)], mass=0.0)
    thick, thin = shapes_of(3, 0, 2, shear=True), shapes_of(3, 0, 2)
    rng = np.random.default_rng(2)
    q, v = 1e-5 * rng.uniform(-1, 1, thick.size), 1e-4 * rng.uniform(-1, 1, thick.size)
    q[:3], v[:3], q[9:], v[9:] = [0.0, 0.0, 1.0], [0.7, -1.1, 0.4], 0.0, 0.0
    T = function(thick, 2)(q, v, np.zeros(2), vector(leg, thick, 1.0))[0][0]
    T -= function(thin, 2)(q[:9], v[:9], np.zeros(2), vector(leg, thin, 1.0))[0][0]

    def slope(q, xi, a):
        s = q[2] - leg.cylinder.mouth
        parts = numeric_pieces(leg, thin.beam.b, np.array([s]), 0)
        piece = next(part for part in parts if xi / s <= part.end[0])
        shapes = piece.value(np.array([xi / s]), 1)
        return -a @ (shapes - tip_elimination(parts[0].value_start) * shapes[:1])[:, 0] / s

    x, w = np.polynomial.legendre.leggauss(12)
    total, h = 0.0, 1e-5
    for low, high, step in ((0.0, 0.45, 1), (0.45, 0.6, 0), (0.6, 0.75, 0)):
        for at, weight in zip(low + (high - low) * (x + 1) / 2, w * (high - low) / 2, strict=True):
            rate = np.zeros(2)
            if low < 0.6:
                ends = [[slope(y, at, y[3 + 3 * k : 6 + 3 * k]) for k in (0, 1)] for y in (q + h * v, q - h * v)]
                rate = (np.array(ends[0]) - ends[1]) / (2 * h)
            spin = (v[1] + rate[0]) ** 2 + (v[0] - rate[1]) ** 2
            total += 0.5 * weight * section_rotary_inertia(leg.piston.steps[step], 0) * spin
    assert pytest.approx(total, rel=1e-8) == T
