"""One study in, one Dataset out: simulations, kinematics, modes, checks, storage."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from flexapod.pose_errors import accuracy, play
from flexapod.review.checks import check_path
from flexapod.study.parts import parts

if TYPE_CHECKING:
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
    "Interrupted": "results.record",
    "budget": "error_budget",
    "compliance": "study.tool_responses",
    "forward_kinematics": "study.kinematics",
    "inverse_dynamics": "study.kinematics",
    "inverse_kinematics": "study.kinematics",
    "linearize": "study.linear",
    "mobility": "study.kinematics",
    "modes": "study.static",
    "open_results": "study.store",
    "run": "study.simulation",
    "save": "study.store",
    "simulate": "study.simulation",
    "simulate_actuator": "study.actuator",
    "simulate_solid": "study.solid",
    "stiffness": "study.static",
    "summary": "results.summary",
    "transmissibility": "study.tool_responses",
    "vibration": "pose_errors.disturbances",
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


def __getattr__(name: str) -> object:
    if name not in _LATER:
        raise AttributeError(f"module 'flexapod.study' has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(f"flexapod.{_LATER[name]}"), name)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_LATER})
