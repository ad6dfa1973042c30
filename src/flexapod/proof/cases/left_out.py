"""References that the software has no model for: listed, and not run."""

from __future__ import annotations

from flexapod.proof.case import Case, Check

__all__ = ["NOT_MODELLED"]


def _compute() -> list[Check]:
    return []


NOT_MODELLED = Case(
    name="not-modelled",
    statement="Lag of a turning beam with Coriolis forces between stretch and bending, 1.6 % less at speed 10, hub 0; "
    "its "
    "steady stretch, 5.143e-4 m in the spin-up of Simo & Vu-Quoc; impulses and insensitivity of the shapers ZV, ZVD, "
    "ZVDD and EI; damping by integral force feedback",
    source="Yoo & Shin 1998; L (tan a / a - 1) of a linear rod; Singer & Seering 1990, Singhose et al. 1994; Preumont "
    "et "
    "al. 2007",
    argument="half a unit of the printed digits",
    compute=_compute,
    not_run="the software has no such models: the single actuator bends and does not stretch (a robot's legs do), and "
    "there are neither shapers nor force feedback",
)
