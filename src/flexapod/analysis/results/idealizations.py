"""What of a robot is ideal, what such parts are in machines of its size, and what modes and stiffness hold still."""

from __future__ import annotations

import math

from flexapod.model import Robot

#: Shares of joints, drives and plates in the compliance of a leg, in per cent, by the length of a leg [m] of presets.
MACHINES = {
    "small-hexapod": (0.164, {"joints": 58, "drives": 33, "plates": 5}),
    "machine-hexapod": (0.906, {"joints": 54, "drives": 25, "plates": 11}),
    "motion-base": (2.722, {"joints": 8, "drives": 88, "plates": 0}),
}


def ideal_words(robot: Robot) -> str | None:
    """Which parts do not give way, and how much they do in a machine of this size; None where joints and drives do."""
    if robot.platform_fixed:
        return None
    parts = _ideal(robot)
    if not {"joints", "drives"} & set(parts):
        return None
    size = math.log(float(robot.home_lengths.mean()))
    name, (_, shares) = min(MACHINES.items(), key=lambda item: abs(math.log(item[1][0]) - size))
    share = sum(shares[part] for part in parts)
    miss = " and most of its miss" if share > 50 else ""
    return (
        f"Ideal, without give: {', '.join(parts)}; in {name}, a machine of this size, they make {share} % of a leg's "
        f"compliance{miss} (docs/real-machines.md)."
    )


def _ideal(robot: Robot) -> list[str]:
    """Kinds of parts that do not give way in any leg."""
    joints = any(x.stiffness is not None for leg in robot.legs for x in (leg.base_joint, leg.platform_joint))
    drives = any(leg.drive.type != "prescribed" for leg in robot.legs if leg.driven)
    mounts = robot.base_mount is not None or robot.platform_mount is not None
    plates = mounts or any(leg.springs for leg in robot.legs)
    return [name for name, real in (("joints", joints), ("drives", drives), ("plates", plates)) if not real]


def held(robot: Robot) -> str:
    """What modes and stiffness hold still: the drives, or their commands where drives give way."""
    soft = {leg.drive.type for leg in robot.legs if not leg.drive.holds and getattr(leg.drive, "feedback", True)}
    if not soft:
        return "Drives locked"
    parts = {
        "servo": "springs and dampers of the servo drives",
        "force": "feedback of the force drives",
        "screw": "loops of the screw drives",
    }
    return f"Commands of the drives held, with the {' and the '.join(parts[kind] for kind in sorted(soft))}"
