"""Bending of a clamped beam."""

from __future__ import annotations

import numpy as np

from flexapod.model import Actuator, Simulation
from flexapod.proof.case import Case, Check, checks
from flexapod.solve.actuator_modes import actuator_modes

ROOTS = (1.875104068712, 4.694091132974, 7.854757438238, 10.99554073488, 14.13716839105)  # cos x cosh x = -1
NAMES = [f"mode {i}, omega / sqrt(EI / rhoA L^4)" for i in range(1, 6)]


def _compute() -> list[Check]:
    beam = Actuator(length=1.0, rhoA=1.0, EI=1.0, free_length=1.0)
    found = actuator_modes(beam, Simulation(basis="clamped-free", modes=5))
    return checks(NAMES, np.square(ROOTS), 2 * np.pi * found.frequency, 1e-11)


CANTILEVER = Case(
    name="cantilever",
    statement="Frequencies of a clamped-free beam, in its own eigenfunctions",
    source="roots of cos x cosh x = -1, any text on vibrations",
    argument="the shapes are the exact ones; the printed roots carry 12 to 13 digits",
    compute=_compute,
)
