"""Natural frequencies of a solid with one end held: every node of it, or its section averages only."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from flexapod.errors import InputError
from flexapod.fem.banded import banded_solver
from flexapod.fem.elasticity import mass, stiffness
from flexapod.fem.hexahedra import integrals
from flexapod.fem.mesh import SolidMesh
from flexapod.fem.section_average import free_unknowns
from flexapod.typing import Array

__all__ = ["frequencies"]


def frequencies(mesh: SolidMesh, *, E: float, density: float, poisson: float = 0.0, count: int = 6) -> Array:
    """Lowest natural frequencies of a solid whose end x = 0 is clamped at all nodes.

    Parameters
    ----------
    mesh : SolidMesh
        Of the whole section all kinds of modes, of a half or quarter only bending in the plane of y.
    E, density : float
        Young's modulus [Pa], density [kg/m^3].
    poisson : float
        Poisson's ratio, -1 < poisson < 0.5.
    count : int
        How many.

    Returns
    -------
    (count,) array
        [Hz], ascending.

    Raises
    ------
    InputError
        Material or mesh that are not physical.
    """
    check_material(E, density, poisson)
    free = free_unknowns(mesh.nodes[:, 1:], mesh.section)
    free[np.repeat(np.isin(np.arange(len(mesh.nodes)), mesh.plane(0)), 3)] = False
    if not 0 < count < free.sum() - 1:
        raise InputError("is not a number of modes", key="count", value=count, allowed=f"1 to {free.sum() - 2}")
    parts = integrals(mesh)
    K, M = (matrix[free][:, free] for matrix in (stiffness(parts, E, poisson), mass(parts, density)))
    return lowest(K, M, count)


def check_material(E: float, density: float, poisson: float) -> None:
    """Refuse a Young's modulus or density that is not positive, and a Poisson's ratio outside [0, 0.5)."""
    for key, value in (("E", E), ("density", density)):
        if not (np.isfinite(value) and value > 0):
            raise InputError("is not physical", key=key, value=value, allowed="above 0")
    if not 0 <= poisson < 0.5:
        raise InputError("is not that of a solid bar", key="poisson", value=poisson, allowed="from 0, below 0.5")


def lowest(K: csr_array, M: csr_array, count: int) -> Array:
    """Lowest frequencies [Hz] of a held body."""
    from scipy.sparse.linalg import LinearOperator, eigsh

    size = len(K.indptr) - 1
    inverse = LinearOperator((size, size), matvec=banded_solver(K), dtype=float)  # pyright: ignore
    start = np.random.default_rng(0).normal(size=size)
    squared = eigsh(K, count, M, sigma=0.0, OPinv=inverse, v0=start, return_eigenvectors=False)
    return np.sqrt(np.sort(squared)) / (2 * np.pi)
