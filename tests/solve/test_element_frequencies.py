"""Frequencies of beam elements and of hinged segments: cantilever, leg between ideal joints, orders of convergence."""

import numpy as np
import pytest
from tests.helpers.one_leg import LEGS, PISTON, hertz, squared_frequencies
from tests.oracles import beams

from flexapod.common.errors import InputError
from flexapod.model import Actuator, Simulation
from flexapod.solve.modal.actuator_modes import actuator_modes

pytestmark = pytest.mark.analytic

CANTILEVER = beams.beam_roots("clamped", "free", 3)


def cantilever(fidelity, modes, **actuator):
    """W = omega sqrt(rhoA L^4 / EI), up to three of them."""
    unit = {"length": 1.0, "rhoA": 1.0, "EI": 1.0, "free_length": 1.0}
    found = actuator_modes(Actuator(**unit | actuator), Simulation(fidelity=fidelity, modes=modes))
    return 2 * np.pi * found.frequency[:3]


def cubic_error(wave, elements):
    """Leading error of a frequency with cubic elements: omega^2 is high by (lam / n)^4 / 720, lam the wave number."""
    return (wave / elements) ** 4 / 1440


@pytest.mark.parametrize("elements", [3, 4, 6])
def test_cantilever_of_beam_elements(elements):
    # Ritz values lie above; a clamped or free end, where the wave decays instead of turning, takes some of the error.
    errors = cantilever("beam-fem", 2 * elements) / CANTILEVER**2 - 1
    bound = cubic_error(CANTILEVER, elements)
    fine = CANTILEVER / elements < 2.0  # elements per wave at which the leading term leads
    assert fine[:2].any()
    assert (errors[fine] > 0.7 * bound[fine]).all()
    assert (errors[fine] < bound[fine]).all()


def test_beam_elements_converge_with_order_four():
    three, six = (cantilever("beam-fem", k)[0] / CANTILEVER[0] ** 2 - 1 for k in (6, 12))
    assert np.log2(three / six) == pytest.approx(4, abs=0.1)
    assert six == pytest.approx(cubic_error(CANTILEVER[0], 6), rel=0.02)


def test_segments_converge_with_order_two():
    errors = np.array([cantilever("finite-segment", n) / CANTILEVER**2 - 1 for n in (6, 12)])
    np.testing.assert_allclose(np.log2(errors[0] / errors[1]), 2, atol=0.1)


@pytest.mark.parametrize("mu", [0.1, 1.0, 10.0])
def test_elements_carry_a_tip_body(mu):
    # With rotary inertia the tip has curvature, which cubics have too: order four remains.
    exact = beams.tip_body_roots(mu, 1, 0.1)
    errors = [cantilever("beam-fem", k, tip_mass=mu, tip_inertia=0.1)[0] / exact[0] ** 2 - 1 for k in (6, 12)]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4, abs=0.1)
    assert 0 < errors[1] < cubic_error(exact[0], 6)


@pytest.mark.parametrize(("mouth", "mass", "free", "table"), LEGS)
def test_leg_of_beam_elements(mouth, mass, free, table):
    waves = (2 * np.pi * np.array(table)) ** 0.5 * (PISTON["rhoA"] / PISTON["EI"]) ** 0.25 * free
    leg = {"mouth": mouth, "mass": mass, "free": free, "basis": "hermite"}
    coarse, fine = (hertz(squared_frequencies(k, **leg))[::2][: len(table)] / table - 1 for k in (6, 12))
    assert (fine > 0).all()
    assert (fine < cubic_error(waves, 6)).all()
    assert np.log2(coarse[0] / fine[0]) == pytest.approx(4, abs=0.1)


@pytest.mark.parametrize(("mouth", "mass", "free", "table"), LEGS)
def test_leg_of_segments(mouth, mass, free, table):
    # Errors of the first mode change their sign with the cylinder, so that the order is taken from the second.
    leg = {"mouth": mouth, "mass": mass, "free": free, "basis": "segments"}
    coarse, fine = (hertz(squared_frequencies(n, **leg))[::2][: len(table)] / table - 1 for n in (6, 12))
    assert np.log2(coarse[1] / fine[1]) == pytest.approx(2, abs=0.15)
    assert abs(fine[0]) < 5e-4


def test_every_mode_has_the_given_damping():
    beam = Actuator(length=1.0, rhoA=1.0, EI=1.0, free_length=1.0, damping=0.02)
    for fidelity in ("finite-segment", "beam-fem"):
        found = actuator_modes(beam, Simulation(fidelity=fidelity, modes=6))
        np.testing.assert_allclose(found.damping_ratio, 0.02, rtol=1e-9)


def test_half_an_element_is_refused():
    with pytest.raises(InputError, match="beam elements") as error:
        Simulation(fidelity="beam-fem", modes=3)
    assert error.value.key == "modes"
