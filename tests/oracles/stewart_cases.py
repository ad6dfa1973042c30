"""Layouts of Stewart platforms as plain arrays: joint circles; and a difference formula."""

import numpy as np


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
