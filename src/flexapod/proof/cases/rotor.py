"""A composite rotor blade that turns: measured flap frequencies."""

from __future__ import annotations

import numpy as np

from flexapod.model import Actuator, Simulation
from flexapod.proof.case import Case, Check
from flexapod.solve.actuator_modes import actuator_modes

INCH, PSI = 0.0254, 6894.757293
LENGTH, ROOT, WIDTH, DEPTH = 37.5 * INCH, 2.5 * INCH, 1.0 * INCH, 0.117 * INCH
E, DENSITY = 2.059e7 * PSI, 1.44e-4 * PSI / INCH**2  # lb s^2 / in^4
# Speed [rpm], first three flap frequencies [Hz]
MEASURED = (
    (0, (5.237, 33.0, 90.4)), (250, (7.424, 34.6, 91.1)), (500, (11.018, 40.2, 97.7)), (750, (15.820, 47.0, 105.6)),
)  # fmt: skip


def _compute() -> list[Check]:
    blade = Actuator(
        length=LENGTH, free_length=LENGTH, hub_radius=ROOT, rhoA=DENSITY * WIDTH * DEPTH, EI=E * WIDTH * DEPTH**3 / 12
    )
    found: list[Check] = []
    for rpm, row in MEASURED:
        lag = actuator_modes(blade, Simulation(basis="tip-load", modes=8), rate=rpm * np.pi / 30).frequency[:3]
        flap = np.hypot(lag, rpm / 60)
        found += [
            Check(what=f"{rpm} rpm, mode {i + 1}", reference=value, ours=float(flap[i]), tolerance=0.1, unit="Hz")
            for i, value in enumerate(row)
        ]
    return found


ROTOR = Case(
    name="rotor",
    statement="Flap frequencies of a straight composite blade at up to 750 rpm, as an Euler-Bernoulli beam",
    source="Epps & Chandra 1996, measured; section and moduli as in the examples of AeroBeams.jl",
    argument="an experiment: no shear, no coupling of the laminate, moduli of the material: 10 %, as others take",
    compute=_compute,
)
