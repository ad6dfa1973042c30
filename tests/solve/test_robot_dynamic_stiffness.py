"""Frequencies of the locked 6-UPS robot against exact dynamic stiffness and a count that misses none.

First the oracle (`verification/dynamic_stiffness.py`) against closed forms and a count by finite elements, then `modes`
against the oracle. Both are about the undeformed pose: gravity is zero.
"""

from functools import cache

import numpy as np
import pytest
from scipy.linalg import block_diag, eigh
from scipy.optimize import brentq
from tests.oracles import beams

from flexapod import modes
from flexapod.model import ServoDrive, preset
from flexapod.verification import dynamic_stiffness
from flexapod.verification.dynamic_stiffness import legs_and_body
from flexapod.verification.robots import with_unequal_legs, without_cylinders, without_gravity

pytestmark = [pytest.mark.analytic, pytest.mark.usefixtures("uncompiled")]
PISTON = beams.round_section(0.027, 200e9, 7800.0)
HOME = (0.0,) * 6
ROLLED = (0.01, -0.02, 0.03, np.deg2rad(20.0), 0.05, 0.1)
ROUNDING = 1e-10  # of the product's eigenproblem: eps times the spread of the squared frequencies
N = 20  # frequencies compared: the platform's six, twelve of first and two of second bending


def single(mouth=0.0, mass=0.0, free=0.6, **fields):
    tip = np.array([0.0, 0.0, mouth + free])
    fields = {"first_axis": np.array([1.0, 0.0, 0.0]), "Lp": free, "inertia": mass * mouth**2 / 3} | fields
    return dynamic_stiffness.UniformLeg(base=np.zeros(3), tip=tip, mouth=mouth, **PISTON, **fields)


def pinned(leg):
    """Count of one plane with the tip held."""

    def count(omega):
        K, held = dynamic_stiffness.lateral_stiffness(omega, leg, leg.pivot_inertias()[0])
        return dynamic_stiffness.frequency_count((K[:2, :2], held))

    return count


@cache
def case(name):
    """A robot without gravity: as the preset, without cylinders, or with six different legs."""
    change = {"preset": lambda robot: robot, "no cylinder": without_cylinders, "unlike": with_unequal_legs}[name]
    return change(without_gravity(preset("paper-robot").robot))


@cache
def exact(name, pose, shapes=None, compliance=0.0):
    return dynamic_stiffness.robot_frequencies(*legs_and_body(case(name), pose, shapes, compliance), N)


def product(name, pose, k, axial=2, drive=None):
    robot = case(name)
    if drive:
        robot = robot.replace(legs=[leg.replace(drive=drive) for leg in robot.legs])
    return modes(robot, pose, modes=k, axial_modes=axial)["frequency"].values[:N]


def missing_sines(name, frequency, axial):
    return dynamic_stiffness.sine_truncation(legs_and_body(case(name), HOME)[0], frequency, axial)


def missing_polynomials(name, pose, k):
    return dynamic_stiffness.polynomial_truncation(legs_and_body(case(name), pose)[0], exact(name, pose), k)


@pytest.mark.parametrize(
    ("mouth", "mass", "free"), [(0.3, 3.0, 0.6), (0.4, 5.0, 0.6), (0.5, 8.0, 0.6), (0.4, 5.0, 0.34)]
)
def test_oracle_on_one_leg_with_its_tip_pinned(mouth, mass, free):
    known = beams.ups_leg_frequencies(mouth, mass, free, PISTON["EI"], PISTON["rhoA"], 5)
    count = pinned(single(mouth, mass, free))
    # both halve or search to 1e-12 to 1e-14
    np.testing.assert_allclose(dynamic_stiffness.bisect_frequencies(count, 5), known, rtol=3e-12)
    middles = np.pi * np.concatenate([[0.5 * known[0]], known[:-1] + known[1:]])
    assert [count(omega) for omega in middles[1:]] == [1, 2, 3, 4]
    assert count(middles[0]) == 0


def test_oracle_on_pinned_beam_and_bars():
    pinned_pinned = beams.frequency(np.pi * np.arange(1, 7), 0.6, PISTON["EI"], PISTON["rhoA"])
    np.testing.assert_allclose(dynamic_stiffness.bisect_frequencies(pinned(single()), 6), pinned_pinned, rtol=3e-12)
    wave = np.sqrt(PISTON["EA"] / PISTON["rhoA"]) / (2 * np.pi * 0.6)  # Hz for x = 1
    free = dynamic_stiffness.bisect_frequencies(
        lambda w: dynamic_stiffness.frequency_count(dynamic_stiffness.bar_stiffness(w, single())), 3
    )
    np.testing.assert_allclose(free, wave * np.pi * np.array([0.5, 1.5, 2.5]), rtol=3e-12)
    assert free[0] == pytest.approx(2110, abs=0.5)
    soft = single(compliance=2 * 0.6 / PISTON["EA"])  # x tan x = 1/2, tip free
    sprung = dynamic_stiffness.bisect_frequencies(
        lambda w: dynamic_stiffness.frequency_count(dynamic_stiffness.bar_stiffness(w, soft)), 2
    )
    known = [brentq(lambda x: x * np.sin(x) - 0.5 * np.cos(x), a, a + 1.5, xtol=1e-15) for a in (0.0, np.pi)]
    np.testing.assert_allclose(sprung, wave * np.array(known), rtol=3e-12)


def test_held_counts_of_beam_and_bar():
    lam = np.linspace(0.3, 29.9, 500)
    clamped = beams.beam_roots("clamped", "clamped", 9)
    counts = [dynamic_stiffness.beam_stiffness(x**2, 1.0, 1.0, 1.0)[1] for x in lam]
    assert counts == [int(np.sum(clamped < x)) for x in lam]
    omega = 2 * np.pi * np.linspace(100.0, 30e3, 200)
    held = np.pi / 0.6 * np.sqrt(PISTON["EA"] / PISTON["rhoA"]) * np.arange(1, 20)
    assert [dynamic_stiffness.bar_stiffness(w, single())[1] for w in omega] == [int(np.sum(held < w)) for w in omega]


def chain(n, element):
    """n equal elements one behind the other."""
    half = len(element) // 2
    total = np.zeros((half * (n + 1), half * (n + 1)))
    for i in range(0, half * n, half):
        total[i : i + 2 * half, i : i + 2 * half] += element
    return total


def finite_elements(legs, body, n=12):
    """Frequencies [Hz] with n cubic and linear elements a leg, consistent masses."""
    inner = {"K": [], "M": []}
    tied = []
    for leg in legs:
        h, g = (leg.length - leg.mouth) / n, leg.Lp / n
        unit = np.outer([1, h, 1, h], [1, h, 1, h])
        bend = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]]) * unit
        heavy = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) * unit
        ends = np.zeros((2 * n + 2, 2 * n + 1))  # v0, v0' from the cylinder's angle
        ends[:2, 0], ends[2:, 1:] = (leg.mouth, 1), np.eye(2 * n)
        for inertia in leg.pivot_inertias():
            M = ends.T @ chain(n, leg.rhoA * h / 420 * heavy) @ ends
            M[0, 0] += inertia
            inner["K"].append(ends.T @ chain(n, leg.EI / h**3 * bend) @ ends)
            inner["M"].append(M)
        inner["K"].append(chain(n, leg.EA / g * np.array([[1, -1], [-1, 1]]))[1:, 1:])
        inner["M"].append(chain(n, leg.rhoA * g / 6 * np.array([[2, 1], [1, 2]]))[1:, 1:])
        tied += [(axis, np.cross(leg.tip - body.com, axis)) for axis in leg.axes().T]
    sizes = [len(K) for K in inner["K"]]
    tips = np.cumsum(sizes) - np.tile([2, 2, 1], len(legs))  # the last deflection of each chain
    loose = np.setdiff1d(np.arange(sum(sizes)), tips)
    T = np.zeros((sum(sizes), len(loose) + 6))
    T[loose, np.arange(len(loose))] = 1
    T[tips, -6:] = [np.concatenate(row) for row in tied]
    M = T.T @ block_diag(*inner["M"]) @ T
    M[-6:, -6:] += block_diag(body.mass * np.eye(3), body.inertia)
    return np.sqrt(eigh(T.T @ block_diag(*inner["K"]) @ T, M, eigvals_only=True)) / (2 * np.pi)


@pytest.mark.parametrize(("name", "pose"), [("preset", HOME), ("no cylinder", HOME), ("unlike", ROLLED)])
def test_count_and_frequencies_of_the_oracle_against_finite_elements(name, pose):
    legs, body = legs_and_body(case(name), pose)
    found = finite_elements(legs, body)[:60]
    # cubic elements raise a frequency by (lam / n)^4 / 1440, lam < 5 pi here, linear ones by (x / n)^2 / 24, x < 1
    gaps = [i for i in range(1, 60) if found[i] > found[i - 1] * 1.01]
    assert len(gaps) > 8
    for i in gaps:
        omega = np.pi * (found[i - 1] + found[i])
        assert dynamic_stiffness.frequency_count(dynamic_stiffness.robot_stiffness(omega, legs, body)) == i
    np.testing.assert_allclose(found[:N], exact(name, pose), rtol=1e-4)  # lam <= 2 pi: 5.2e-5
    assert np.all(found[:N] > exact(name, pose) * (1 - 1e-9))


@pytest.mark.parametrize(
    ("name", "pose"),
    [("preset", HOME), ("preset", ROLLED), ("no cylinder", HOME), ("unlike", ROLLED)],
    ids=["preset-home", "preset-rolled", "no-cylinder-home", "unlike-rolled"],
)
def test_more_lateral_shapes_fall_onto_the_exact_frequencies(name, pose):
    reference = exact(name, pose)
    errors = {k: product(name, pose, k) for k in range(1, 9)}
    errors = {k: f / reference[: len(f)] - 1 for k, f in errors.items()}
    for k in range(1, 8):  # the shapes are nested: each Ritz value falls (Cauchy)
        assert np.all(errors[k + 1][: len(errors[k])] < errors[k] + ROUNDING)
    assert all(np.all(error > -ROUNDING) for error in errors.values())
    for k in range(3, 9):
        bound = missing_polynomials(name, pose, k) + missing_sines(name, reference, 2) + ROUNDING
        assert np.all(errors[k] < bound), f"k = {k}"
    assert errors[3][0] < 1e-7 and errors[6][:17].max() < 1e-6  # the platform's and the first bending frequencies


@pytest.mark.parametrize(("name", "pose"), [("preset", HOME), ("unlike", ROLLED)], ids=["preset", "unlike"])
def test_more_axial_shapes_fall_onto_the_exact_frequencies(name, pose):
    reference, lateral = exact(name, pose), missing_polynomials(name, pose, 6) + ROUNDING
    errors = [product(name, pose, 6, axial) / reference - 1 for axial in (1, 2, 3, 4)]
    for axial, error in enumerate(errors, start=1):
        assert np.all(error < missing_sines(name, reference, axial) + lateral)
        # the same sines in the oracle leave the polynomials alone
        difference = product(name, pose, 6, axial) / exact(name, pose, axial) - 1
        assert np.all((difference > -ROUNDING) & (difference < lateral))
    largest = [error[:17].max() for error in errors]
    assert np.all(np.diff(largest) < 0)
    rest = [np.sum(np.arange(axial, 2000.0) ** -4) for axial in (1, 2, 3, 4)]
    # the mode that strains the bars most: x^4 sum n^-4 / pi^4; the next term is x^2 / pi^2 < 0.4 % of it
    if name == "preset":
        np.testing.assert_allclose(np.array(largest) / largest[0], np.array(rest) / rest[0], rtol=1e-2)


def test_servo_drives_set_the_bars_on_springs():
    stiffness = 2 * case("preset").legs[0].piston.EA / case("preset").legs[0].piston.length
    found = product("preset", HOME, 6, 4, ServoDrive(stiffness=stiffness, damping=0.0))
    reference = exact("preset", HOME, None, 1 / stiffness)
    # inner end and tip both move, 1 : 3, and load the sines by their sum: (4/3)^2 of the rest over 2/3 of the energy
    bound = 8 / 3 * missing_sines("preset", reference, 4) + missing_polynomials("preset", HOME, 6) + ROUNDING
    assert np.all(found / reference - 1 > -ROUNDING)
    assert np.all(found / reference - 1 < bound)
    assert found[0] < 0.9 * exact("preset", HOME)[0]


@pytest.mark.parametrize(("fidelity", "order", "side"), [("beam-fem", 4, 1), ("finite-segment", 2, -1)])
def test_elements_and_segments_reach_the_exact_frequencies_with_their_order(fidelity, order, side):
    robot, reference = case("preset"), exact("preset", HOME)[6:12]  # first bending, hardly coupled with the platform
    found = [modes(robot, HOME, fidelity=fidelity, modes=n)["frequency"].values[6:12] for n in (4, 8)]
    errors = side * (np.array(found) / reference - 1)  # elements are too stiff, segments with hinge springs too soft
    assert np.all(errors > 0) and np.all(errors[1] < 1e-3)
    np.testing.assert_allclose(np.log2(errors[0] / errors[1]), order, atol=0.1)
