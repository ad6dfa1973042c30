"""Matrices of a mesh of hexahedra: stiffness, mass and the stiffness of an axial stress, Eqs. (T10.1)-(T10.4)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.sparse import csr_array

from flexapod.fem.hexahedra import Integrals, element_stiffness
from flexapod.fem.mesh import SolidMesh
from flexapod.typing import Array

__all__ = ["field_load", "mass", "slope_stiffness", "stiffness"]


def stiffness(parts: Integrals, E: float, poisson: float) -> csr_array:
    """Elastic stiffness [N/m], (3n, 3n), Eq. (T10.1); isotropic, Young's modulus E [Pa]."""
    return _assembled(parts.mesh, element_stiffness(parts, E, poisson))


def mass(parts: Integrals, density: float) -> csr_array:
    """Consistent mass matrix [kg], (3n, 3n), Eq. (T10.2)."""
    scalar = (parts.weight * density) @ np.einsum("qa,qb->qab", parts.shape, parts.shape).reshape(len(parts.shape), -1)
    return _expanded(parts, scalar)


def slope_stiffness(parts: Integrals, stress: Callable[[Array], Array]) -> csr_array:
    """Stiffness of an axial stress [Pa] given over x, int stress u_,x . v_,x, (3n, 3n), Eq. (T10.3)."""
    along = parts.gradient[..., 0]
    weighted = along * (parts.weight * stress(parts.x[..., 0]))[..., None]
    return _expanded(parts, (weighted.transpose(0, 2, 1) @ along).reshape(len(along), -1))


def field_load(parts: Integrals, density: float, field: Callable[[Array], Array]) -> Array:
    """Load along y of a force ``density * field(x)`` per volume, (3n,), Eq. (T10.4)."""
    forces = (parts.weight * density * field(parts.x[..., 0])) @ parts.shape
    load = np.zeros(parts.mesh.unknowns)
    np.add.at(load, 3 * parts.mesh.elements + 1, forces)
    return load


def _expanded(parts: Integrals, scalar: Array) -> csr_array:
    """The same (m, a a) matrix for each of the three components."""
    a = parts.shape.shape[1]
    return _assembled(parts.mesh, np.einsum("mab,ij->maibj", scalar.reshape(-1, a, a), np.eye(3)))


def _assembled(mesh: SolidMesh, blocks: Array) -> csr_array:
    unknowns = (3 * mesh.elements[:, :, None] + np.arange(3)).reshape(len(mesh.elements), -1)
    rows = np.repeat(unknowns, unknowns.shape[1], axis=1).ravel()
    columns = np.tile(unknowns, unknowns.shape[1]).ravel()
    n = mesh.unknowns
    made = csr_array((blocks.ravel(), (rows, columns)), shape=(n, n))
    made.eliminate_zeros()
    return made
