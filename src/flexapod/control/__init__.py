"""Linear systems with named channels, and loops around them: they take any state space, robots or not.

Public names load on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexapod.runtime.loading import loaded

if TYPE_CHECKING:
    from flexapod.control.adaptive import AdaptiveDamping, Tracker
    from flexapod.control.closing import DelayedLoop
    from flexapod.control.controllers import DVF, IFF, PID, Controller, Decentralised, Decoupled, Fused, Together
    from flexapod.control.decoupling import (
        Decoupling,
        by_jacobian,
        by_modes,
        by_singular_vectors,
        centre_of_stiffness,
        robot_jacobian,
    )
    from flexapod.control.function import Function
    from flexapod.control.impedances import impedance
    from flexapod.control.laws import (
        ControlLaw,
        complementary,
        gain,
        high_pass,
        integrator,
        lead,
        low_pass,
        notch,
        pid,
        positive_feedback,
        rate,
    )
    from flexapod.control.limits import margins
    from flexapod.control.loops import best_gain, root_locus
    from flexapod.control.ring_down import ring_down
    from flexapod.control.scheduled import Scheduled
    from flexapod.control.state_space import StateSpace

_HOMES = {
    "adaptive": ("AdaptiveDamping", "Tracker"),
    "closing": ("DelayedLoop",),
    "controllers": ("DVF", "IFF", "PID", "Controller", "Decentralised", "Decoupled", "Fused", "Together"),
    "decoupling": (
        "Decoupling",
        "by_jacobian",
        "by_modes",
        "by_singular_vectors",
        "centre_of_stiffness",
        "robot_jacobian",
    ),
    "function": ("Function",),
    "impedances": ("impedance",),
    "laws": (
        "ControlLaw",
        "complementary",
        "gain",
        "high_pass",
        "integrator",
        "lead",
        "low_pass",
        "notch",
        "pid",
        "positive_feedback",
        "rate",
    ),
    "loops": ("best_gain", "root_locus"),
    "limits": ("margins",),
    "ring_down": ("ring_down",),
    "scheduled": ("Scheduled",),
    "state_space": ("StateSpace",),
}
_NAMES = {name: module for module, names in _HOMES.items() for name in names}

__all__ = [
    "DVF",
    "IFF",
    "PID",
    "AdaptiveDamping",
    "ControlLaw",
    "Controller",
    "Decentralised",
    "Decoupled",
    "Decoupling",
    "DelayedLoop",
    "Function",
    "Fused",
    "Scheduled",
    "StateSpace",
    "Together",
    "Tracker",
    "best_gain",
    "by_jacobian",
    "by_modes",
    "by_singular_vectors",
    "centre_of_stiffness",
    "complementary",
    "gain",
    "high_pass",
    "impedance",
    "integrator",
    "lead",
    "low_pass",
    "margins",
    "notch",
    "pid",
    "positive_feedback",
    "rate",
    "ring_down",
    "robot_jacobian",
    "root_locus",
]


def __getattr__(name: str) -> object:
    if name not in _NAMES:
        raise AttributeError(f"module 'flexapod.control' has no attribute {name!r}")
    value = globals()[name] = getattr(loaded(f"flexapod.control.{_NAMES[name]}"), name)
    return value


def __dir__() -> list[str]:
    return sorted({name for name in globals() if name.startswith("__")} | {*_NAMES})
