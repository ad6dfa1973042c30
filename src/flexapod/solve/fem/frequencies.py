"""Natural frequencies of a solid with one end clamped, and solutions with its banded matrices."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.sparse import csr_array

from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError, InputError
from flexapod.solve.fem.hexahedra import SolidMesh, integrals, mass, stiffness
from flexapod.solve.fem.section_mesh import free_unknowns


def banded_solver(matrix: csr_array) -> Callable[[Array], Array]:
    """Cholesky factors of a symmetric positive definite banded matrix, as a function right-hand side -> solution.

    ComputationError: the matrix is not positive definite, the body is not held.
    """
    from scipy.linalg import LinAlgError, cho_solve_banded, cholesky_banded

    parts = matrix.tocoo()
    size, width = len(matrix.indptr) - 1, int((parts.row - parts.col).max())
    lower = parts.row >= parts.col
    band = np.zeros((width + 1, size))
    band[(parts.row - parts.col)[lower], parts.col[lower]] = parts.data[lower]
    try:
        factor = cholesky_banded(band, lower=True, overwrite_ab=True, check_finite=False)
    except LinAlgError as error:
        raise ComputationError(
            "the stiffness of the solid is singular", next_step="Check that its nodes are held and joined"
        ) from error
    return lambda load: cho_solve_banded((factor, True), load, check_finite=False)


def frequencies(mesh: SolidMesh, *, E: float, density: float, poisson: float = 0.0, count: int = 6) -> Array:
    """Lowest `count` natural frequencies [Hz] of a solid whose end x = 0 is clamped at all nodes, ascending.

    `mesh` of the whole section: all kinds of modes; of a half or quarter: only bending in the plane of y. `E` [Pa],
    `density` [kg/m^3], Poisson's ratio `poisson` from 0, below 0.5. InputError: material or mesh that are not physical.
    """
    check_material(E, density, poisson)
    free = free_unknowns(mesh.nodes[:, 1:], mesh.section)
    free[np.repeat(np.isin(np.arange(len(mesh.nodes)), mesh.plane(0)), 3)] = False
    if not 0 < count < free.sum() - 1:
        raise InputError("is not a number of modes", key="count", value=count, allowed=f"1 to {free.sum() - 2}")
    parts = integrals(mesh)
    K, M = (matrix[free][:, free] for matrix in (stiffness(parts, E, poisson), mass(parts, density)))
    return lowest_frequencies(K, M, count)


def check_material(E: float, density: float, poisson: float) -> None:
    """Refuse a Young's modulus or density that is not positive, and a Poisson's ratio outside [0, 0.5)."""
    for key, value in (("E", E), ("density", density)):
        if not (np.isfinite(value) and value > 0):
            raise InputError("is not physical", key=key, value=value, allowed="above 0")
    if not 0 <= poisson < 0.5:
        raise InputError("is not that of a solid bar", key="poisson", value=poisson, allowed="from 0, below 0.5")


def lowest_frequencies(K: csr_array, M: csr_array, count: int) -> Array:
    """Lowest frequencies [Hz] of a held body."""
    from scipy.sparse.linalg import LinearOperator, eigsh

    size = len(K.indptr) - 1
    inverse = LinearOperator((size, size), matvec=banded_solver(K), dtype=float)  # pyright: ignore
    start = np.random.default_rng(0).normal(size=size)
    squared = eigsh(K, count, M, sigma=0.0, OPinv=inverse, v0=start, return_eigenvectors=False)
    return np.sqrt(np.sort(squared)) / (2 * np.pi)
