"""Modes of the single actuator at constant length against closed forms: tip body, own weight, damping."""

import numpy as np
import pytest
from tests.oracles import beams

from flexapod.common.errors import ComputationError, InputError
from flexapod.model import Actuator, Simulation, preset
from flexapod.solve.modal.actuator_modes import actuator_modes

pytestmark = pytest.mark.analytic

UNIT = {"length": 1.0, "rhoA": 1.0, "EI": 1.0, "free_length": 1.0}
MASSES = (0.1, 0.5, 1.0, 2.0, 5.0, 10.0)
INERTIAS = (0.01, 0.1, 1.0, 10.0)


def waves(basis, modes, *, rate=0.0, **actuator):
    """W = omega sqrt(rhoA L^4 / EI) of the dimensionless beam."""
    simulation = Simulation(basis=basis, modes=modes)
    return 2 * np.pi * actuator_modes(Actuator(**UNIT | actuator), simulation, rate=rate).frequency


@pytest.mark.parametrize("modes", [1, 3, 6, 12])
def test_cantilever(modes):
    np.testing.assert_allclose(
        waves("clamped-free", modes), beams.beam_roots("clamped", "free", modes) ** 2, rtol=1e-12
    )


def test_table_2_beam():
    study = preset("paper-actuator")
    expected = {3.66: [0.57312, 3.59166, 10.05676], 1.83: [2.29247, 14.36665, 40.22703], 1.0: [7.67724, 48.11247]}
    for length, table in expected.items():
        found = actuator_modes(study.actuator, study.simulation, free_length=length).frequency
        np.testing.assert_allclose(found[: len(table)], table, rtol=0, atol=6e-6)


@pytest.mark.parametrize("mu", MASSES)
def test_tip_mass(mu):
    exact = beams.tip_body_roots(mu, 3) ** 2
    np.testing.assert_allclose(waves("tip-mass", 3, tip_mass=mu), exact, rtol=1e-12)
    three, six = (waves("tip-load", k, tip_mass=mu)[:3] / exact - 1 for k in (3, 6))
    assert abs(three[0]) < 2e-6
    assert abs(six[0]) < 1e-11
    assert 0 < three[1] < 5e-3
    assert 0 < six[1] < 1e-8


@pytest.mark.parametrize("mu", [1.0, 10.0])
def test_eigenfunctions_of_the_bare_beam_converge_slowly_with_a_tip_mass(mu):
    # phi'''(1) = 0 in every shape, EI phi''' = -omega^2 m phi in truth: order k^-3.
    exact = beams.tip_body_roots(mu, 1)[0] ** 2
    errors = np.array([waves("clamped-free", k, tip_mass=mu)[0] / exact - 1 for k in (3, 6, 12)])
    assert 4e-4 < errors[0] < 7e-4
    np.testing.assert_allclose(np.log2(errors[:-1] / errors[1:]), 3.0, atol=0.35)


@pytest.mark.parametrize("inertia", INERTIAS)
def test_tip_body_with_rotary_inertia(inertia):
    exact = beams.tip_body_roots(1.0, 3, inertia) ** 2
    np.testing.assert_allclose(waves("tip-mass", 3, tip_mass=1.0, tip_inertia=inertia), exact, rtol=1e-12)


@pytest.mark.parametrize("inertia", [0.01, 0.1, 1.0, 10.0])
def test_tip_load_shapes_carry_a_moment_to_a_rotary_inertia(inertia):
    # Static shapes under a force and a moment, then under the inertia of the force's shape: the first mode from above.
    exact = beams.tip_body_roots(1.0, 1, inertia)[0] ** 2
    for modes, bound in ((3, 1e-8), (6, 1e-11)):
        assert -1e-11 < waves("tip-load", modes, tip_mass=1.0, tip_inertia=inertia)[0] / exact - 1 < bound


@pytest.mark.parametrize("basis", ["tip-load", "clamped-free"])
def test_a_column_buckles_under_its_own_weight(basis):
    # Greenhill: rhoA g L^3 / EI = 7.837347, the square of 1.5 times the first zero of J_(-1/3)
    critical = 7.837347
    column = {"angle": np.pi / 2}
    assert waves(basis, 6, gravity=critical * 0.9999, **column)[0] < 0.04
    with pytest.raises(ComputationError, match="buckles"):
        waves(basis, 6, gravity=critical * 1.0001, **column)
    hanging = waves(basis, 6, gravity=critical, angle=-np.pi / 2)[0]
    assert hanging > waves(basis, 6)[0]


def test_a_tip_weight_buckles_at_the_euler_load():
    # A heavy point on a light column: m g = pi^2 EI / (4 L^2), here with a beam of a millionth of its mass.
    column = {"angle": np.pi / 2, "tip_mass": 1e6, "rhoA": 1.0}
    critical = np.pi**2 / 4 / (1e6 + 1 / 3)  # the beam's own weight counts a third, to first order
    assert waves("tip-load", 6, gravity=critical * 0.99999, **column)[0] > 0
    with pytest.raises(ComputationError, match="buckles"):
        waves("tip-load", 6, gravity=critical * 1.00001, **column)


def test_damping_ratio_is_the_given_one_for_every_mode():
    simulation = Simulation(basis="clamped-free", modes=6)
    found = actuator_modes(Actuator(**UNIT, damping=0.02), simulation)
    np.testing.assert_allclose(found.damping_ratio, 0.02, rtol=1e-10)


def test_tip_mass_lowers_the_damping_ratio():
    # The damper is the bare beam's: one mode with modal mass m has c / (2 m omega), less than the ratio given.
    light, heavy = (
        actuator_modes(Actuator(**UNIT, damping=0.02, tip_mass=mu), Simulation(basis="tip-load", modes=6))
        for mu in (0.0, 10.0)
    )
    assert light.damping_ratio[0] == pytest.approx(0.02, rel=1e-6)
    assert heavy.damping_ratio[0] < 0.5 * light.damping_ratio[0]


def test_shapes_are_mass_normalised():
    found = actuator_modes(Actuator(**UNIT), Simulation(basis="clamped-free", modes=4))
    np.testing.assert_allclose(np.abs(found.shapes), np.eye(4), atol=1e-12)


def test_a_rigid_beam_has_no_modes():
    with pytest.raises(InputError, match="nothing that could vibrate"):
        actuator_modes(Actuator(**UNIT), Simulation(fidelity="rigid", basis="clamped-free"))
