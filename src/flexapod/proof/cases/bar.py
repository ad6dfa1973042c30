"""Stretching of a piston held at its inner end."""

from __future__ import annotations

import numpy as np

import flexapod.model as model
from flexapod.proof.case import Case, Check
from flexapod.proof.robots import heavy_robot
from flexapod.study.static import modes

E, DENSITY, DIAMETER, FREE = 200e9, 7800.0, 0.027, 0.6


def _compute() -> list[Check]:
    # A platform that cannot move holds the tips: clamped-clamped bar, n c / 2 L.
    speed = np.sqrt(E / DENSITY)
    robot = heavy_robot(mouth=0.0, mass=0.0, free=FREE, diameter=DIAMETER, E=E, density=DENSITY)
    found = modes(robot, modes=1, axial_modes=4)
    first = float(found.frequency.values[[kind.endswith("axial") for kind in found.kind.values]].min())
    stiff = model.Piston.round(
        length=FREE,
        section=model.Tube(diameter=DIAMETER),
        material=model.Material(name="steel", E=E, density=DENSITY),
    )
    return [
        Check(what="first axial mode", reference=speed / (2 * FREE), ours=first, tolerance=1e-12, unit="Hz"),
        Check(what="EA / L of the piston", reference=1.9085e8, ours=stiff.EA / FREE, tolerance=5e-5, unit="N/m"),
    ]


BAR = Case(
    name="bar",
    statement="Axial vibration and stiffness of a 27 mm steel piston of 600 mm",
    source="c / 2 L of a uniform bar held at both ends; EA / L",
    argument="the sine shapes are the exact modes of such a bar; EA / L is printed with five digits",
    compute=_compute,
)
