"""flexapod: how far a payload misses its path because the legs bend, stretch and vibrate, and why.

Public names load on first use, so that ``import flexapod`` stays fast.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexapod.common.lazy_imports import load_module

if TYPE_CHECKING:
    from flexapod import analysis as study
    from flexapod import control, kinematics, model
    from flexapod.analysis import (
        accuracy,
        budget,
        compliance,
        forward_kinematics,
        inverse_dynamics,
        inverse_kinematics,
        linearize,
        mobility,
        modes,
        parts,
        play,
        run,
        simulate,
        simulate_actuator,
        simulate_solid,
        stiffness,
        transmissibility,
        vibration,
    )
    from flexapod.commissioning.feedforward import compensate, shape, time_optimal
    from flexapod.common.citations import cite
    from flexapod.common.errors import ComputationError, FlexapodError, InputError
    from flexapod.common.tables.base import Key, Quantity
    from flexapod.common.version import __version__
    from flexapod.control.measurements import read_frf
    from flexapod.design.convergence import converge
    from flexapod.design.convergence.ladder import ladder
    from flexapod.design.maps import workspace_map
    from flexapod.design.stored_study import load
    from flexapod.design.sweeps import sweep
    from flexapod.mechanics.elements.element import Along, Contribution, Element, Output
    from flexapod.mechanics.elements.frames import Energies, Frame
    from flexapod.model import ActuatorStudy, Study, loads, open_values, preset
    from flexapod.output import figures as plot
    from flexapod.output.exchange.formats import export
    from flexapod.verification.paper.study import replicate

_HOMES = {
    "flexapod.mechanics.elements.element": ("Along", "Contribution", "Element", "Output"),
    "flexapod.mechanics.elements.frames": ("Energies", "Frame"),
    "flexapod.common.tables.base": ("Key", "Quantity"),
    "flexapod.common.errors": ("ComputationError", "FlexapodError", "InputError"),
    "flexapod.common.citations": ("cite",),
    "flexapod.control.measurements": ("read_frf",),
    "flexapod.output.exchange.formats": ("export",),
    "flexapod.commissioning.feedforward": ("compensate", "shape", "time_optimal"),
    "flexapod.model": ("ActuatorStudy", "Study", "loads", "open_values", "preset"),
    "flexapod.verification.paper.study": ("replicate",),
    "flexapod.analysis": (
        "accuracy",
        "budget",
        "compliance",
        "forward_kinematics",
        "inverse_dynamics",
        "inverse_kinematics",
        "linearize",
        "mobility",
        "modes",
        "parts",
        "play",
        "run",
        "simulate",
        "simulate_actuator",
        "simulate_solid",
        "stiffness",
        "transmissibility",
        "vibration",
    ),
    "flexapod.design.convergence": ("converge",),
    "flexapod.design.convergence.ladder": ("ladder",),
    "flexapod.design.stored_study": ("load",),
    "flexapod.design.sweeps": ("sweep",),
    "flexapod.design.maps": ("workspace_map",),
    "flexapod.common.version": ("__version__",),
}
_NAMES = {name: module for module, names in _HOMES.items() for name in names}
_FORMER = {"rigid": "kinematics"}  # names of the release before
_PACKAGES = {
    "control": "control",
    "kinematics": "kinematics",
    "model": "model",
    "plot": "output.figures",
    "study": "analysis",
}

__all__ = [
    "ActuatorStudy",
    "Along",
    "ComputationError",
    "Contribution",
    "Element",
    "Energies",
    "FlexapodError",
    "Frame",
    "InputError",
    "Key",
    "Output",
    "Quantity",
    "Study",
    "__version__",
    "accuracy",
    "budget",
    "cite",
    "compensate",
    "compliance",
    "control",
    "converge",
    "export",
    "forward_kinematics",
    "inverse_dynamics",
    "inverse_kinematics",
    "kinematics",
    "ladder",
    "linearize",
    "load",
    "loads",
    "mobility",
    "model",
    "modes",
    "open_values",
    "parts",
    "play",
    "plot",
    "preset",
    "read_frf",
    "replicate",
    "run",
    "shape",
    "simulate",
    "simulate_actuator",
    "simulate_solid",
    "stiffness",
    "study",
    "sweep",
    "time_optimal",
    "transmissibility",
    "vibration",
    "workspace_map",
]


def __getattr__(name: str) -> object:
    if name in _NAMES:
        value = getattr(load_module(_NAMES[name]), name)
    elif name in _PACKAGES:
        value = load_module(f"flexapod.{_PACKAGES[name]}")
    elif name in _FORMER:
        import warnings

        warnings.warn(f"flexapod.{name} is flexapod.{_FORMER[name]} now", FutureWarning, stacklevel=2)
        return load_module(f"flexapod.{_FORMER[name]}")
    else:
        raise AttributeError(f"module 'flexapod' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({name for name in globals() if name.startswith("__")} | {*_NAMES, *_PACKAGES})
