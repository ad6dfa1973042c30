"""Stiffness of the cubic hexapod."""

from __future__ import annotations

import numpy as np

from flexapod.rigid.jacobian import length_jacobian, stiffness
from flexapod.study.verify.case import Case, Check, checks
from flexapod.typing import Array

EDGE = np.sqrt(3) * 0.1


def _joints() -> tuple[Array, Array]:
    """Ends of six edges of a cube that stands on a corner, its centre in the origin, (6, 3) each [m]."""
    corners = (np.ones((3, 3)) * -1 + 2 * np.eye(3)) * EDGE / 2
    z, x = np.ones(3) / np.sqrt(3), np.array([1, -1, 0]) / np.sqrt(2)
    axes = np.stack([x, np.cross(z, x), z])
    pairs = [(i, j) for i in range(3) for j in range(3) if i != j]
    lower = np.array([corners[i] for i, _ in pairs])
    upper = np.array([corners[i] + EDGE * np.eye(3)[j] for i, j in pairs])
    return lower @ axes.T, upper @ axes.T


def _compute() -> list[Check]:
    lower, upper = _joints()
    centre = stiffness(length_jacobian(lower, upper, np.zeros(3), np.eye(3)), 1.0)
    above = stiffness(length_jacobian(lower, upper, np.zeros(3), np.eye(3), [0, 0, 0.07]), 1.0)
    names = ["along x", "along y", "along z", "about x [m^2]", "about y [m^2]", "about z [m^2]"]
    expected = [2, 2, 2, EDGE**2 / 2, EDGE**2 / 2, 2 * EDGE**2]
    return [
        *checks(names, expected, np.diag(centre), 1e-13),
        Check(what="coupling, 70 mm above the centre [m]", reference=-0.14, ours=float(above[0, 4]), tolerance=1e-13),
        Check(what="about x, 70 mm above the centre [m^2]", reference=0.0248, ours=float(above[3, 3]), tolerance=1e-13),
    ]


CUBIC_HEXAPOD = Case(
    name="cubic-hexapod",
    statement="Stiffness of a hexapod along edges of a cube, in units of that of a leg",
    source="Preumont et al. 2007: diag(2, 2, 2, L^2/2, L^2/2, 2 L^2)",
    argument="closed form on both sides: rounding",
    compute=_compute,
)
