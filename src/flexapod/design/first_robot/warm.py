"""Temperatures and tolerances of a first machine: a hall that warms up, and a good shop."""

from __future__ import annotations

from collections.abc import Mapping

from flexapod.common.quantities import number
from flexapod.design.first_robot.study_text import Plan, comment_lines

PLACE, PER_METRE = 5e-6, 12.5e-6  # standard deviation of bored joints: of any plate [m], and by its diameter


def accuracy_tables(plan: Plan, warm: Mapping[str, tuple[float, str]], *, lead: bool) -> list[str]:
    """Temperatures of the base and of parts, `warm` [degC] with their reasons, and tolerances."""
    lines = [f"{f'{part} = {at:g}':<28} # chosen: {why}" for part, (at, why) in warm.items()]
    bored = {"base_joints": plan.joints.base, "platform_joints": plan.joints.platform}
    spread = {name: PLACE + 2 * PER_METRE * radius for name, radius in bored.items()}
    return [
        "[heat]                       # degC; lengths are as drawn at 20",
        "reference = 20",
        "base = 21                    # chosen: stands in a hall that warms up",
        *lines,
        "",
        "[tolerances]                 # as it is made: standard deviations; constant ones go with a calibration",
        *(f'{name} = "{number(1e6 * value, 2)} um"' for name, value in spread.items()),
        *comment_lines(
            "joints: chosen, plates bored on a good machining centre: 5 um and 12.5 um for a metre of diameter"
        ),
        f'leg_offset = "{number(0.5e6 * spread["base_joints"], 2)} um"   # chosen: of length and reference marks',
        *(
            ['lead = "C5"                  # chosen: ground and good rolled screws; THK: 18 um in 300 mm']
            if lead
            else []
        ),
        "",
    ]
