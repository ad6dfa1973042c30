"""References that the software has no model for: listed, and not run."""

from __future__ import annotations

from flexapod.study.verify.case import Case, Check

__all__ = ["AXIAL_FREE", "CHORDWISE", "SHAPING", "STEADY_EXTENSION", "TIMOSHENKO"]


def _compute() -> list[Check]:
    return []


TIMOSHENKO = Case(
    name="timoshenko",
    statement="Frequencies of thick beams, radius of gyration 0.02, 0.05 and 0.1 of the length",
    source="exact characteristic equations, nu = 0.3, kappa = 5/6",
    argument="half a unit of seven digits",
    compute=_compute,
    not_run="legs are Euler-Bernoulli beams, without shear; below a slenderness of 10 a remark says so",
)
CHORDWISE = Case(
    name="chordwise",
    statement="Lag of a turning beam that stretches, Coriolis forces between stretch and bending",
    source="Yoo & Shin 1998, slenderness 70; recomputed as a gyroscopic problem of two fields",
    argument="half a unit of five digits",
    compute=_compute,
    not_run="the single actuator bends and does not stretch; the difference is 1.6 % of 5.05 at speed 10",
)
STEADY_EXTENSION = Case(
    name="steady-extension",
    statement="Stretch of a beam that turns steadily, 5.143e-4 m in the spin-up of Simo & Vu-Quoc",
    source="m W^2 L^3 / 3 EA; L (tan a / a - 1) of a linear rod",
    argument="1 %",
    compute=_compute,
    not_run="the single actuator bends and does not stretch",
)
AXIAL_FREE = Case(
    name="axial-free",
    statement="Axial vibration of the piston with a free tip, 2110 Hz",
    source="c / 4 L",
    argument="four digits",
    compute=_compute,
    not_run="every leg of a robot carries its platform, and the single actuator does not stretch; see bar",
)
SHAPING = Case(
    name="shaping",
    statement="Impulses and insensitivity of the shapers ZV, ZVD, ZVDD and EI; damping by integral force feedback",
    source="Singer & Seering 1990, Singhose et al. 1994, Preumont et al. 2007",
    argument="six digits",
    compute=_compute,
    not_run="there are neither shapers nor force feedback; what the laws of motion leave is in residual-vibration",
)
