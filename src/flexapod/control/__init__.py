"""Linear systems with named channels, and loops around them: they take any state space, robots or not.

Public names load on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexapod.common.lazy_imports import lazy_attributes

if TYPE_CHECKING:
    from collections.abc import Callable

    from flexapod.control.controllers import (
        DVF,
        IFF,
        PID,
        Controller,
        Decentralised,
        Decoupled,
        FunctionController,
        Parallel,
        SensorFusion,
    )
    from flexapod.control.decoupling import (
        Decoupling,
        by_jacobian,
        by_modes,
        by_singular_vectors,
        centre_of_stiffness,
        robot_jacobian,
    )
    from flexapod.control.feedback import DelayedLoop, impedance
    from flexapod.control.filters import (
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
    from flexapod.control.gain_scheduling import AdaptiveDamping, Scheduled, Tracker
    from flexapod.control.loop_gain import best_gain, root_locus
    from flexapod.control.loop_stability import margins
    from flexapod.control.measurements import ring_down
    from flexapod.control.state_space import StateSpace

_HOMES = {
    "flexapod.control.controllers": (
        "DVF", "IFF", "PID", "Controller", "Decentralised", "Decoupled", "FunctionController", "Parallel",
        "SensorFusion",
    ),
    "flexapod.control.decoupling": (
        "Decoupling", "by_jacobian", "by_modes", "by_singular_vectors", "centre_of_stiffness", "robot_jacobian",
    ),
    "flexapod.control.feedback": ("DelayedLoop", "impedance"),
    "flexapod.control.filters": (
        "ControlLaw", "complementary", "gain", "high_pass", "integrator", "lead", "low_pass", "notch", "pid",
        "positive_feedback", "rate",
    ),
    "flexapod.control.gain_scheduling": ("AdaptiveDamping", "Scheduled", "Tracker"),
    "flexapod.control.loop_gain": ("best_gain", "root_locus"),
    "flexapod.control.loop_stability": ("margins",),
    "flexapod.control.measurements": ("ring_down",),
    "flexapod.control.state_space": ("StateSpace",),
}  # fmt: skip

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
    "FunctionController",
    "Parallel",
    "Scheduled",
    "SensorFusion",
    "StateSpace",
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


#: Names of the release before.
_FORMER = {"Function": "FunctionController", "Fused": "SensorFusion", "Together": "Parallel"}

__getattr__: Callable[[str], object] = lazy_attributes("flexapod.control", _HOMES, _FORMER)


def __dir__() -> list[str]:
    return sorted({name for name in globals() if name.startswith("__")} | {*__all__})
