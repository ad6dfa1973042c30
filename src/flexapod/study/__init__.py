"""Problem to Dataset: simulations, kinematics, modes, checks, storage.

What a simulation does not need (the paper's study, maps, solid elements) loads on first use. A name that is also a
module's (`converge`, `ladder`, `summary`) cannot: importing the module would hide the function.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from flexapod.study.actuator import simulate_actuator
from flexapod.study.checks import check_path
from flexapod.study.converge import converge
from flexapod.study.kinematics import forward_kinematics, inverse_dynamics, inverse_kinematics
from flexapod.study.ladder import ladder
from flexapod.study.record import Interrupted
from flexapod.study.simulation import run, simulate
from flexapod.study.static import modes, stiffness
from flexapod.study.store import open_results, save
from flexapod.study.summary import summary

if TYPE_CHECKING:
    from flexapod.study.map import workspace_map
    from flexapod.study.paper.study import PaperStudy, replicate
    from flexapod.study.solid import simulate_solid

_HOMES = {
    "PaperStudy": "flexapod.study.paper.study",
    "replicate": "flexapod.study.paper.study",
    "simulate_solid": "flexapod.study.solid",
    "workspace_map": "flexapod.study.map",
}

__all__ = [
    "Interrupted",
    "PaperStudy",
    "check_path",
    "converge",
    "forward_kinematics",
    "inverse_dynamics",
    "inverse_kinematics",
    "ladder",
    "modes",
    "open_results",
    "replicate",
    "run",
    "save",
    "simulate",
    "simulate_actuator",
    "simulate_solid",
    "stiffness",
    "summary",
    "workspace_map",
]


def __getattr__(name: str) -> object:
    if name not in _HOMES:
        raise AttributeError(f"module 'flexapod.study' has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(_HOMES[name]), name)
    return value
