"""A beam that turns steadily about its root."""

from __future__ import annotations

from functools import cache

import numpy as np

from flexapod.model import Actuator, Simulation
from flexapod.proof.case import Case, Check
from flexapod.solve.actuator_modes import actuator_modes
from flexapod.typing import Array

# Speed, hub radius, tip mass (dimensionless), flap frequencies from the first on
FLAP = (
    (1, 0.0, 0.0, (3.681647, 22.181011, 61.841763)),
    (2, 0.0, 0.0, (4.137320, 22.614922, 62.273184)),
    (3, 0.0, 0.0, (4.797279, 23.320264, 62.984967)),
    (4, 0.0, 0.0, (5.585001, 24.273349, 63.966760)),
    (5, 0.0, 0.0, (6.449545, 25.446080, 65.205041)),
    (6, 0.0, 0.0, (7.360373, 26.809082, 66.683914)),
    (8, 0.0, 0.0, (9.256838, 29.995382, 70.292962)),
    (10, 0.0, 0.0, (11.202328, 33.640366, 74.649295)),
    (12, 0.0, 0.0, (13.170150, 37.603112, 79.614478)),
    (1, 0.0, 1.0, (1.90168, 16.75702)),
    (2, 0.0, 1.0, (2.66964, 18.19097)),
    (4, 0.0, 1.0, (4.54291, 23.02287)),
    (8, 0.0, 1.0, (8.49447, 36.21329)),
    (2, 1.0, 0.0, (4.8337,)),
    (10, 1.0, 0.0, (16.6064,)),
    (2, 5.0, 0.0, (6.9415,)),
    (10, 5.0, 0.0, (29.4745,)),
    (5, 0.5, 1.0, (6.719405, 30.01018, 69.458755)),
)
LAG = (
    (1, 0.0, 0.0, (3.5432,)), (2, 0.0, 0.0, (3.6218,)), (5, 0.0, 0.0, (4.0739,)), (10, 0.0, 0.0, (5.0490,)),
    (5, 0.5, 1.0, (4.48892, 29.590723)),
)  # fmt: skip
SHAPES = 8
# The boundary layer at the root, L / (speed sqrt(hub + 1/2)), is thin
FAST = ((50, 1.0, 0.0, 79.3305), (50, 5.0, 0.0, 144.3906))
FAULT = (
    "It is the Ritz value of 16 polynomials, not the limit: 24, 30 and 40 polynomials give 144.381755, 144.381721 and "
    "144.381720, and so does a boundary-value solver."
)


@cache
def _lag(g: float, hub: float, mass: float) -> Array:
    beam = Actuator(length=1.0, rhoA=1.0, EI=1.0, free_length=1.0, hub_radius=hub, tip_mass=mass)
    return 2 * np.pi * actuator_modes(beam, Simulation(basis="tip-load", modes=SHAPES), rate=g).frequency


def _compute() -> list[Check]:
    found: list[Check] = []
    for kind, table in (("flap", FLAP), ("lag", LAG)):
        for g, hub, mass, row in table:
            ours = np.hypot(_lag(g, hub, mass), g) if kind == "flap" else _lag(g, hub, mass)
            where = f"{kind}, speed {g:g}, hub {hub:g}, tip mass {mass:g}"
            found += [
                Check(what=f"{where}, mode {i + 1}", reference=w, ours=float(ours[i]), tolerance=2e-5)
                for i, w in enumerate(row)
            ]
    return found + [
        Check(
            what=f"flap, speed {g:g}, hub {hub:g}, tip mass {mass:g}, mode 1",
            reference=w,
            ours=float(np.hypot(_lag(g, hub, mass)[0], g)),
            tolerance=2e-5,
            fault=FAULT if hub == 5 else "",
        )
        for g, hub, mass, w in FAST
    ]


ROTATING_BEAM = Case(
    name="rotating-beam",
    statement="Flap and lag frequencies of a turning clamped beam; eight shapes; flap^2 = lag^2 + speed^2",
    source="Wright et al. 1982, Hodges & Rutkowski 1981; recomputed with 30 spectral shapes",
    argument="half a unit of the last printed digit is 1.5e-5 of the smallest entry; eight shapes are right to 1e-5",
    compute=_compute,
)
