"""Stepped pistons: kinetic energy by material points, equal sections, a robot whose cuts pass the mouths."""

import re
from itertools import pairwise

import casadi
import numpy as np
import pytest
from tests.helpers.stepped import function, leg_of, section, shapes_of, vector

import flexapod as fx
from flexapod.common.errors import InputError
from flexapod.mechanics.elements.steps import tip_elimination
from flexapod.mechanics.symbolic.vocabulary import taylor_series
from flexapod.model.file.files import preset_text
from flexapod.solve.sections import numeric_pieces

pytestmark = pytest.mark.consistency

THREE = [section(0.2, 0.05), section(0.25, 0.04, inner_diameter=0.03), section(0.3, 0.03)]
PISTON = '{{ sections = [{{ length = "200 mm", diameter = "{} mm", material = "steel" }}, ' \
    '{{ length = "550 mm", diameter = "27 mm", material = "steel" }}] }}'  # fmt: skip


THICK = 'piston = { diameter = "60 mm", length = "750 mm", material = "steel", shear = true }'


def gauss(low, high, count=12):
    x, w = np.polynomial.legendre.leggauss(count)
    return low + (high - low) * (x + 1) / 2, w * (high - low) / 2


def along_piston(leg, points=20001):
    """Distances from the tip, and areas there; those of cuts twice."""
    found, start = [], 0.0
    for one in leg.piston.sections[::-1]:
        share = np.linspace(0.0, 1.0, points)
        diameter = share * one.diameter + (1 - share) * (one.tip_diameter or one.diameter)
        found.append([start + share * one.length, np.pi / 4 * (diameter**2 - (one.inner_diameter or 0.0) ** 2)])
        start += one.length
    return np.hstack(found)


def place(leg, shapes, q, xi):
    """Material points at distances xi from the tip, in the leg's home frame (n, 3)."""
    k, m = shapes.beam.b.count, shapes.beam.axial.count
    (alpha, beta, length), c, amplitudes = q[:3], q[3 : 3 + m], q[3 + m :].reshape(2, k)
    s = length - leg.cylinder.mouth
    x, across, short = xi / s, np.zeros((2, xi.size)), np.zeros(xi.size)
    for direction, a in enumerate(amplitudes):
        beyond = 0.0
        parts = numeric_pieces(leg, shapes.beam.b, s, direction)
        a = a - np.eye(k)[0] * (tip_elimination(parts[0].value_start)[:, 0] @ a)
        for piece in reversed(parts):
            for i in np.flatnonzero((x > piece.start) & (x <= piece.end)):
                at, w = gauss(x[i], piece.end)
                across[direction, i] = (a @ piece.value(x[i : i + 1]))[0]
                short[i] -= 0.5 / s * (beyond + w @ (a @ piece.value(at, 1)) ** 2)
            at, w = gauss(piece.start, piece.end)
            beyond += w @ (a @ piece.value(at, 1)) ** 2
    grid, areas = along_piston(leg)
    soft = np.cumsum([0.0, *(np.diff(grid) * 2 / (areas[1:] + areas[:-1]))])
    along = length - xi + short + c @ shapes.beam.axial.values(1 - np.interp(xi, grid, soft) / soft[-1])
    (ca, sa), (cb, sb) = ((np.cos(angle), np.sin(angle)) for angle in (alpha, beta))
    R = np.array([[cb, 0, sb], [sa * sb, ca, -sa * cb], [-ca * sb, sa, ca * cb]])
    return (R @ np.array([*across, along])).T


def kinetic_energy(leg, shapes, q, v, step=1e-5):
    """By velocities of material points, as differences of their places."""
    ends = np.cumsum([0.0, *(one.length for one in leg.piston.sections[::-1])])
    grid, areas = along_piston(leg)
    breaks = np.unique([*ends, q[2] - leg.cylinder.mouth])
    total = 0.0
    for low, high in pairwise(breaks):
        xi, w = gauss(low, high, 16)
        at = [place(leg, shapes, q + h * step * v, xi) for h in (1, -1, 2, -2)]
        velocity = (8 * (at[0] - at[1]) - (at[2] - at[3])) / (12 * step)
        total += 0.5 * (w * 7800.0 * np.interp(xi, grid, areas)) @ (velocity**2).sum(axis=1)
    return total


@pytest.mark.parametrize(("sections", "length"), [
    (THREE, 1.1),  # two cuts outside
    (THREE, 0.8),  # one outside, one inside
    ([section(0.4, 0.05), section(0.35, 0.05, tip_diameter=0.03)], 1.1),
    ([section(0.4, 0.05), section(0.35, 0.05, tip_diameter=0.03)], 0.65),
])  # fmt: skip
def test_kinetic_energy_is_right_to_second_order(sections, length):
    leg = leg_of(sections, mass=0.0)
    shapes = shapes_of(3, 2, len(sections), tapers=sections is not THREE)
    rng = np.random.default_rng(1)
    q, v = rng.uniform(-1, 1, shapes.size), rng.uniform(-1, 1, shapes.size)
    q[:3], v[:3] = [0.3, -0.2, length], [0.7, -1.1, 0.4]
    energies, gaps = function(shapes, 2), []
    for amplitude in (3e-3, 3e-4):
        here, rate = (np.array([*x[:3], *(size * x[3:])]) for x, size in ((q, amplitude), (v, 30 * amplitude)))
        T = energies(here, rate, np.zeros(2), vector(leg, shapes, 0.9))[0][0]
        gaps.append(abs(T - kinetic_energy(leg, shapes, here, rate)))
    assert gaps[0] / gaps[1] == pytest.approx(1000, rel=0.4)  # what is left is of third order
    assert gaps[1] < 1e-5


def study(diameter):
    return fx.loads(
        re.sub(r"piston = \{.*?\}", "piston = " + PISTON.format(diameter), preset_text("paper-robot"), count=1)
    )


def test_energy_of_thick_pistons_is_kept():
    thick = fx.loads(re.sub(r"piston = \{ dia.*?\}", THICK, preset_text("paper-robot"), count=1))
    gaps = []
    for step in (1e-3, 5e-4):
        data = fx.simulate(thick, step=step, duration=0.6)
        energy = data.energy_kinetic + data.energy_potential + data.energy_strain + data.energy_dissipated
        energy = energy - data.work_drive - data.work_external
        gaps.append(float(energy.max() - energy.min()))
    assert gaps[0] / gaps[1] == pytest.approx(4, rel=0.05)
    assert "shear" not in data.attrs["warnings"]
    assert fx.loads(fx.model.to_toml(thick)).robot.legs[0].piston == thick.robot.legs[0].piston


def test_equal_sections_are_a_uniform_piston():
    # The same shapes, other sums: rounding of some 1e-14 of forces and frequencies
    uniform, cut = fx.preset("paper-robot"), study(27)
    np.testing.assert_allclose(fx.modes(cut).frequency, fx.modes(uniform).frequency, rtol=1e-11)
    a, b = (fx.simulate(x, duration=0.1, step=1e-3) for x in (uniform, cut))
    for name in ("com_deviation", "tip_deflection", "actuator_force"):
        np.testing.assert_allclose(b[name], a[name], rtol=0, atol=1e-8 * float(np.abs(a[name]).max()))


def test_energy_is_kept_while_cuts_pass_the_mouths():
    # Strokes of 0.855 to 0.979 m: the cut at 0.55 m of the piston is in the cylinder below 0.865 m. Order two.
    gaps = []
    for step in (1e-3, 5e-4):
        data = fx.simulate(study(40), step=step, duration=1.0)
        free = data.leg_length.values - 0.31518
        assert free.min() < 0.55 < free.max()
        energy = data.energy_kinetic + data.energy_potential + data.energy_strain + data.energy_dissipated
        energy = energy - data.work_drive - data.work_external
        gaps.append(float(energy.max() - energy.min()))
    assert gaps[0] / gaps[1] == pytest.approx(4, rel=0.15)
    assert gaps[1] < 1e-4 * float(data.energy_kinetic.max())


def test_fidelities_that_know_sections():
    # Lumped: one spring of the whole compliance, and the same mass; others are refused before anything is computed
    data = fx.modes(study(40), fidelity="lumped")
    assert data.frequency[0] > 0
    with pytest.raises(fx.InputError, match="does not know pistons of several sections"):
        fx.simulate(study(40), fidelity="beam-fem", modes=4)
    with pytest.raises(fx.InputError, match=r"leg.piston.sections.*not known to half"):
        fx.ladder(study(40))


@pytest.mark.parametrize(
    "settings",
    [{"fidelity": name, "modes": 4} for name in ("beam-fem", "finite-segment", "solid-fem")]
    + [{"fidelity": "assumed-modes", "basis": "clamped-free"}],
)
def test_shapes_that_do_not_know_shear_are_refused(settings):
    thick = fx.loads(re.sub(r"piston = \{ dia.*?\}", THICK, preset_text("paper-robot"), count=1))
    with pytest.raises(fx.InputError, match="does not know pistons that shear") as refused:
        fx.modes(thick, **settings)
    assert "tip-load" in (refused.value.allowed or "")
    with pytest.raises(fx.InputError, match=r"leg.piston.shear.*not known to half"):
        fx.ladder(thick)


def test_sections_go_through_a_file_and_a_sweep():
    of = study(40)
    assert fx.loads(fx.model.to_toml(of)).robot == of.robot
    from flexapod.common.tables.key_paths import parse_key
    from flexapod.model.file.key_paths import put

    data = {"leg": {"piston": {"sections": [{"diameter": 0.04}, {"diameter": 0.027}]}}}
    put(data, parse_key("leg.piston.sections[2].diameter", what="key"), 0.03)
    assert data["leg"]["piston"]["sections"][1]["diameter"] == 0.03


def test_a_taper_without_pieces_that_stand_for_it_is_refused():
    # A tube whose EI changes tenfold within a 32nd of its length: (T8.23) once took the root of a negative number.
    with pytest.raises(InputError, match=r"tip_diameter = 0.01: tapers too steeply.*Divide the section"):
        section(0.2, 0.44, tip_diameter=0.01, inner_diameter=0.009)
    half = section(0.1, 0.44, tip_diameter=0.225, inner_diameter=0.009)
    assert min(min(step.EI) for step in half.steps) > 0


def test_series_of_shapes_have_the_derivatives_of_the_shapes():
    # What is expanded about the value of x, differentiated twice and put back: x^3 and sin 2x, by hand.
    x = casadi.SX.sym("x")
    (cube, wave), (at, known) = taylor_series([x**3, casadi.sin(2 * x)], x)
    found = [casadi.jacobian(cube * wave, x)]
    found.append(casadi.jacobian(found[0], x))
    exact = casadi.Function("f", [x], [casadi.substitute(casadi.vertcat(cube, wave, *found), at, known)])
    v, s, c = 0.7, np.sin(1.4), np.cos(1.4)
    first = 3 * v**2 * s + 2 * v**3 * c
    second = 6 * v * s + 12 * v**2 * c - 4 * v**3 * s
    np.testing.assert_allclose(exact(v).full()[:, 0], [v**3, s, first, second], rtol=1e-13)
