"""Strokes, pistons and reachability."""

import numpy as np
import pytest
from tests.oracles.stewart_cases import base_circle, platform_circle

from flexapod.common.errors import InputError
from flexapod.kinematics import workspace
from flexapod.kinematics.workspace import piston_excess, reachable, reachable_map, stroke_excess

pytestmark = pytest.mark.unit

T = np.linspace(0, 1, 11)
LENGTH = np.stack([0.9 + 0.1 * T, 0.9 - 0.1 * T, np.full_like(T, 0.9)], axis=1)
LIMITS = np.array([[0.7, 0.955], [0.85, 1.0], [0.7, 1.0]])


def test_stroke_excess_names_leg_amount_and_times():
    short, long = stroke_excess(T, LENGTH, LIMITS)
    assert (short.leg, long.leg) == (2, 1)
    assert (long.value, long.limit, long.time) == pytest.approx((1.0, 0.955, 1.0))
    assert long.first == pytest.approx(0.6)
    assert "Leg 1 is longer than its stroke allows: length 1.0000 m, limit 0.9550 m (by 45.00 mm at" in long.message


def test_no_excess_within_the_stroke():
    assert stroke_excess(T, LENGTH, np.array([[0.8, 1.0]] * 3)) == []


def test_piston_rules():
    """Free length l - mouth > 0; inner end l - Lp before the mouth; behind the joint is only a warning."""
    mouth, piston = np.array([0.3, 0.85, 0.05]), np.array([0.65, 0.5, 0.95])
    found = {e.leg: e for e in piston_excess(T, LENGTH, mouth, piston)}
    assert {leg: e.kind for leg, e in found.items()} == {
        1: workspace.PULLED_OUT,  # 1.0 > 0.3 + 0.65
        2: workspace.NO_FREE_LENGTH,  # 0.8 < 0.85
        3: workspace.BEHIND_JOINT,  # 0.9 < 0.95
    }
    assert {leg: e.fatal for leg, e in found.items()} == {1: True, 2: True, 3: False}
    assert found[1].message.startswith("Leg 1: the piston is pulled out of its cylinder: length 1.0000 m")


def test_piston_without_cylinder_cannot_be_pulled_out():
    found = piston_excess(T, LENGTH, np.zeros(3), np.full(3, 0.1))
    assert [(e.kind, e.fatal) for e in found] == [(workspace.TOO_SHORT, False)] * 3
    assert piston_excess(T, LENGTH, np.zeros(3), np.full(3, 2.0)) == []


def test_reachable_agrees_with_the_rules():
    mouth, piston = np.full(3, 0.3), np.full(3, 0.68)
    expected = (LENGTH[:, 0] <= 0.955) & (LENGTH[:, 1] >= 0.85) & (LENGTH[:, 0] <= 0.98)
    np.testing.assert_array_equal(reachable(LENGTH, LIMITS, mouth, piston), expected)


def test_map_of_one_leg_length_is_a_spherical_shell():
    """Joints all at the origin: reachable is 0.5 <= |p| <= 1, volume 4/3 pi (1 - 1/8); the grid errs by its surface.

    Cells of 0.04 cut by the two spheres (area 15.7): at most 15.7 * 0.04 / 2, in fact far less by cancellation.
    """
    x = np.linspace(-1.02, 1.02, 52)
    found = reachable_map(np.zeros((6, 3)), np.zeros((6, 3)), np.tile([0.5, 1.0], (6, 1)), x, x, x)
    assert found.volume == pytest.approx(4 / 3 * np.pi * 7 / 8, abs=0.05)
    assert np.all(found.reachable == (found.margin >= 0))


def test_map_margin_is_the_least_distance_to_a_limit():
    base, platform = base_circle(0.25, 10), platform_circle(0.15, 10)
    found = reachable_map(base, platform, np.tile([0.7, 1.05], (6, 1)), 0.0, 0.0, [0.9])
    length = np.linalg.norm(platform + np.array([0, 0, 0.9]) - base, axis=1)
    assert found.margin[0, 0, 0] == pytest.approx(np.min(1.05 - length))
    assert found.volume == 0.0


def test_map_refuses_what_is_not_finite():
    with pytest.raises(InputError, match="finite"):
        reachable_map(np.zeros((6, 3)), np.zeros((6, 3)), LIMITS, [np.nan], 0, 0)


def test_a_leg_as_long_as_its_limit_to_rounding_is_within_it():
    length, mouth, piston = np.full((1, 1), np.nextafter(1.0, 2.0)), np.array([0.4]), np.array([0.6])
    assert piston_excess([0.0], length, mouth, piston) == []
    assert len(piston_excess([0.0], length + 1e-12, mouth, piston)) == 1
