"""Quantities in words, as in `flexapod.words`, and what a robot holds still."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexapod.words import Scale, column, number, scale, text

if TYPE_CHECKING:
    from flexapod.model import Robot

__all__ = ["Scale", "column", "held", "number", "scale", "text"]


def held(robot: Robot) -> str:
    """What modes and stiffness hold still: the drives, or their commands where drives give way."""
    soft = {leg.drive.type for leg in robot.legs if getattr(leg.drive, "feedback", True)} - {"prescribed"}
    if not soft:
        return "Drives locked"
    parts = {"servo": "springs and dampers of the servo drives", "force": "feedback of the force drives"}
    return f"Commands of the drives held, with the {' and the '.join(parts[kind] for kind in sorted(soft))}"
