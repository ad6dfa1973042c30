"""Hexahedra: shape functions, integration, matrices of a mesh, Eqs. (T10.1)-(T10.4), (T10.25)-(T10.27)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.solve.fem.mesh import SolidMesh

_HOURGLASS = 0.005  # share of the shear modulus that holds the patterns which reduced integration does not see
# Corners of the reference cube in the order of Abaqus; middles of edges follow as pairs of corners.
_CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])
_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]


@dataclass(frozen=True, kw_only=True)
class Integrals:
    """Shape functions of all elements at their Gauss points, fully integrated (2 or 3 points a direction).

    `x` (m, q, 3): points [m]; `weight` (m, q): volumes [m^3], those of the symmetric copies counted in; `shape` (q, a)
    and `gradient` (m, q, a, 3) [1/m] of the shape functions; `places` (q, 3): the points in the reference cube [0,
    1]^3; `jacobian` (m, q, 3, 3): dx_i / dxi_j there [m].
    """

    mesh: SolidMesh
    x: Array
    weight: Array
    shape: Array
    gradient: Array
    places: Array
    jacobian: Array


def integrals(mesh: SolidMesh) -> Integrals:
    """Shape functions, gradients and volumes at the Gauss points; refuses elements that are degenerate."""
    from skfem import ElementHex1, ElementHexS2
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefHex

    element = ElementHexS2() if mesh.kind == "hex20" else ElementHex1()
    points, weights = get_quadrature(RefHex, 5 if mesh.kind == "hex20" else 3)
    places = np.concatenate([_CORNERS, [(_CORNERS[i] + _CORNERS[j]) / 2 for i, j in _EDGES]])
    locations = np.asarray(element.doflocs)
    order = [int(np.argmin(np.abs(locations - p).sum(axis=1))) for p in places[: mesh.elements.shape[1]]]
    values = [element.lbasis(points, i) for i in order]
    shape = np.array([phi for phi, _ in values]).T
    local = np.array([slope for _, slope in values]).transpose(2, 0, 1)  # (q, a, 3)
    corners = mesh.nodes[mesh.elements]
    jacobian = np.einsum("mai,qaj->mqij", corners, local)
    size = np.linalg.det(jacobian)
    if not size.min() > 0:
        raise InputError(
            "has an element that is degenerate or turned inside out",
            key="mesh",
            value=f"element {int(size.min(axis=1).argmin()) + 1} of {len(size)}",
            allowed="positive Jacobians at all Gauss points",
            next_step="Check the coordinates of its nodes and their order",
        )
    return Integrals(
        mesh=mesh,
        x=np.einsum("qa,mai->mqi", shape, corners),
        weight=size * weights * mesh.section.copies,
        shape=shape,
        gradient=np.einsum("qaj,mqji->mqai", local, np.linalg.inv(jacobian)),
        places=np.asarray(points).T,
        jacobian=jacobian,
    )


def element_stiffness(parts: Integrals, E: float, poisson: float) -> Array:
    """Stiffness of each element [N/m], (m, a, 3, a, 3); isotropic, Young's modulus E [Pa]."""
    lame, shear = E * poisson / ((1 + poisson) * (1 - 2 * poisson)), 0.5 * E / (1 + poisson)
    if parts.mesh.kind == "hex8r":
        return _reduced(parts, lame, shear)
    if parts.mesh.kind == "hex8i":
        return _incompatible(parts, lame, shear)
    return _integrated(parts.gradient, parts.weight, lame, shear)


def _integrated(gradient: Array, weight: Array, lame: float, shear: float) -> Array:
    """Eq. (T10.1) at the points of integration given."""
    m, q, a, _ = gradient.shape
    flat = gradient.reshape(m, q, 3 * a)
    s = ((flat * weight[..., None]).transpose(0, 2, 1) @ flat).reshape(m, a, 3, a, 3)  # int N_a,i N_b,j
    traces = np.einsum("makbk->mab", s)
    blocks = lame * s + shear * s.transpose(0, 1, 4, 3, 2)
    return blocks + shear * np.einsum("mab,ij->maibj", traces, np.eye(3))


def _reduced(parts: Integrals, lame: float, shear: float) -> Array:
    """One strain in the element, the mean one, and a weak stiffness against what that does not see, Eq. (T10.25)."""
    volume = parts.weight.sum(axis=1)
    mean = np.einsum("mq,mqai->mai", parts.weight, parts.gradient) / volume[:, None, None]
    x, y, z = 2.0 * _CORNERS.T - 1.0
    pattern = np.stack([y * z, z * x, x * y, x * y * z]) / np.sqrt(8)
    linear = np.einsum("ha,mai->mhi", pattern, parts.mesh.nodes[parts.mesh.elements])
    unseen = pattern - np.einsum("mhi,mai->mha", linear, mean)
    size = _HOURGLASS * shear * volume * np.einsum("mai,mai->m", mean, mean)
    held = size[:, None, None] * np.einsum("mha,mhb->mab", unseen, unseen)
    return _integrated(mean[:, None], volume[:, None], lame, shear) + np.einsum("mab,ij->maibj", held, np.eye(3))


def _incompatible(parts: Integrals, lame: float, shear: float) -> Array:
    """Three parabolas of each displacement in every element, condensed there, Eqs. (T10.26)-(T10.27)."""
    corners = parts.mesh.nodes[parts.mesh.elements]
    centre = np.einsum("mai,aj->mij", corners, (2.0 * _CORNERS - 1.0) / 4)
    slope = -4 * (2 * parts.places - 1)[:, :, None] * np.eye(3)  # of 1 - (2 xi - 1)^2
    ratio = np.linalg.det(centre)[:, None] / np.linalg.det(parts.jacobian)
    own = np.einsum("mq,qbj,mji->mqbi", ratio, slope, np.linalg.inv(centre))
    K = _integrated(np.concatenate([parts.gradient, own], axis=2), parts.weight, lame, shear).reshape(-1, 33, 33)
    shapes, inner = K[:, :24, :24], K[:, 24:, :24]
    return (shapes - inner.transpose(0, 2, 1) @ np.linalg.solve(K[:, 24:, 24:], inner)).reshape(-1, 8, 3, 8, 3)


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
