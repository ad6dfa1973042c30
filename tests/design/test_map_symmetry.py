"""Maps of a robot that is its own mirror image are their own mirror images."""

import numpy as np
import pytest
from tests.helpers.runs import paper_robot

import flexapod as fx
from flexapod.design.maps.findings import SCALARS

pytestmark = pytest.mark.property


@pytest.fixture(scope="module")
def mirrored():
    """The preset with its CoM in the plane y = 0 of its joints' symmetry, over sway and roll."""
    study = paper_robot()
    payload = study.robot.payload.replace(com=[0.1, 0.0, 0.2], tool=[0.05, 0.0, 0.3])
    study = study.replace(robot=study.robot.replace(payload=payload))
    axes = {"sway": np.linspace(-0.4, 0.4, 9), "roll": np.deg2rad(np.linspace(-60, 60, 9))}
    return fx.workspace_map(study, axes, at={"surge": 0.05, "pitch": 0.1}, direction=[1, 0, 1])


def test_mirrored_poses_are_reached_alike(mirrored):
    code = mirrored.reason.values
    assert (code == 0).sum() > 20
    assert (code != 0).sum() > 20
    np.testing.assert_array_equal(code, code[::-1, ::-1])


@pytest.mark.parametrize("name", [*SCALARS, "smallest_singular_value"])
def test_mirrored_poses_have_equal_values(mirrored, name):
    values = mirrored[name].values
    other = values[::-1, ::-1]
    # Equations in another order of the legs: rounding of 1e8 N/m springs against soft directions, 1e-9 at condition 50.
    np.testing.assert_allclose(values, other, rtol=1e-8, atol=1e-12 * np.nanmax(np.abs(values)))


def test_vectors_and_legs_are_mirrored(mirrored):
    legs = np.array([2, 1, 6, 5, 4, 3]) - 1  # across the plane y = 0
    force = mirrored.actuator_force.values
    np.testing.assert_allclose(force, force[::-1, ::-1][..., legs], rtol=1e-8, atol=1e-8 * np.nanmax(np.abs(force)))
    sag = mirrored.static_deviation.values
    np.testing.assert_allclose(sag, sag[::-1, ::-1] * [1, -1, 1], atol=1e-8 * np.nanmax(np.abs(sag)))
