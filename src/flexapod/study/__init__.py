"""Problem to Dataset: simulations, kinematics, modes, checks, storage."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from flexapod.study.actuator import simulate_actuator
    from flexapod.study.checks import check_path
    from flexapod.study.describe import describe
    from flexapod.study.kinematics import forward_kinematics, inverse_dynamics, inverse_kinematics
    from flexapod.study.modal import modes, stiffness
    from flexapod.study.replicate import replicate
    from flexapod.study.simulate import Interrupted, run, simulate
    from flexapod.study.store import export_csv, read, save
    from flexapod.study.summary import summary

_HOMES = {
    "actuator": ("simulate_actuator",),
    "checks": ("check_path",),
    "describe": ("describe",),
    "kinematics": ("forward_kinematics", "inverse_dynamics", "inverse_kinematics"),
    "modal": ("modes", "stiffness"),
    "replicate": ("replicate",),
    "simulate": ("Interrupted", "run", "simulate"),
    "store": ("export_csv", "read", "save"),
    "summary": ("summary",),
}
