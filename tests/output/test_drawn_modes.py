"""Drawn modes of a single actuator's beam against the clamped-free beam of every textbook."""

import numpy as np
import pytest

import flexapod as fx
from flexapod.output.scene.robot_scene import beam_modes

pytestmark = pytest.mark.analytic

BETA = np.array([1.875104068711961, 4.694091132974174, 7.854757438237613])  # roots of cos b cosh b = -1


def test_frequencies_and_shapes_of_a_clamped_free_beam():
    study = fx.preset("paper-actuator")
    a = study.actuator
    found = beam_modes(study.replace(simulation=study.simulation.replace(modes=3, basis="clamped-free")), 49)
    assert found.free_length == a.free_length
    frequency = BETA**2 / (2 * np.pi) * np.sqrt(a.EI / (a.rhoA * a.free_length**4))
    # The basis is the eigenfunctions themselves: exact but for rounding, which the third mode's cosh(7.9) magnifies.
    assert found.frequency == pytest.approx(frequency, rel=1e-9)
    x = np.linspace(0.0, 1.0, 49)[:, None] * BETA
    ratio = (np.cosh(BETA) + np.cos(BETA)) / (np.sinh(BETA) + np.sin(BETA))
    shape = (np.cosh(x) - np.cos(x) - ratio * (np.sinh(x) - np.sin(x))).T
    # Of all three the tip moves most: the drawn shape is 1 there.
    assert found.shape[..., 2] == pytest.approx(shape / shape[:, -1:], abs=1e-9)
    assert np.abs(found.shape).max(axis=(1, 2)) == pytest.approx(1.0, abs=1e-12)


def test_another_length_and_a_damped_beam():
    study = fx.preset("paper-actuator")
    actuator = study.actuator.replace(free_length=0.5 * study.actuator.free_length, damping=0.01)
    short = beam_modes(study.replace(actuator=actuator), 9)
    assert short.frequency == pytest.approx(4 * beam_modes(study, 9).frequency, rel=1e-9)  # as 1 / length^2
    assert short.damping_ratio[0] == pytest.approx(0.01, rel=1e-6)
