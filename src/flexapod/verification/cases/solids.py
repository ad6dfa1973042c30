"""Thick beams and the axial mode of a piston, in solid elements."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from flexapod.common.arrays import Array
from flexapod.model import Rectangle
from flexapod.solve.fem.frequencies import frequencies
from flexapod.solve.fem.hexahedra import extrude_section
from flexapod.solve.fem.reduction import reduced_beam
from flexapod.solve.fem.section_mesh import section_mesh
from flexapod.verification.case import Check, case, checks
from flexapod.verification.robots import ROUND, STEEL

LENGTH = 0.6  # m, of the piston
LAYERS, BELOW = 12, 9


@case(
    "Axial vibration of a clamped 27 mm steel piston of 600 mm: the tenth frequency of the solid at "
    "Poisson's ratio 0, above four pairs of bending and one of torsion",
    source="c / 4 L of a uniform bar",
    argument="quadratic elements, a 24th of a quarter wave: (k l)^4 / 720 of a frequency, and rounding, 1e-6; four "
    "printed digits",
)
def _axial_free() -> list[Check]:
    mesh = extrude_section(section_mesh(ROUND, 0.02, "hex20"), LENGTH, LAYERS)
    found = frequencies(mesh, E=STEEL.E, density=STEEL.density, count=BELOW + 1)
    exact = float(np.sqrt(STEEL.E / STEEL.density) / (4 * LENGTH))
    # The leading error of a quadratic element is (k l)^4 / 720 of a frequency, k = pi / 2 L.
    bound = (np.pi / 2 / LAYERS) ** 4 / 720 + 1e-6
    return [
        Check("first axial mode", exact, float(found[BELOW]), bound, "Hz"),
        Check("as printed", 2110.0, float(found[BELOW]), 5e-4, "Hz"),
    ]


POISSON = 0.3
TABLE_KAPPA, PLANE_KAPPA = 5 / 6, 5 * (1 + POISSON) / (6 + 5 * POISSON)  # of the table; of a narrow section
INTERVALS = {0.02: 48, 0.05: 24, 0.1: 24}
# Radius of gyration over the length; ends; omega / sqrt(EI / rhoA L^4) of modes 1 to 3
TABLE = (
    (0.02, "clamped-free", (3.502641, 21.469824, 58.149832)),
    (0.02, "pinned-pinned", (9.790536, 38.266761, 83.086521)),
    (0.02, "clamped-pinned", (15.129718, 47.533725, 95.105932)),
    (0.05, "clamped-free", (3.435275, 19.103623, 46.60314)),
    (0.05, "pinned-pinned", (9.410598, 33.549431, 65.646658)),
    (0.05, "clamped-pinned", (13.85575, 39.101522, 70.533451)),
    (0.1, "clamped-free", (3.227128, 14.468928, 31.502539)),
    (0.1, "pinned-pinned", (8.387358, 25.34588, 44.126572)),
)
# What the ends hold of (w, turn, moment, shear), the first end and the other one
HELD = {"clamped": (0, 1), "pinned": (0, 2), "free": (2, 3)}


def timoshenko(gyration: float, kappa: float, ends: str, near: tuple[float, ...]) -> Array:
    """Dimensionless frequencies of Timoshenko's beam next to the given ones.

    With EI = rhoA = L = 1 the state (w, turn, moment M, shear force Q) follows w' = turn + (E / kappa G) r^2 Q,
    turn' = M, M' = -Q - r^2 W^2 turn, Q' = -W^2 w.
    """
    from scipy.linalg import expm
    from scipy.optimize import brentq

    give = 2 * (1 + POISSON) / kappa * gyration**2
    first, other = (HELD[end] for end in ends.split("-"))
    open_first = [i for i in range(4) if i not in first]

    def left(W: float) -> float:
        A = np.array([[0, 1, 0, give], [0, 0, 1, 0], [0, -((gyration * W) ** 2), 0, -1], [-(W**2), 0, 0, 0]])
        return float(np.linalg.det(expm(A)[np.ix_(other, open_first)]))

    return np.array([brentq(left, 0.98 * W, 1.03 * W, xtol=1e-9) for W in near])


def solid_beam_frequencies(gyration: float, ends: str, intervals: int, count: int = 3) -> Array:
    """Dimensionless frequencies of a narrow solid beam, at whose ends section averages are held."""
    from scipy.linalg import eigh

    height = gyration * np.sqrt(12)
    section = Rectangle(width=height / 20, height=height)
    size = min(height / 4, 1 / intervals)
    model = reduced_beam(section, 1.0, size, E=1.0, density=1.0, poisson=POISSON, spacing=1 / intervals)
    last = 2 * model.stations - 2
    first, other = ends.split("-")
    held = [last + i for i in HELD[first] if i < 2] + [i for i in HELD[other] if i < 2]
    free = np.setdiff1d(np.arange(last + 2), held)
    K, M = (matrix[np.ix_(free, free)] for matrix in (model.stiffness, model.mass))
    return np.sqrt(eigh(K, M, eigvals_only=True)[:count]) / gyration


@case(
    "Frequencies of thick beams, radius of gyration 0.02, 0.05 and 0.1 of the length, Poisson's ratio 0.3: "
    "quadratic solid elements, narrow, section averages of deflection and rotation held at the ends",
    source="exact characteristic equations of Timoshenko's beam, kappa = 5 / 6",
    argument="a narrow section has kappa = 5 (1 + nu) / (6 + 5 nu) = 0.867 in place of 0.833: what that raises the "
    "frequency of Timoshenko's beam, 1e-4 to 1.2 %, and a third of what half the elements change, the rest of an "
    "order of two at least",
)
def _timoshenko() -> Iterator[Check]:
    for gyration, ends, waves in TABLE:
        n = INTERVALS[gyration]
        coarse, fine = solid_beam_frequencies(gyration, ends, n // 2), solid_beam_frequencies(gyration, ends, n)
        shear = timoshenko(gyration, PLANE_KAPPA, ends, waves) / waves - 1
        bound = shear + np.abs(coarse - fine) / waves / 3
        yield from checks([f"{ends}, r / L = {gyration:g}, mode {i}" for i in (1, 2, 3)], waves, fine, bound)
