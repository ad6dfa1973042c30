"""The linear model of a single actuator: closed forms of its zeros, modes, and beams that turn."""

import numpy as np
import pytest
from scipy.optimize import brentq

import flexapod as fx
from flexapod import model
from flexapod.solve.modal.actuator_modes import actuator_modes, stretching_lag

pytestmark = pytest.mark.analytic


def beam(*, hub=0.5, modes=6, basis="tip-load", space=False, **more):
    """A beam that hinges in its hub, without weight."""
    part = {"GJ": 60.0, "EA": 2e6, "axial_inertia": 1e-4, "hub_axial_inertia": 0.01, "axial_modes": 3} if space else {}
    actuator = model.Actuator(
        rhoA=1.2, EI=200.0, length=2.0, free_length=2.0, hub_radius=0.0, hub_inertia=hub, gravity=0.0, damping=0.0,
        space=space, **part, **more,
    )  # fmt: skip
    simulation = model.Simulation(modes=modes, basis=basis, duration=1.0)
    return model.ActuatorStudy(actuator=actuator, simulation=simulation)


def root(k):
    """Roots of tan a + tanh a = 0."""
    return brentq(lambda a: np.sin(a) * np.cosh(a) + np.cos(a) * np.sinh(a), (k + 0.5) * np.pi, (k + 1.0) * np.pi)


@pytest.mark.parametrize("hub", [0.05, 0.5, 20.0])
def test_zeros_from_the_torque_to_the_tip(hub):
    # hinged-free beam seen at its tip: s = +-2 a^2 sqrt(EI / (m L^4)), whatever the hub; six shapes have the first
    # to 1e-6, the second to 1e-4
    given = beam(hub=hub)
    lin = fx.linearize(given, inputs="drive:rotation", outputs="tip:rotation", drives="force")
    zeros = lin.zeros("drive:rotation", "tip:rotation")
    real = np.sort(zeros.real[np.abs(zeros.imag) < 1e-6 * np.abs(zeros)])
    scale = np.sqrt(200.0 / (1.2 * 2.0**4))
    for k, close in ((0, 1e-5), (1, 1e-3)):
        expected = 2 * root(k) ** 2 * scale
        for sign in (1, -1):
            assert np.abs(real - sign * expected).min() < close * expected


@pytest.mark.parametrize("name", ["paper-actuator", "beam", "space"])
def test_poles_are_those_of_modes(name):
    given = fx.preset(name) if name == "paper-actuator" else beam(space=name == "space")
    given = given.replace(actuator=given.actuator.replace(gravity=0.0, damping=0.01))
    found = fx.linearize(given, inputs="force:tip", outputs="tip").damp()
    modes = fx.modes(given)
    for f, ratio in zip(modes.frequency.values, modes.damping_ratio.values, strict=True):
        k = np.abs(found.frequency.values / f - 1 + 1e-3j * (found.damping_ratio.values - ratio)).argmin()
        assert found.frequency.values[k] == pytest.approx(f, rel=1e-4)  # damped beside undamped
    lossless = given.replace(actuator=given.actuator.replace(damping=0.0))
    found = np.sort(np.abs(fx.linearize(lossless, inputs="force:tip", outputs="tip").poles()))[::2] / (2 * np.pi)
    assert found == pytest.approx(np.sort(fx.modes(lossless).frequency.values), rel=1e-9)


@pytest.mark.parametrize("rate", [5.0, 40.0])
def test_steady_rotation(rate):
    # lag: the frequencies of modes, which know centrifugal terms; stretch and lag of one in space by Coriolis forces
    given = beam()
    found = np.sort(np.abs(fx.linearize(given, {"rate": rate}, inputs="force:tip", outputs="tip").poles().imag))[::2]
    modes = actuator_modes(given.actuator, given.simulation, rate=rate).frequency
    assert found == pytest.approx(2 * np.pi * np.sort(modes), rel=1e-8)
    given = beam(space=True, modes=4)
    poles = fx.linearize(given, {"rate": rate}, inputs="force:tip", outputs="tip").poles()
    for omega in stretching_lag(given.actuator, given.simulation, rate)[:6]:
        if omega:
            assert np.abs(poles - 1j * omega).min() < 1e-7 * omega


def test_a_rotation_that_is_told_bends_the_beam_as_its_inertia_says():
    # told a slow angular acceleration of 1 rad/s^2 the beam lags by the bending of a load rho A x along it, 11 rho A
    # L^5 / 120 EI at its tip; the torque is the whole inertia
    lin = fx.linearize(
        beam(), inputs="command:rotation", outputs=["tip:rotation", "drive-force:rotation", "stroke:rotation"]
    )
    hz = 1e-3
    s = 2j * np.pi * hz
    H = lin.at([hz])[:, 0, 0]
    bent = (H[0] - 2.0 * H[2]).real
    assert bent == pytest.approx(-11 * 1.2 * 2.0**5 / (120 * 200.0), rel=1e-5)
    assert H[1].real == pytest.approx(0.5 + 1.2 * 2.0**3 / 3, rel=1e-5)
    assert (H[2] * s**2).real == pytest.approx(1.0, rel=1e-12)


def test_channels_are_refused_with_the_nearest():
    with pytest.raises(fx.InputError, match="Did you mean 'command:rotation'"):
        fx.linearize(beam(), inputs="command:rotatoin", outputs="tip")
    with pytest.raises(fx.InputError, match="rate"):
        fx.linearize(beam(), {"heave": 1.0}, inputs="force", outputs="tip")


@pytest.mark.parametrize("turned", [{}, {"angle": 0.7}, {"space": True, "angle": -0.4, "elevation": 0.3}])
def test_a_force_along_the_beam_stretches_nothing_that_is_held_and_bends_nothing(turned):
    """Wherever it points: along it the tip moves as the motor extends, across as a cantilever, by L^3 / 3 EI."""
    lin = fx.linearize(beam(**turned), inputs=["command:extension", "force:tip:along", "force:tip:rotation"],
                       outputs=["tip", "drive-force"])  # fmt: skip
    H = dict(zip(lin.outputs, lin.at([1e-2])[:, :, 0].real, strict=True))
    stretch = 2.0 / 2e6 if "space" in turned else 0.0  # by the force along
    bent = 2.0**3 / (3 * 200.0)
    assert H["tip:along"][1:] == pytest.approx([stretch, 0.0], abs=1e-6 * bent)
    assert -((2 * np.pi * 1e-2) ** 2) * H["tip:along"][0] == pytest.approx(1.0, rel=1e-6)
    # (f / 3 Hz)^2 = 1e-5 of the first bending mode; shapes of six polynomials hold a force at the tip exactly
    assert H["tip:rotation"] == pytest.approx([0.0, 0.0, bent], abs=3e-5 * bent)
    assert H["drive-force:extension"] == pytest.approx([1.2 * 2.0, -1.0, 0.0], abs=1e-4)
    assert H["drive-force:rotation"][2] == pytest.approx(-2.0 * np.cos(turned.get("elevation", 0.0)), rel=1e-4)


def test_a_beam_that_turns_has_no_weight():
    """In steady rotation weight would come and go with each turn: heavy or not, poles are the same."""
    heavy = beam(hub=0.5)
    heavy = heavy.replace(actuator=heavy.actuator.replace(gravity=9.81, angle=0.3))
    found, light = (
        np.sort_complex(fx.linearize(x, {"rate": 12.0}, inputs="force:tip", outputs="tip").poles())
        for x in (heavy, beam())
    )
    assert found == pytest.approx(light, rel=1e-9)
    still = np.sort(np.abs(fx.linearize(heavy, inputs="force:tip", outputs="tip").poles()))
    assert np.abs(still / np.sort(np.abs(light)) - 1).max() > 1e-3
