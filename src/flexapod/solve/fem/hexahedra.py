"""Hexahedra: meshes of straight beams and pistons, integration, matrices, Eqs. (T10.1)-(T10.4), (T10.25)-(T10.27).

A mesh is a section mesh extruded along the axis.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.model import Rectangle, Tube
from flexapod.solve.fem.section_mesh import Indices, SectionMesh, section_mesh

MOST = 1_000_000  # elements: some 10 million unknowns


@dataclass(frozen=True, kw_only=True)
class SolidMesh:
    """Hexahedra of a straight beam of `length` [m] along x, bending along y.

    `nodes` (n, 3) [m]: numbered from x = 0 to x = length, plane by plane; `elements` (m, 8) or (m, 20): nodes of each
    element from 0, in the order of Abaqus and CalculiX (C3D8, C3D20), four corners of the end at smaller x, four of the
    other end, then the middles of the edges of either end and of those along x; `section`: what was drawn out, says
    which halves are meshed.
    """

    nodes: Array
    elements: Indices
    section: SectionMesh
    length: float

    @property
    def kind(self) -> str:
        """Kind of the elements, one of `section_mesh.KINDS`."""
        return self.section.kind

    @property
    def unknowns(self) -> int:
        """Displacements of all nodes."""
        return self.nodes.size

    def plane(self, end: int) -> Indices:
        """Nodes of the end plane x = 0 (``end`` 0) or x = length (1), in the order of the section's points."""
        count = len(self.section.points)
        return np.arange(count) + (len(self.nodes) - count if end else 0)


def beam_mesh(
    section: Tube | Rectangle, length: float, size: float, *, kind: str = "hex20", whole: bool = True
) -> SolidMesh:
    """Hexahedra with edges near ``size`` [m] in a straight beam of ``length`` [m] along x.

    A rectangle bends along its height, which lies along y. `kind`: "hex20", quadratic serendipity elements, whose edges
    follow a circle, or linear ones, "hex8" with full integration, "hex8r" with reduced integration, "hex8i" with
    incompatible modes. `whole` section, else the half or quarter that bending in the plane of y leaves independent.

    InputError: a size that is not positive, longer than the beam or too small; an unknown kind; a beam without length.
    """
    _check(length, size)
    check_count(section, length, size, MOST)
    return extrude_section(section_mesh(section, size, kind, whole=whole), length, max(1, round(length / size)))


def _check(length: float, size: float) -> None:
    if not (np.isfinite(length) and length > 0):
        raise InputError("is not a length of a beam", key="length", value=length, allowed="above 0 m")
    if not (np.isfinite(size) and size > 0):
        raise InputError("is not a length of an element", key="size", value=size, allowed="above 0 m")
    if size > length:
        raise InputError(
            "makes an element longer than the beam",
            key="size",
            value=size,
            allowed=f"above 0, at most {length:g} m",
            next_step="Take a smaller element size",
        )


def check_count(section: Tube | Rectangle, length: float, size: float, most: int) -> None:
    """Refuse a mesh before it is made that would not fit into memory: more than ``most`` elements."""
    count = section.area * length / size**3
    if count > most:
        raise InputError(
            f"makes about {count:.2g} elements in {length:.3g} m",
            key="size",
            value=size,
            allowed=f"at most {most:,} of them there",
            next_step=f"Take elements of {(section.area * length / most) ** (1 / 3):.2g} m or more",
        )


def extrude_section(section: SectionMesh, length: float, layers: int) -> SolidMesh:
    """Solid mesh of ``layers`` equal layers of elements along ``length`` [m]."""
    quadratic = section.quads.shape[1] == 8
    count, middles = len(section.points), int(section.corners.sum())
    between = np.full(count, -1)
    between[section.corners] = np.arange(middles)
    step = count + (middles if quadratic else 0)
    x = np.linspace(0.0, length, layers + 1)
    planes: list[Array] = []
    for layer in range(layers + 1):
        planes.append(np.column_stack([np.full(count, x[layer]), section.points]))
        if quadratic and layer < layers:
            middle = section.points[section.corners]
            planes.append(np.column_stack([np.full(middles, 0.5 * (x[layer] + x[layer + 1])), middle]))
    corner, edge = section.quads[:, :4], section.quads[:, 4:]
    parts = [corner, corner + step]
    if quadratic:
        parts += [edge, edge + step, count + between[corner]]
    one = np.concatenate(parts, axis=1)
    elements = (one[None] + step * np.arange(layers)[:, None, None]).reshape(-1, one.shape[1])
    return SolidMesh(nodes=np.concatenate(planes), elements=elements, section=section, length=length)


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
