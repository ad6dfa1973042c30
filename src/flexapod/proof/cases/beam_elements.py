"""Bending of a clamped beam in finite elements, with and without a body at its tip."""

from __future__ import annotations

import numpy as np

from flexapod.model import Actuator, Simulation
from flexapod.proof.case import Case, Check
from flexapod.proof.cases.cantilever import ROOTS
from flexapod.proof.cases.tip_body import TABLE
from flexapod.solve.actuator_modes import actuator_modes

ELEMENTS, SEGMENTS = 8, 12


def _waves(fidelity: str, shapes: int, mass: float = 0.0, inertia: float = 0.0) -> np.ndarray:
    beam = Actuator(length=1.0, rhoA=1.0, EI=1.0, free_length=1.0, tip_mass=mass, tip_inertia=inertia)
    return 2 * np.pi * actuator_modes(beam, Simulation(fidelity=fidelity, modes=shapes)).frequency[:3]


def _cubic(wave: float) -> float:
    """Relative error of a frequency, lambda^2 = `wave`: (lambda / n)^4 / 1440, and a tenth of it for the next term."""
    return 1.1 * wave**2 / ELEMENTS**4 / 1440 + 2e-7


def _compute() -> list[Check]:
    found: list[Check] = []
    bodies = ((0.0, 0.0, tuple(np.square(ROOTS[:3]))), *TABLE)
    for mass, inertia, row in bodies:
        ours = _waves("beam-fem", 2 * ELEMENTS, mass, inertia)
        found += [
            Check(what=f"elements, m = {mass:g}, J = {inertia:g}, mode {i + 1}", reference=float(wave),
                  ours=float(ours[i]), tolerance=_cubic(wave))
            for i, wave in enumerate(row)
        ]  # fmt: skip
    ours = _waves("finite-segment", SEGMENTS)
    return found + [
        Check(what=f"segments, mode {i + 1}", reference=float(wave), ours=float(ours[i]), tolerance=bound)
        for i, (wave, bound) in enumerate(zip(bodies[0][2], np.square(ROOTS[:3]) / SEGMENTS**2 / 12, strict=True))
    ]


BEAM_ELEMENTS = Case(
    name="beam-elements",
    statement="Frequencies of a clamped beam with mass and rotary inertia at its tip: eight cubic elements; twelve "
    "hinged segments without a body",
    source="closed forms, as for cantilever and tip-body",
    argument="leading error of cubic elements, (lambda / n)^4 / 1440 (that of a sine; a clamped or free end takes some "
    "of it), a tenth for the next term, seven digits of the table; of segments, the chord of a sine, "
    "(lambda / n)^2 / 24, and as much for the half segment at the clamp",
    compute=_compute,
)
