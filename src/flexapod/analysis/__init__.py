"""One study in, one Dataset out: simulations, kinematics, modes, checks, storage."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexapod.analysis.checks.checks import check_path
from flexapod.analysis.elastic_parts import parts
from flexapod.analysis.pose_errors import accuracy, play
from flexapod.common.lazy_imports import lazy_attributes

if TYPE_CHECKING:
    from collections.abc import Callable

    from flexapod.analysis.actuator import simulate_actuator
    from flexapod.analysis.error_budget import budget
    from flexapod.analysis.kinematics import forward_kinematics, inverse_dynamics, inverse_kinematics, mobility
    from flexapod.analysis.linear import linearize
    from flexapod.analysis.pose_errors.disturbances import vibration
    from flexapod.analysis.results.summary import summary
    from flexapod.analysis.results.time_history import Interrupted
    from flexapod.analysis.simulation import run, simulate
    from flexapod.analysis.solid import simulate_solid
    from flexapod.analysis.static import modes, stiffness
    from flexapod.analysis.store import open_results, save
    from flexapod.analysis.tool_responses import compliance, transmissibility

_LATER = {  # what not all ask for loads on first use
    "flexapod.analysis.results.time_history": ("Interrupted",),
    "flexapod.analysis.error_budget": ("budget",),
    "flexapod.analysis.tool_responses": ("compliance", "transmissibility"),
    "flexapod.analysis.kinematics": ("forward_kinematics", "inverse_dynamics", "inverse_kinematics", "mobility"),
    "flexapod.analysis.linear": ("linearize",),
    "flexapod.analysis.static": ("modes", "stiffness"),
    "flexapod.analysis.store": ("open_results", "save"),
    "flexapod.analysis.simulation": ("run", "simulate"),
    "flexapod.analysis.actuator": ("simulate_actuator",),
    "flexapod.analysis.solid": ("simulate_solid",),
    "flexapod.analysis.results.summary": ("summary",),
    "flexapod.analysis.pose_errors.disturbances": ("vibration",),
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


__getattr__: Callable[[str], object] = lazy_attributes("flexapod.analysis", _LATER)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
