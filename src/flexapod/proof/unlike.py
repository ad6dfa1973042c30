"""Robots near the preset that leave out or vary what the preset has: no cylinders, six different legs."""

from __future__ import annotations

from flexapod.model import Leg, Robot

__all__ = ["unlike_legs", "without_cylinders", "without_gravity"]


def without_gravity(robot: Robot) -> Robot:
    """The robot where nothing has weight."""
    return robot.replace(gravity=[0, 0, 0])


def without_cylinders(robot: Robot) -> Robot:
    """The robot with pistons of 1 m that reach from joint to joint."""
    bare = robot.legs[0].cylinder.replace(mouth=0.0, mass=0.0, com=0.0, inertia=0.0)
    rod = robot.legs[0].piston.replace(length=1.0)  # longer than any leg at the poses used: nothing is pulled out
    return robot.replace(legs=[leg.replace(cylinder=bare, piston=rod) for leg in robot.legs])


def unlike_legs(robot: Robot) -> Robot:
    """The robot with legs that differ in all they have, axial inertias and universal joints included."""
    return robot.replace(legs=[_unlike(i, leg) for i, leg in enumerate(robot.legs)])


def _unlike(i: int, leg: Leg) -> Leg:
    rod, cylinder = leg.piston, leg.cylinder
    rod = rod.replace(
        length=rod.length * (1 - 0.03 * i), EI=rod.EI * (1 + 0.3 * i), EA=rod.EA / (1 + i), axial_inertia=2e-3 * i
    )
    cylinder = cylinder.replace(mass=1.0 + i, com=0.1 + 0.02 * i, mouth=0.25 + 0.03 * i, axial_inertia=4e-3 * (i % 3))
    u_axis = [1.0, 0.2 * i, 0.3] if i % 2 else None
    return leg.replace(piston=rod, cylinder=cylinder, u_axis=u_axis)
