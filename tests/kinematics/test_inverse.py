"""Leg frames, lengths, universal-joint angles and their derivatives."""

import numpy as np
import pytest
from tests.oracles.stewart_cases import base_circle, central_difference, platform_circle

from flexapod.common.errors import InputError
from flexapod.kinematics.inverse import joint_angles, leg_frames, leg_lengths, leg_rotations, leg_state
from flexapod.kinematics.laws import Law
from flexapod.kinematics.trajectory import Poses, poses_from_coordinates

pytestmark = pytest.mark.unit

BASE, PLATFORM, HOME = base_circle(0.25, 10), platform_circle(0.15, 10), 0.9
FRAMES = leg_frames(BASE, PLATFORM + np.array([0, 0, HOME]))
AMPLITUDE, FREQUENCY = np.array([0.05, 0.04, 0.06, 0.3, 0.25, 0.35]), np.array([3.0, 5.0, 4.0, 6.0, 7.0, 4.5])


def path(t):
    angle = np.multiply.outer(t, FREQUENCY) + np.arange(6)
    law = Law(
        AMPLITUDE * np.sin(angle), AMPLITUDE * FREQUENCY * np.cos(angle), -AMPLITUDE * FREQUENCY**2 * np.sin(angle)
    )
    return poses_from_coordinates(Poses.at_rest([0.0, 0.0, HOME], np.eye(3)), law, [0.02, 0.1, 0.3])


@pytest.mark.parametrize(
    ("name", "rate"),
    [
        ("length", "rate"),
        ("rate", "accel"),
        ("alpha", "alpha_dot"),
        ("alpha_dot", "alpha_ddot"),
        ("beta", "beta_dot"),
        ("beta_dot", "beta_ddot"),
    ],
)
def test_rates_are_derivatives(name, rate):
    """Step 2e-3 on frequencies below 30 rad/s: truncation and round-off below 1e-10 of accelerations of order ten."""
    t = np.linspace(0, 2, 101)
    found = getattr(leg_state(BASE, PLATFORM, FRAMES, path(t)), rate)
    slope = central_difference(lambda x: getattr(leg_state(BASE, PLATFORM, FRAMES, path(x)), name), t, h=2e-3)
    np.testing.assert_allclose(found, slope, atol=1e-9 * max(1, np.max(np.abs(found))))


def test_angles_are_zero_at_home_and_frames_are_those_of_the_convention():
    state = leg_state(BASE, PLATFORM, FRAMES, Poses.at_rest([0, 0, HOME], np.eye(3)))
    assert np.max(np.abs([state.alpha, state.beta])) < 1e-15
    x, y, z = np.moveaxis(FRAMES, -1, 0)
    s = PLATFORM + np.array([0, 0, HOME]) - BASE
    np.testing.assert_allclose(z * state.length.T, s, atol=1e-15)
    assert np.max(np.abs(x[:, 2])) < 1e-15  # Z x z_i is horizontal
    np.testing.assert_allclose(np.cross(z, x), y, atol=1e-15)
    np.testing.assert_allclose(np.cross([0, 0, 1], z), x * np.linalg.norm(z[:, :2], axis=1)[:, None], atol=1e-15)


def test_vertical_leg_takes_the_world_x_axis():
    np.testing.assert_array_equal(leg_frames([[0.1, 0.2, 0]], [[0.1, 0.2, 1]]), [np.eye(3)])


def test_u_axis_is_made_normal_to_the_leg():
    frame = leg_frames([[0, 0, 0]], [[0, 0, 1]], [[0, 2, 5]])[0]
    np.testing.assert_allclose(frame[:, 0], [0, 1, 0])
    with pytest.raises(InputError, match="leg 1: u_axis"):
        leg_frames([[0, 0, 0]], [[0, 0, 1]], [[0, 0, 2]])


def test_leg_points_along_its_direction():
    rng = np.random.default_rng(3)
    d = rng.normal(size=(50, 6, 3))
    d /= np.linalg.norm(d, axis=-1, keepdims=True)
    alpha, beta = joint_angles(FRAMES, d)
    r = leg_rotations(FRAMES, alpha, beta)
    np.testing.assert_allclose(r[..., 2], d, atol=1e-14)
    np.testing.assert_allclose(r @ np.swapaxes(r, -1, -2), np.broadcast_to(np.eye(3), r.shape), atol=1e-14)
    np.testing.assert_allclose(np.einsum("ni,tni->tn", FRAMES[..., 0], r[..., 1]), 0, atol=1e-14)  # second axis turns


def test_lengths_broadcast_over_any_grid():
    lengths = leg_lengths(BASE, PLATFORM, np.zeros((4, 5, 3)) + np.array([0, 0, HOME]), np.eye(3))
    home = np.linalg.norm(PLATFORM + np.array([0, 0, HOME]) - BASE, axis=1)
    np.testing.assert_allclose(lengths, np.broadcast_to(home, (4, 5, 6)))


def test_folded_universal_joint_is_refused():
    """With the first axis of the joint 6 deg from the leg's direction at the end, beta is 84 deg; 4 deg is refused."""
    base, platform = np.zeros((1, 3)), np.zeros((1, 3))
    frames = leg_frames(base, [[0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0]])

    def at(angle):
        a = np.deg2rad(angle)
        return leg_state(base, platform, frames, Poses.at_rest([np.sin(a), 0.0, np.cos(a)], np.eye(3)))

    assert np.rad2deg(at(84.0).beta[0, 0]) == pytest.approx(84.0)
    with pytest.raises(InputError, match=r"leg 1.*beta = 86.0 deg"):
        at(86.0)


def test_leg_without_length_is_refused():
    with pytest.raises(InputError, match="no length"):
        leg_state(BASE, PLATFORM, FRAMES, Poses.at_rest(BASE[2] - PLATFORM[2], np.eye(3)))
