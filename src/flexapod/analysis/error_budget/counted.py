"""What a run counts and a budget does not, and the other way round, a sentence each."""

from __future__ import annotations

from flexapod.analysis.pose_errors.backlash import half_play
from flexapod.model import Robot

__all__ = ["budget_counts", "run_counts"]


def run_counts(robot: Robot) -> str | None:
    """What a run counts, and what it leaves to the budget; None where it leaves nothing."""
    rubs = any(x.friction for leg in robot.legs for x in (leg.base_joint, leg.platform_joint, leg.drive))
    others = {
        "tolerances": robot.tolerances is not None,
        "play": bool(half_play(robot).any()),
        "what friction leaves behind": rubs,
    }
    named = [name for name, there in others.items() if there]
    if not named or robot.platform_fixed:
        return None
    listed = " and ".join(filter(None, (", ".join(named[:-1]), named[-1])))
    warm = "" if robot.heat is None else "warm, "
    return f"Counted: one machine as drawn, {warm}under load and in motion; {listed}: flexapod budget."


def budget_counts(robot: Robot) -> str:
    """What a budget counts, and what it leaves to a run."""
    made = "one machine" if robot.tolerances is None else "all machines made to these tolerances"
    return f"Counted: {made}, at rest; what one of them does on its way: flexapod run."
