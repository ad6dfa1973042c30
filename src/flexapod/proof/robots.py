"""Robots that a case needs and no user would build."""

from __future__ import annotations

import numpy as np

from flexapod import model

__all__ = ["heavy_robot"]

IMMOVABLE = 1e12  # kg, and kg m^2


def heavy_robot(*, mouth: float, mass: float, free: float, diameter: float, E: float, density: float) -> model.Robot:
    """A robot without gravity whose platform cannot move, so that each leg vibrates by itself between its joints.

    Parameters
    ----------
    mouth, mass : float
        Length [m] and mass [kg] of a cylinder, uniform.
    free : float
        Length of the piston [m], all of it outside.
    diameter, E, density : float
        Of the full round piston, SI.
    """
    layout = model.preset("paper-robot")
    robot = layout.robot
    across = np.linalg.norm((robot.base_joints - robot.platform_joints)[:, :2], axis=1)[0]
    leg = robot.legs[0].replace(
        cylinder=model.Cylinder(mass=mass, com=mouth / 2, inertia=mass * mouth**2 / 12, mouth=mouth),
        piston=model.Piston.round(
            length=free,
            section=model.Tube(diameter=diameter),
            material=model.Material(name="given", E=E, density=density),
        ),
        stroke=None,
        damping=0.0,
    )
    payload = robot.payload.replace(mass=IMMOVABLE, inertia=IMMOVABLE * np.eye(3), com=np.zeros(3), tool=np.zeros(3))
    height = float(np.sqrt((mouth + free) ** 2 - across**2))
    return robot.replace(legs=(leg,) * 6, payload=payload, home_height=height, gravity=np.zeros(3))
