"""Bending of a clamped beam that carries a body at its tip."""

from __future__ import annotations

import numpy as np

from flexapod.model import Actuator, Simulation
from flexapod.proof.case import Case, Check, checks
from flexapod.solve.actuator_modes import actuator_modes

# Tip mass over beam mass, rotary inertia over rhoA L^3, first three omega / sqrt(EI / rhoA L^4)
TABLE = (
    (0.1, 0.0, (2.9678383, 19.355801, 55.5182455)),
    (0.5, 0.0, (2.016299, 16.9014177, 51.7009209)),
    (1.0, 0.0, (1.5572979, 16.2500852, 50.8958428)),
    (2.0, 0.0, (1.1581971, 15.86089, 50.4476397)),
    (5.0, 0.0, (0.7569373, 15.6023459, 50.1623389)),
    (10.0, 0.0, (0.541375, 15.5115131, 50.064347)),
    (1.0, 0.01, (1.5436768, 13.2395886, 32.0695808)),
    (1.0, 0.1, (1.4296263, 6.2753257, 24.7516045)),
    (1.0, 1.0, (0.8678998, 3.3905722, 24.0185577)),
    (1.0, 10.0, (0.3115388, 2.9978154, 23.9471132)),
)


def _compute() -> list[Check]:
    found: list[Check] = []
    for mass, inertia, row in TABLE:
        beam = Actuator(length=1.0, rhoA=1.0, EI=1.0, free_length=1.0, tip_mass=mass, tip_inertia=inertia)
        waves = 2 * np.pi * actuator_modes(beam, Simulation(basis="tip-mass", modes=3)).frequency
        names = [f"m = {mass:g}, J = {inertia:g}, mode {i}" for i in (1, 2, 3)]
        found += checks(names, row, waves, 2e-7)
    return found


TIP_BODY = Case(
    name="tip-body",
    statement="Frequencies of a clamped beam with mass and rotary inertia at its tip, basis tip-mass",
    source="1 + cos x cosh x + mu x (cos x sinh x - sin x cosh x) = 0 and its form with rotary inertia, in closed form",
    argument="the shapes are the exact ones; the table carries seven to nine digits, at least half a unit of 0.3115388",
    compute=_compute,
)
