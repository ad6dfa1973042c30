"""Stiffness of the cubic hexapod."""

from __future__ import annotations

import numpy as np

from flexapod.proof.case import Case, Check, checks
from flexapod.rigid.jacobian import length_jacobian, stiffness
from flexapod.typing import Array

EDGES_MM = (40, 100, 150, 250)  # over the square root of 3
ABOVE = 0.07  # m, above the centre of the cube of 100 mm
NAMES = ("along x", "along y", "along z", "about x [m^2]", "about y [m^2]", "about z [m^2]")
# 70 mm above the centre: row, column (x y z, about x y z), value
COUPLED = ((0, 4, -0.14), (4, 0, -0.14), (1, 3, 0.14), (3, 1, 0.14), (3, 3, 0.0248), (4, 4, 0.0248), (5, 5, 0.06))


def joints(edge: float) -> tuple[Array, Array]:
    """Ends of six edges of a cube that stands on a corner, its centre in the origin, (6, 3) each [m]."""
    corners = (np.ones((3, 3)) * -1 + 2 * np.eye(3)) * edge / 2
    z, x = np.ones(3) / np.sqrt(3), np.array([1, -1, 0]) / np.sqrt(2)
    axes = np.stack([x, np.cross(z, x), z])
    pairs = [(i, j) for i in range(3) for j in range(3) if i != j]
    lower = np.array([corners[i] for i, _ in pairs])
    upper = np.array([corners[i] + edge * np.eye(3)[j] for i, j in pairs])
    return lower @ axes.T, upper @ axes.T


def at_the_centre(edge: float) -> Array:
    """Stiffness (6, 6) at the centre in units of that of a leg: diagonal."""
    return np.diag([2, 2, 2, edge**2 / 2, edge**2 / 2, 2 * edge**2])


def above_the_centre() -> Array:
    """Stiffness (6, 6) at a point 70 mm above the centre of the cube of 100 mm times root 3."""
    table = np.diag([2.0, 2.0, 2.0, 0.0, 0.0, 0.0])
    for i, j, value in COUPLED:
        table[i, j] = value
    return table


def _compute() -> list[Check]:
    found: list[Check] = []
    for size in EDGES_MM:
        edge = np.sqrt(3) * size * 1e-3
        ours = stiffness(length_jacobian(*joints(edge), np.zeros(3), np.eye(3)), 1.0)
        names = [f"edge sqrt(3) {size} mm, {name}" for name in NAMES]
        found += checks(names, np.diag(at_the_centre(edge)), np.diag(ours), 1e-13)
        off = float(np.abs(ours - np.diag(np.diag(ours))).max())
        found.append(
            Check(what=f"edge sqrt(3) {size} mm, coupling", reference=0, ours=off, tolerance=1e-14, absolute=True)
        )
    ours = stiffness(length_jacobian(*joints(np.sqrt(3) * 0.1), np.zeros(3), np.eye(3), [0, 0, ABOVE]), 1.0)
    names = [f"70 mm above the centre, row {i + 1}, column {j + 1}" for i, j, _ in COUPLED]
    return found + checks(names, [v for *_, v in COUPLED], [ours[i, j] for i, j, _ in COUPLED], 1e-13)


CUBIC_HEXAPOD = Case(
    name="cubic-hexapod",
    statement="Stiffness of a hexapod along edges of a cube, in units of that of a leg",
    source="Preumont et al. 2007: diag(2, 2, 2, L^2/2, L^2/2, 2 L^2), and its table 70 mm above the centre",
    argument="closed form on both sides: rounding",
    compute=_compute,
)
