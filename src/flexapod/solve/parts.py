"""How stiff every part along every leg is at given lengths, Eq. (T15.3)."""

from __future__ import annotations

import numpy as np

from flexapod.model import ForceDrive, Leg, Robot, ServoDrive
from flexapod.solve.springs import Spring, before_piston, of_servo, springs_along
from flexapod.typing import Array

__all__ = ["part_stiffness"]


def part_stiffness(robot: Robot, length: Array) -> dict[str, Array]:
    """Stiffness along the legs of every part, (..., legs) [N/m], by name; infinite where a leg does not have it.

    Parameters
    ----------
    robot : Robot
    length : ndarray, shape (..., legs)
        Of the rigid legs [m]; the shaft of a screw depends on it.
    """
    found: dict[str, Array] = {}
    for i, leg in enumerate(robot.legs):
        for spring in _all(leg):
            of_part = found.setdefault(spring.name, np.full(length.shape, np.inf))
            of_part[..., i] = 1.0 / spring.at_length(length[..., i])
    return found


def _all(leg: Leg) -> list[Spring]:
    """The springs along a leg, its piston's stretch and its drive's position among them."""
    piston = Spring(name="piston", at="nut", compliance=(leg.piston.length / leg.piston.EA, 0.0, 0.0))
    drive = [spring for spring in before_piston(leg) if spring.name == "drive" and leg.driven == "stroke"]
    if isinstance(leg.drive, ForceDrive) and leg.driven == "stroke" and not leg.drive.pushes:
        drive = [of_servo(ServoDrive(stiffness=leg.drive.feedback.stiffness))]  # type: ignore[union-attr]
    return [piston, *springs_along(leg), *drive]
