"""Known singularities of Stewart platforms: Ma & Angeles 1991 (architecture), Fichter 1986 (yaw of 90 degrees)."""

import numpy as np
import pytest
from tests.oracles.stewart_cases import base_circle, platform_circle

from flexapod.kinematics.jacobian import characteristic_length, dimensionless_jacobian, length_jacobian
from flexapod.kinematics.trajectory import rotation_matrix

pytestmark = pytest.mark.literature

RNG = np.random.default_rng(1991)
POSITIONS = RNG.uniform([-0.2, -0.2, 0.6], [0.2, 0.2, 1.1], (2000, 3))
ROTATIONS = rotation_matrix(RNG.uniform(-0.5, 0.5, (2000, 3)))
ROUND_OFF = 1e-15  # a few units in the last place of the largest singular value, which is about 2


def smallest(base, platform, position=POSITIONS, rotation=ROTATIONS):
    jacobian = dimensionless_jacobian(
        length_jacobian(base, platform, position, rotation), characteristic_length(platform)
    )
    return np.linalg.svd(jacobian, compute_uv=False)[..., -1]


@pytest.mark.parametrize("turn_deg", [0.0, 17.0, 60.0, 133.0])
def test_similar_hexagons_are_singular_everywhere(turn_deg):
    """Base and platform similar, each joint to its own image, in any in-plane rotation."""
    platform = base_circle(0.3, 10) @ rotation_matrix([0, 0, np.deg2rad(turn_deg)]).T
    assert np.max(smallest(base_circle(0.5, 10), platform)) < ROUND_OFF


def test_half_angle_of_11_against_10_degrees_is_nearly_singular_only():
    values = smallest(base_circle(0.5, 10), base_circle(0.3, 11))
    assert np.min(values) > 1e-6
    assert 1e-2 < np.max(values) < 0.1


def test_regular_hexagons_joined_crosswise_are_singular_everywhere():
    assert np.max(smallest(base_circle(0.5, 30), platform_circle(0.3, 30))) < ROUND_OFF


def test_road_to_the_regular_hexagons_is_monotonic_at_home():
    """Half-angles from 5 to 29 degrees: the home pose comes ever nearer to the singular architecture."""
    home = [
        smallest(base_circle(0.25, h), platform_circle(0.15, h), np.array([0, 0, 0.9]), np.eye(3))
        for h in (5, 10, 15, 20, 25, 27, 28, 29)
    ]
    assert np.all(np.diff(home) < 0)
    assert home[-1] < 0.02 < 0.2 < home[0]


def test_standard_layout_is_regular():
    values = smallest(base_circle(0.5, 10), platform_circle(0.3, 10))
    assert np.min(values) > 0.13


def test_similar_hexagons_have_rank_3_at_home():
    """All legs meet in the centre of similarity: six concurrent lines carry forces but no moment about it."""
    jacobian = dimensionless_jacobian(
        length_jacobian(base_circle(0.5, 10), base_circle(0.3, 10), [0, 0, 0.9], np.eye(3)), 0.3
    )
    values = np.linalg.svd(jacobian, compute_uv=False)
    assert np.all(values[:3] > 0.1)
    assert np.all(values[3:] < ROUND_OFF)


@pytest.mark.parametrize("sign", [1, -1])
def test_yaw_of_90_degrees_is_singular(sign):
    def at(yaw_deg):
        turn = rotation_matrix([0, 0, np.deg2rad(sign * yaw_deg)])
        return smallest(base_circle(0.5, 10), platform_circle(0.3, 10), np.array([0, 0, 0.9]), turn)

    assert at(90) < ROUND_OFF
    assert at(89) == pytest.approx(0.0127, rel=0.25)  # height and radii of the published value are not stated
    assert at(89) / at(89.5) == pytest.approx(2.0, rel=2e-3)  # a simple zero: linear in the distance to 1e-3
