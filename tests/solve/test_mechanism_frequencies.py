"""Frequencies and stiffness of robots of many kinds: exact dynamic stiffness, and closed forms."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from scipy.linalg import eigh, null_space
from tests.helpers.beam_frames import as_frame
from tests.helpers.chains import NAMED
from tests.helpers.mechanisms import AMPLITUDES, OWN, PISTON, ROBOTS, THREE, built, hexapod, leg, ring, tangents
from tests.helpers.samples import sample_study
from tests.oracles import frames

import flexapod as fx
from flexapod.model.leg.cylinder import Cylinder
from flexapod.model.leg.joint import Joint
from flexapod.model.leg.leg import Leg
from flexapod.model.leg.piston import Piston
from flexapod.model.study.payload import Payload

pytestmark = [pytest.mark.analytic, pytest.mark.usefixtures("uncompiled")]
FOUR = np.arange(4) * 90.0
BARE = {"cylinder": Cylinder(mass=0.0, mouth=0.0), "piston": Piston(length=0.8, EA=1.1e8, EI=5e3, rhoA=4.5)}
PLATE = Payload(mass=500.0, inertia=[40.0, 50.0, 60.0], com=[0.0, 0.0, 0.0])


def table():
    """Four upright legs welded at both ends."""
    return built("4-FPF", ring(0.3, FOUR), ring(0.3, FOUR), 0.8, [leg("FPF", **BARE)] * 4, payload=PLATE)


CASES = {name: make for name, make in ROBOTS.items() if name != "1-UPS"} | {
    "table": table,
    "welded 6-UPF": lambda: hexapod("UPF"),
}


def unloaded(name):
    return CASES[name]().replace(gravity=[0.0, 0.0, 0.0])


@pytest.mark.parametrize("name", CASES)
def test_more_shapes_fall_onto_the_exact_frequencies(name):
    robot = unloaded(name)
    exact = frames.frequencies(*as_frame(robot), 5, digits=1e-10)
    few, many = (fx.modes(robot, modes=k, axial_modes=4)["frequency"].values[:5] / exact - 1 for k in (2, 6))
    # The beams bend once or twice; a polynomial of degree 7 misses that by less than 1e-6 of the frequency.
    assert np.abs(many).max() < 1e-6
    # Ritz: from above; soft motions lose digits to stiff axial ones (1e-16 of the ratio of squares).
    assert few.min() > -1e-9 and many.min() > -1e-9
    assert np.all(many < few + 1e-9)


@pytest.mark.parametrize("name", [name for name in ROBOTS if name not in ("1-UPS", "6-FPF")])
def test_frequencies_away_from_home(name):
    """Where no weight and no weld strains the legs: a pose in all motions that the robot has."""
    robot = unloaded(name)
    pose = {axis: AMPLITUDES[axis] for axis in OWN.get(name, tuple(NAMED))}
    found = fx.modes(robot, pose, modes=6, axial_modes=4)["frequency"].values[:5]
    np.testing.assert_allclose(
        found, frames.frequencies(*as_frame(robot, pose), 5, digits=1e-10), rtol=1e-6
    )  # as at home


def test_a_table_sways_with_twelve_EI_a_leg():
    K, s, EI = fx.stiffness(table().replace(gravity=[0, 0, 0]), modes=2)["stiffness"].values, 0.8, 5e3
    GJ = BARE["piston"].torsional_stiffness
    np.testing.assert_allclose(np.diag(K)[:3], [48 * EI / s**3, 48 * EI / s**3, 4 * 1.1e8 / s], rtol=1e-10)
    assert K[5, 5] == pytest.approx(4 * (GJ / s + 12 * EI / s**3 * 0.3**2), rel=1e-10)


def test_flexures_with_six_rows_are_springs_in_series_with_the_beam():
    """At the tip of a cantilever: s/EA + 1/kz along it; its flexibility to a force and a moment plus theirs across."""
    k = np.array([2e6, 3e6, 4e6, 50.0, 60.0, 70.0])
    legs = [Leg(chain="FPF", platform_joint=Joint(stiffness=np.diag(k)), **BARE)] * 4
    robot = built("4-FPF", ring(0.3, FOUR), ring(0.3, FOUR), 0.8, legs, payload=PLATE).replace(gravity=[0, 0, 0])
    K, EI, s = fx.stiffness(robot, modes=2)["stiffness"].values, 5e3, 0.8
    beam = np.array([[s**3 / 3, s**2 / 2], [s**2 / 2, s]]) / EI
    for axis, across in ((0, 4), (1, 3)):  # a push along x bends about y
        soft = beam + np.diag([1 / k[axis], 1 / k[across]])
        assert K[axis, axis] == pytest.approx(4 * np.linalg.inv(soft)[0, 0], rel=1e-9)
    assert K[2, 2] == pytest.approx(4 / (s / 1.1e8 + 1 / k[2]), rel=1e-9)


def test_closed_forms_of_a_tripod():
    """kx = 3/2 (k cg^2 + kb), kz = 3 k sg^2, tilt 3/2 k r^2 sg^2, yaw 3 kb r^2, x with pitch -3/2 k r sg cg."""
    axes, r, height = tangents(THREE), 0.2, 0.6
    load = Payload(mass=50.0, inertia=[2.0, 2.0, 3.0], com=[0.0, 0.0, 0.0])
    legs = [leg("RPS", axis, cylinder=Cylinder(mass=3.0, com=0.1, inertia=0.02, mouth=0.25)) for axis in axes]
    robot = built("3-RPS", ring(0.35, THREE), ring(r, THREE), height, legs, payload=load).replace(gravity=[0, 0, 0])
    K, span = fx.stiffness(robot, modes=2)["stiffness"].values, np.hypot(0.15, height)
    k = PISTON.EA / PISTON.length
    # the cylinder turns in the plane of the leg, and holds the piston's bending across it
    kb, sg, cg = 3 * PISTON.EI / (span - 0.25) ** 3, height / span, 0.15 / span
    assert K[0, 0] == pytest.approx(1.5 * (k * cg**2 + kb), rel=1e-10)
    assert K[2, 2] == pytest.approx(3 * k * sg**2, rel=1e-10)
    assert K[3, 3] == pytest.approx(1.5 * k * r**2 * sg**2, rel=1e-10)
    assert K[5, 5] == pytest.approx(3 * kb * r**2, rel=1e-10)
    assert abs(K[0, 4]) == pytest.approx(1.5 * k * r * sg * cg, rel=1e-10)


def test_struts_of_the_planar_sample_are_beams_between_pins():
    """Modes 4 to 6, two half-waves, are off by what polynomials of that parity leave out, at k = 6 still 2.3e-5."""
    robot = sample_study("planar").robot
    exact = frames.frequencies(*as_frame(robot), 6, digits=1e-10)
    for k in (6, 7):
        found = fx.modes(robot, modes=k)["frequency"].values[:6] / exact - 1
        one, two = (pinned_beam(k)[i] for i in (0, 1))
        # the platform, 150 times as heavy as a strut, takes part in them by a hundredth
        np.testing.assert_allclose(found[:3], one, rtol=0.05, atol=1e-10)
        np.testing.assert_allclose(found[3:], two, rtol=0.01)


def pinned_beam(k):
    """Errors of a beam with pinned ends by Ritz: polynomials of degree k + 2 without moment at the far end."""
    powers = [Polynomial([0, 1]) * Polynomial([1, -1]) * Polynomial([-1, 2]) ** i for i in range(k + 1)]
    M, K = (
        np.array(
            [
                [(p.deriv(n) * q.deriv(n)).integ()(1) - (p.deriv(n) * q.deriv(n)).integ()(0) for q in powers]
                for p in powers
            ]
        )
        for n in (0, 2)
    )
    Z = null_space(np.array([[p.deriv(2)(1) for p in powers]]))
    found = np.sqrt(eigh(Z.T @ K @ Z, Z.T @ M @ Z, eigvals_only=True)[:3])
    return found / (np.pi * np.arange(1, 4)) ** 2 - 1
