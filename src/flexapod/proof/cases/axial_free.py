"""Axial vibration of the piston with a free tip, in solid elements."""

from __future__ import annotations

import numpy as np

from flexapod.fem.frequencies import frequencies
from flexapod.fem.mesh import extruded
from flexapod.fem.section_mesh import section_mesh
from flexapod.model import Tube
from flexapod.proof.case import Case, Check

E, DENSITY, DIAMETER, LENGTH = 200e9, 7800.0, 0.027, 0.6
LAYERS, BELOW = 12, 9


def _compute() -> list[Check]:
    mesh = extruded(section_mesh(Tube(diameter=DIAMETER), 0.02, "hex20"), LENGTH, LAYERS)
    found = frequencies(mesh, E=E, density=DENSITY, count=BELOW + 1)
    exact = float(np.sqrt(E / DENSITY) / (4 * LENGTH))
    # The leading error of a quadratic element is (k l)^4 / 720 of a frequency, k = pi / 2 L.
    bound = (np.pi / 2 / LAYERS) ** 4 / 720 + 1e-6
    return [
        Check(what="first axial mode", reference=exact, ours=float(found[BELOW]), tolerance=bound, unit="Hz"),
        Check(what="as printed", reference=2110.0, ours=float(found[BELOW]), tolerance=5e-4, unit="Hz"),
    ]


AXIAL_FREE = Case(
    name="axial-free",
    statement="Axial vibration of a clamped 27 mm steel piston of 600 mm: the tenth frequency of the solid at "
    "Poisson's "
    "ratio 0, above four pairs of bending and one of torsion",
    source="c / 4 L of a uniform bar",
    argument="quadratic elements, a 24th of a quarter wave: (k l)^4 / 720 of a frequency, and rounding, 1e-6; four "
    "printed digits",
    compute=_compute,
)
