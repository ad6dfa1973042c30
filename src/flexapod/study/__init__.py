"""One study in, one Dataset out: simulations, kinematics, modes, checks, storage."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from flexapod.study.accuracy import accuracy, play
from flexapod.study.actuator import simulate_actuator
from flexapod.study.after.summary import summary
from flexapod.study.before.checks import check_path
from flexapod.study.budgets import budget
from flexapod.study.disturbances import vibration
from flexapod.study.kinematics import forward_kinematics, inverse_dynamics, inverse_kinematics, mobility
from flexapod.study.parts import parts
from flexapod.study.record import Interrupted
from flexapod.study.simulation import run, simulate
from flexapod.study.static import modes, stiffness
from flexapod.study.store import open_results, save

if TYPE_CHECKING:
    from flexapod.study.solid import simulate_solid

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
    if name != "simulate_solid":  # solid elements load on first use
        raise AttributeError(f"module 'flexapod.study' has no attribute {name!r}")
    value = globals()[name] = import_module("flexapod.study.solid").simulate_solid
    return value
