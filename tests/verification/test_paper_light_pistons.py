"""Lighter pistons of the paper's robot: their sections by hand, frequencies and sag of a payload on springs."""

import numpy as np
import pytest
from scipy.linalg import eigh

import flexapod as fx
from flexapod import model
from flexapod.verification.paper import variants
from flexapod.verification.paper.study import STEPS

pytestmark = [pytest.mark.unit, pytest.mark.xdist_group("claims")]


@pytest.fixture(scope="module")
def found():
    return variants.compare(variants.light_pistons(), lambda share: None)


def test_it_is_a_part_of_the_study():
    assert {"light", "printed-lines", "robot-fem"} <= {step.name for step in STEPS}


def test_masses_are_those_of_the_sections(found):
    """750 mm of steel, 7800 kg/m^3: pi / 4 (D^2 - d^2) of it."""
    outer, inner = 1e-3 * found.outer.values, 1e-3 * found.inner.values
    np.testing.assert_allclose(found.piston_mass, 7800 * 0.75 * np.pi / 4 * (outer**2 - inner**2), rtol=1e-12)
    assert found.piston.values[0] == "27 mm" and found.piston.values[3] == "27 mm, 25 mm hollow"


def springs(area):
    """First frequency [Hz] of the payload on massless springs EA / L along the legs."""
    robot = model.preset("paper-robot").robot
    com, up = robot.payload.com, np.array([0, 0, robot.home_height])
    tips = robot.platform_joints + up
    along = tips - robot.base_joints
    along /= np.linalg.norm(along, axis=1)[:, None]
    J = np.hstack([along, np.cross(tips - up - com, along)])
    M = np.diag([robot.payload.mass] * 3 + [17.88] * 3)
    return np.sqrt(eigh(2e11 * area / 0.75 * J.T @ J, M, eigvals_only=True)[0]) / (2 * np.pi)


def test_the_first_frequency_falls_with_the_area(found):
    """The paper's and the hollow ones: 20 kg of pistons on 100 kg lower it, as do thrusts of 6 % of Euler's."""
    for i in range(4):
        outer, inner = 1e-3 * float(found.outer[i]), 1e-3 * float(found.inner[i])
        area = np.pi / 4 * (outer**2 - inner**2)
        assert float(found.lowest_frequency[i]) == pytest.approx(springs(area), rel=0.05)


def test_hollow_and_thin_ones_are_what_they_say():
    study = variants.piston(27.0, 22.0).study
    piston = study.robot.legs[0].piston
    assert piston.EI == pytest.approx(2e11 * np.pi / 64 * (0.027**4 - 0.022**4), rel=1e-12)
    assert piston.EA == pytest.approx(2e11 * np.pi / 4 * (0.027**2 - 0.022**2), rel=1e-12)
    own = variants.piston(27.0, 0.0).study
    assert own.robot.legs[0].piston.EI == pytest.approx(model.preset("paper-robot").robot.legs[0].piston.EI, rel=1e-5)
    assert fx.modes(own).frequency[0] == pytest.approx(
        float(fx.modes(model.preset("paper-robot")).frequency[0]), rel=1e-5
    )
