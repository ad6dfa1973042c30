"""Shear and rotary inertia, which an Euler-Bernoulli beam leaves out, after Timoshenko, Eqs. (T8.19)-(T8.21)."""

from __future__ import annotations

import math
from dataclasses import dataclass

from flexapod.model import Actuator, Piston, Rectangle

POISSON = 0.3  # of metals; materials give none


@dataclass(frozen=True, kw_only=True)
class Section:
    """What shear asks of a section: radius of gyration [m], Cowper's coefficient kappa."""

    gyration: float
    kappa: float


def piston_section(piston: Piston) -> Section:
    """Section of a piston: a tube where its bore is known, else the full round bar with its EI and EA."""
    hollow = 0.0 if not piston.diameter else (piston.inner_diameter or 0.0) / piston.diameter
    return Section(gyration=math.sqrt(piston.EI / piston.EA), kappa=_round(hollow))


def beam_section(actuator: Actuator) -> Section | None:
    """Section of an actuator's beam, where it is known."""
    section = actuator.section
    if section is None:
        return None
    gyration = math.sqrt(section.second_moment / section.area)
    if isinstance(section, Rectangle):
        return Section(gyration=gyration, kappa=10 * (1 + POISSON) / (12 + 11 * POISSON))  # (T8.19)
    return Section(gyration=gyration, kappa=_round((section.inner_diameter or 0.0) / section.diameter))


def bending_errors(section: Section, free: float) -> tuple[float, float, float]:
    """Relative errors of an Euler-Bernoulli beam of a free length [m].

    Returns
    -------
    deflection : float
        By which a clamped beam deflects too little under a force at its end, Eq. (T8.20).
    frequency : float
        By which the first frequency of bending, both ends pinned, is too high, Eq. (T8.21): other ends, less.
    inertia : float
        The part of it without shear.
    """
    ratio, a = 2 * (1 + POISSON) / section.kappa, (math.pi * section.gyration / free) ** 2
    deflection = 3 * ratio * (section.gyration / free) ** 2  # (T8.20)
    half = 1 + a * (1 + ratio)
    square = 2 / (half + math.sqrt(half**2 - 4 * ratio * a**2))  # (T8.21)
    return deflection, 1 / math.sqrt(square) - 1, math.sqrt(1 + a) - 1


def _round(hollow: float) -> float:
    """Cowper's coefficient of a tube, `hollow` its inner over its outer diameter."""
    m, nu = (1 + hollow**2) ** 2, POISSON
    return 6 * (1 + nu) * m / ((7 + 6 * nu) * m + (20 + 12 * nu) * hollow**2)  # (T8.19)
