"""One study in, one Dataset out: simulations, kinematics, modes, checks, storage."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from flexapod.study.accuracy import accuracy, play
from flexapod.study.actuator import simulate_actuator
from flexapod.study.before.checks import check_path
from flexapod.study.parts import parts
from flexapod.study.record import Interrupted
from flexapod.study.simulation import run, simulate
from flexapod.study.store import open_results, save

if TYPE_CHECKING:
    from flexapod.study.after.summary import summary
    from flexapod.study.budgets import budget
    from flexapod.study.disturbances import vibration
    from flexapod.study.kinematics import forward_kinematics, inverse_dynamics, inverse_kinematics, mobility
    from flexapod.study.solid import simulate_solid
    from flexapod.study.static import modes, stiffness

_LATER = {  # what simulations do without loads on first use
    "budget": "budgets",
    "forward_kinematics": "kinematics",
    "inverse_dynamics": "kinematics",
    "inverse_kinematics": "kinematics",
    "mobility": "kinematics",
    "modes": "static",
    "simulate_solid": "solid",
    "stiffness": "static",
    "summary": "after.summary",
    "vibration": "disturbances",
}

__all__ = [
    "Interrupted",
    "accuracy",
    "budget",
    "check_path",
    "forward_kinematics",
    "inverse_dynamics",
    "inverse_kinematics",
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
    "vibration",
]


def __getattr__(name: str) -> object:
    if name not in _LATER:
        raise AttributeError(f"module 'flexapod.study' has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(f"flexapod.study.{_LATER[name]}"), name)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_LATER})
