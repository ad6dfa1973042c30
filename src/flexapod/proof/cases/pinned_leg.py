"""A leg of the robot between its ideal joints, drive locked."""

from __future__ import annotations

from flexapod.proof.case import Case, Check
from flexapod.proof.robots import heavy_robot
from flexapod.study.static import modes

# Cylinder's length [m] and mass [kg], free length [m], frequencies [Hz]
TABLE = (
    (0.3, 3.0, 0.6, (67.976401, 321.006353, 844.644953)),
    (0.4, 5.0, 0.6, (54.579565, 291.10741, 810.989844)),
    (0.5, 8.0, 0.6, (43.768985, 271.284004, 790.6379)),
    (0.4, 5.0, 0.34, (113.893634, 823.028156)),
    (0.4, 5.0, 0.47, (75.104984, 452.327661)),
)
TOLERANCES = (1e-6, 1e-6, 2e-4)  # of modes 1 to 3


def _compute() -> list[Check]:
    found: list[Check] = []
    for mouth, mass, free, row in TABLE:
        robot = heavy_robot(mouth=mouth, mass=mass, free=free, diameter=0.027, E=200e9, density=7800.0)
        frequency = modes(robot, modes=6, axial_modes=1).frequency.values[6:]  # six of them: the heavy platform's
        found += [
            Check(
                what=f"cylinder {mouth:g} m, {mass:g} kg, piston {free:g} m, mode {i + 1}",
                reference=value,
                ours=float(frequency[12 * i]),
                tolerance=TOLERANCES[i],
                unit="Hz",
            )
            for i, value in enumerate(row)
        ]
    return found


PINNED_LEG = Case(
    name="pinned-leg",
    statement="Frequencies of a leg, rigid cylinder with a clamped piston, between ideal joints; six shapes",
    source="closed form: beam clamped in a rigid bar that is pinned, tip pinned",
    argument="basis tip-load reaches 1e-11, 2e-7 and 2e-4 in modes 1 to 3; the platform of 1e12 kg gives way by less",
    compute=_compute,
)
