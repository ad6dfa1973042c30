"""Linear systems with named channels, and loops around them: they take any state space, robots or not.

Public names load on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexapod.common.lazy_imports import later

if TYPE_CHECKING:
    from collections.abc import Callable

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
    from flexapod.control.function import Function
    from flexapod.control.gain_scheduling import Scheduled
    from flexapod.control.impedances import impedance
    from flexapod.control.loop_stability import margins
    from flexapod.control.loops import best_gain, root_locus
    from flexapod.control.ring_down import ring_down
    from flexapod.control.state_space import StateSpace

_HOMES = {
    "flexapod.control.adaptive": ("AdaptiveDamping", "Tracker"),
    "flexapod.control.closing": ("DelayedLoop",),
    "flexapod.control.controllers": (
        "DVF", "IFF", "PID", "Controller", "Decentralised", "Decoupled", "Fused", "Together",
    ),
    "flexapod.control.decoupling": (
        "Decoupling", "by_jacobian", "by_modes", "by_singular_vectors", "centre_of_stiffness", "robot_jacobian",
    ),
    "flexapod.control.function": ("Function",),
    "flexapod.control.impedances": ("impedance",),
    "flexapod.control.filters": (
        "ControlLaw", "complementary", "gain", "high_pass", "integrator", "lead", "low_pass", "notch", "pid",
        "positive_feedback", "rate",
    ),
    "flexapod.control.loop_stability": ("margins",),
    "flexapod.control.loops": ("best_gain", "root_locus"),
    "flexapod.control.ring_down": ("ring_down",),
    "flexapod.control.gain_scheduling": ("Scheduled",),
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


__getattr__: Callable[[str], object] = later("flexapod.control", _HOMES)


def __dir__() -> list[str]:
    return sorted({name for name in globals() if name.startswith("__")} | {*__all__})
