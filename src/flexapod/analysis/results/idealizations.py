"""Idealizations of a robot: parts without compliance, their usual values, and drives with compliance."""

from __future__ import annotations

import math
from dataclasses import dataclass

from flexapod.model import Robot

#: Shares of joints, drives and plates in the compliance of a leg, in per cent, by the length of a leg [m] of presets.
MACHINES = {
    "small-hexapod": (0.164, {"joints": 58, "drives": 33, "plates": 5}),
    "machine-hexapod": (0.906, {"joints": 54, "drives": 25, "plates": 11}),
    "motion-base": (2.722, {"joints": 8, "drives": 88, "plates": 0}),
}


@dataclass(frozen=True, kw_only=True)
class Idealization:
    """Kinds of `parts` that do not give way; their `share` [%] in the compliance of a leg of a `machine` as large."""

    parts: tuple[str, ...]
    machine: str
    share: int


def idealization(robot: Robot) -> Idealization | None:
    """Sentence on ideal parts and their compliance in such machines; None where joints and drives are compliant."""
    if robot.platform_fixed:
        return None
    parts = _ideal(robot)
    if not {"joints", "drives"} & set(parts):
        return None
    size = math.log(float(robot.home_lengths.mean()))
    name, (_, shares) = min(MACHINES.items(), key=lambda item: abs(math.log(item[1][0]) - size))
    return Idealization(parts=tuple(parts), machine=name, share=sum(shares[part] for part in parts))


def _ideal(robot: Robot) -> list[str]:
    """Kinds of parts that are rigid in every leg."""
    joints = any(x.stiffness is not None for leg in robot.legs for x in (leg.base_joint, leg.platform_joint))
    drives = any(leg.drive.type != "prescribed" for leg in robot.legs if leg.driven)
    mounts = robot.base_mount is not None or robot.platform_mount is not None
    plates = mounts or any(leg.springs for leg in robot.legs)
    return [name for name, real in (("joints", joints), ("drives", drives), ("plates", plates)) if not real]


def soft_drives(robot: Robot) -> tuple[str, ...]:
    """Kinds of drives that give way; of these modes and stiffness hold the commands still."""
    soft = {leg.drive.type for leg in robot.legs if not leg.drive.holds and getattr(leg.drive, "feedback", True)}
    return tuple(sorted(soft))
