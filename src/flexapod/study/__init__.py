"""One study in, one Dataset out: simulations, kinematics, modes, checks, storage."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexapod.pose_errors import accuracy, play
from flexapod.review.checks import check_path
from flexapod.runtime.loading import later
from flexapod.study.parts import parts

if TYPE_CHECKING:
    from collections.abc import Callable

    from flexapod.error_budget import budget
    from flexapod.pose_errors.disturbances import vibration
    from flexapod.results.record import Interrupted
    from flexapod.results.summary import summary
    from flexapod.study.actuator import simulate_actuator
    from flexapod.study.kinematics import forward_kinematics, inverse_dynamics, inverse_kinematics, mobility
    from flexapod.study.linear import linearize
    from flexapod.study.simulation import run, simulate
    from flexapod.study.solid import simulate_solid
    from flexapod.study.static import modes, stiffness
    from flexapod.study.store import open_results, save
    from flexapod.study.tool_responses import compliance, transmissibility

_LATER = {  # what not all ask for loads on first use
    "flexapod.results.record": ("Interrupted",),
    "flexapod.error_budget": ("budget",),
    "flexapod.study.tool_responses": ("compliance", "transmissibility"),
    "flexapod.study.kinematics": ("forward_kinematics", "inverse_dynamics", "inverse_kinematics", "mobility"),
    "flexapod.study.linear": ("linearize",),
    "flexapod.study.static": ("modes", "stiffness"),
    "flexapod.study.store": ("open_results", "save"),
    "flexapod.study.simulation": ("run", "simulate"),
    "flexapod.study.actuator": ("simulate_actuator",),
    "flexapod.study.solid": ("simulate_solid",),
    "flexapod.results.summary": ("summary",),
    "flexapod.pose_errors.disturbances": ("vibration",),
}

__all__ = [
    "Interrupted",
    "accuracy",
    "budget",
    "check_path",
    "compliance",
    "forward_kinematics",
    "inverse_dynamics",
    "inverse_kinematics",
    "linearize",
    "mobility",
    "modes",
    "open_results",
    "parts",
    "play",
    "run",
    "save",
    "simulate",
    "simulate_actuator",
    "simulate_solid",
    "stiffness",
    "summary",
    "transmissibility",
    "vibration",
]


__getattr__: Callable[[str], object] = later("flexapod.study", _LATER)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
