"""A beam that turns steadily about its root."""

from __future__ import annotations

import numpy as np

from flexapod.model import Actuator, Simulation
from flexapod.solve.actuator_modes import actuator_modes
from flexapod.study.verify.case import Case, Check

# Speed, hub radius, tip mass (dimensionless), first flap frequency, digits after the point
FLAP = (
    *((g, 0.0, 0.0, w) for g, w in (
        (1, 3.681647), (2, 4.137320), (3, 4.797279), (4, 5.585001), (5, 6.449545), (6, 7.360373), (8, 9.256838),
        (10, 11.202328), (12, 13.170150),
    )),
    (1, 0.0, 1.0, 1.90168),
    (2, 0.0, 1.0, 2.66964),
    (4, 0.0, 1.0, 4.54291),
    (8, 0.0, 1.0, 8.49447),
    (2, 1.0, 0.0, 4.8337),
    (10, 1.0, 0.0, 16.6064),
    (2, 5.0, 0.0, 6.9415),
    (10, 5.0, 0.0, 29.4745),
    (5, 0.5, 1.0, 6.719405),
)  # fmt: skip
LAG = ((1, 3.5432), (2, 3.6218), (5, 4.0739), (10, 5.0490))


def _lag(g: float, hub: float, mass: float) -> float:
    beam = Actuator(length=1.0, rhoA=1.0, EI=1.0, free_length=1.0, hub_radius=hub, tip_mass=mass)
    found = actuator_modes(beam, Simulation(basis="tip-load", modes=12), rate=g)
    return float(2 * np.pi * found.frequency[0])


def _compute() -> list[Check]:
    flap = [
        Check(
            what=f"flap, speed {g:g}, hub {hub:g}, tip mass {mass:g}",
            reference=w,
            ours=float(np.hypot(_lag(g, hub, mass), g)),
            tolerance=2e-5,
        )
        for g, hub, mass, w in FLAP
    ]
    lag = [Check(what=f"lag, speed {g:g}", reference=w, ours=_lag(g, 0.0, 0.0), tolerance=2e-5) for g, w in LAG]
    return flap + lag


ROTATING_BEAM = Case(
    name="rotating-beam",
    statement="First flap and lag frequency of a turning clamped beam; twelve shapes; flap^2 = lag^2 + speed^2",
    source="Wright et al. 1982, Hodges & Rutkowski 1981; recomputed with 30 spectral shapes",
    argument="half a unit of the last printed digit is 1.5e-5 of the smallest entry; twelve shapes are right to 1e-5",
    compute=_compute,
)
