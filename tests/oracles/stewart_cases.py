"""Layouts of Stewart platforms as plain arrays: joint circles and Dietmaier's platform with 40 real postures."""

import numpy as np

# P. Dietmaier, "The Stewart-Gough platform of general geometry can have 40 real postures", Advances in Robot
# Kinematics (1998): base joints, platform joints (in the platform's frame), leg lengths.
DIETMAIER_BASE = np.array(
    [
        [0.0, 0.0, 0.0],
        [1.107915, 0.0, 0.0],
        [0.549094, 0.756063, 0.0],
        [0.735077, -0.223935, 0.525991],
        [0.514188, -0.526063, -0.368418],
        [0.590473, 0.094733, -0.205018],
    ]
)
DIETMAIER_PLATFORM = np.array(
    [
        [0.0, 0.0, 0.0],
        [0.542805, 0.0, 0.0],
        [0.956919, -0.528915, 0.0],
        [0.665885, -0.353482, 1.402538],
        [0.478359, 1.158742, 0.107672],
        [-0.137087, -0.235121, 0.353913],
    ]
)
DIETMAIER_LENGTHS = np.array([1.0, 0.645275, 1.086284, 1.503439, 1.281933, 0.771071])


def on_circle(radius, angles_deg):
    """Points (n, 3) on a circle about the origin, in the plane z = 0."""
    angles = np.deg2rad(angles_deg)
    return radius * np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)


def base_circle(radius, half_angle):
    """Base joints of legs 1 to 6: pairs centred at 0, 120, 240 deg."""
    return on_circle(radius, np.repeat([0.0, 120.0, 240.0], 2) + half_angle * np.array([-1, 1, -1, 1, -1, 1]))


def platform_circle(radius, half_angle):
    """Platform joints of legs 1 to 6: pairs centred at 60, 180, 300 deg, joined crosswise."""
    centres = np.array([-60.0, 60.0, 60.0, 180.0, 180.0, 300.0])
    return on_circle(radius, centres + half_angle * np.array([1, -1, 1, -1, 1, -1]))


def central_difference(f, t, h=1e-3):
    """First derivative by the eighth-order central formula: error h^8 f^(9) / 630 + round-off of about 1e-16 / h."""
    weights = (4 / 5, -1 / 5, 4 / 105, -1 / 280)
    return sum(w * (f(t + k * h) - f(t - k * h)) for k, w in enumerate(weights, start=1)) / h
