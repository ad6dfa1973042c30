"""flexapod: how far a payload misses its path because the legs bend, stretch and vibrate, and why.

Public names load on first use, so that ``import flexapod`` stays fast.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexapod.runtime.loading import loaded

if TYPE_CHECKING:
    from flexapod import control, kinematics, model, plot, study
    from flexapod.citations import cite
    from flexapod.control.measured import read_frf
    from flexapod.elements.element import Along, Contribution, Element, Output
    from flexapod.elements.frame import Energies, Frame
    from flexapod.errors import ComputationError, FlexapodError, InputError
    from flexapod.exchange.formats import export
    from flexapod.feedforward import compensate, shape, time_optimal
    from flexapod.model import ActuatorStudy, Study, loads, open_values, preset
    from flexapod.paper.study import replicate
    from flexapod.schema.base import Key, Quantity
    from flexapod.study import (
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
    from flexapod.surveys.convergence import converge
    from flexapod.surveys.convergence.ladder import ladder
    from flexapod.surveys.stored_study import load
    from flexapod.surveys.sweeps import sweep
    from flexapod.surveys.workspace import workspace_map
    from flexapod.version import __version__

_HOMES = {
    "flexapod.elements.element": ("Along", "Contribution", "Element", "Output"),
    "flexapod.elements.frame": ("Energies", "Frame"),
    "flexapod.schema.base": ("Key", "Quantity"),
    "flexapod.errors": ("ComputationError", "FlexapodError", "InputError"),
    "flexapod.citations": ("cite",),
    "flexapod.control.measured": ("read_frf",),
    "flexapod.exchange.formats": ("export",),
    "flexapod.feedforward": ("compensate", "shape", "time_optimal"),
    "flexapod.model": ("ActuatorStudy", "Study", "loads", "open_values", "preset"),
    "flexapod.paper.study": ("replicate",),
    "flexapod.study": (
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
    "flexapod.surveys.convergence": ("converge",),
    "flexapod.surveys.convergence.ladder": ("ladder",),
    "flexapod.surveys.stored_study": ("load",),
    "flexapod.surveys.sweeps": ("sweep",),
    "flexapod.surveys.workspace": ("workspace_map",),
    "flexapod.version": ("__version__",),
}
_NAMES = {name: module for module, names in _HOMES.items() for name in names}
_FORMER = {"rigid": "kinematics"}  # names of the release before
_PACKAGES = ("control", "kinematics", "model", "plot", "study")

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
        value = getattr(loaded(_NAMES[name]), name)
    elif name in _PACKAGES:
        value = loaded(f"flexapod.{name}")
    elif name in _FORMER:
        import warnings

        warnings.warn(f"flexapod.{name} is flexapod.{_FORMER[name]} now", FutureWarning, stacklevel=2)
        return loaded(f"flexapod.{_FORMER[name]}")
    else:
        raise AttributeError(f"module 'flexapod' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({name for name in globals() if name.startswith("__")} | {*_NAMES, *_PACKAGES})
