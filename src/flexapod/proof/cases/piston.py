"""The paper's piston between ideal ends: section, bending, buckling."""

from __future__ import annotations

import numpy as np

from flexapod import model
from flexapod.proof.case import Case, Check
from flexapod.proof.robots import heavy_robot
from flexapod.study.static import modes

STEEL = {"diameter": 0.027, "E": 200e9, "density": 7800.0}
FREE = 0.6
PINNED = (149.138, 596.553)  # Hz, pinned at both ends
CLAMPED = (232.982, 755.012)  # Hz, clamped at one
EULER = 143.0e3  # N
HEAVY = 1e9  # kg: a cylinder that holds its piston clamped
# Thrust [N] and the factor it puts on the first frequency, sqrt(1 - P / P_cr)
THRUST = 1e3
FACTOR = 0.996498


def _section() -> list[Check]:
    rod = model.Piston.round(
        length=FREE,
        section=model.Tube(diameter=STEEL["diameter"]),
        material=model.Material(name="steel", E=STEEL["E"], density=STEEL["density"]),
    )
    rows = (
        ("EI", 5217.4, rod.EI, "N m^2", 1e-5),
        ("EA", 1.1451e8, rod.EA, "N", 5e-5),
        ("mass per length", 4.466, rod.rhoA, "kg/m", 1.2e-4),
    )
    buckling = np.pi**2 * rod.EI / FREE**2
    return [
        *(
            Check(what=what, reference=a, ours=b, tolerance=tolerance, unit=unit)
            for what, a, b, unit, tolerance in rows
        ),
        Check(what="Euler load", reference=EULER, ours=float(buckling), tolerance=4e-4, unit="N"),
    ]


def _compute() -> list[Check]:
    found = _section()
    light = heavy_robot(mouth=0.0, mass=0.0, free=FREE, **STEEL)
    held = heavy_robot(mouth=0.3, mass=HEAVY, free=FREE, **STEEL)
    for name, robot, first, table in (("pinned", light, 6, PINNED), ("clamped", held, 18, CLAMPED)):
        ours = modes(robot, modes=8, axial_modes=1).frequency.values[first::12]
        found += [
            Check(
                what=f"{name} and pinned, mode {i + 1}",
                reference=value,
                ours=float(ours[i]),
                tolerance=bound,
                unit="Hz",
            )
            for i, (value, bound) in enumerate(zip(table, (1e-5, 1e-5), strict=True))
        ]
    across = light.home_height / light.home_lengths[0]
    weight = np.array([0.0, 0.0, -6 * THRUST * across, 0.0, 0.0, 0.0])
    free, loaded = (
        modes(light, load=load, modes=8, axial_modes=1).frequency.values[6] for load in (np.zeros(6), weight)
    )
    return [
        *found,
        Check(what="factor of a thrust of 1 kN", reference=FACTOR, ours=float(loaded / free), tolerance=1e-6),
    ]


PISTON = Case(
    name="piston",
    statement="A 27 mm steel piston of 600 mm: section, bending between ideal ends, first frequency under "
    "a thrust of 1 kN",
    source="closed forms: sin x = 0, tan x = tanh x, sqrt(1 - P / P_cr)",
    argument="printed digits; what eight polynomials lack of a sine with lambda = 7.07 is at most 4e-6",
    compute=_compute,
)
