"""Meshes of beam sections, straight or following a circle, and averages over them, Eqs. (T10.5)-(T10.6)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import InputError
from flexapod.model import Rectangle, Tube

#: An array of whole numbers.
Indices = NDArray[np.int_]

#: Kinds of solid elements and their nodes: linear hexahedra with full integration, with reduced integration and with
#: incompatible modes; quadratic serendipity ones.
KINDS = {"hex8": 8, "hex8r": 8, "hex8i": 8, "hex20": 20}

# Corners of a quadrilateral, then the middles of its edges, as steps of half an element.
_STEPS = np.array([[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1]])
_Patch = tuple[Callable[[Array, Array], Array], int, int]


@dataclass(frozen=True, kw_only=True)
class SectionMesh:
    """A section, or the half or quarter of it that bending in the plane of y leaves independent.

    `points` (n, 2): y (direction of bending) and z (across) [m]; `quads` (m, 4) or (m, 8): corners counter-clockwise
    seen against x, then middles of the edges; `corners` (n,): points that are corners, not middles; `half_y`, `half_z`:
    only y >= 0, only z >= 0 is meshed, the rest follows by symmetry; `kind` of the solid elements that stand on the
    quadrilaterals, one of `KINDS`.
    """

    points: Array
    quads: Indices
    corners: Mask
    half_y: bool = False
    half_z: bool = False
    kind: str = "hex20"

    @property
    def copies(self) -> int:
        """Number of copies of the meshed part in the whole section."""
        return (1 + self.half_y) * (1 + self.half_z)


def section_mesh(section: Tube | Rectangle, size: float, kind: str, *, whole: bool = True) -> SectionMesh:
    """Quadrilaterals of edges near ``size`` [m] in a section; at least one element lies across every thickness.

    A rectangle bends along its height. `kind` of the solid elements that stand on the quadrilaterals, one of `KINDS`.
    `whole`, else the half z >= 0, and of it only y >= 0 where no element lies across y = 0. InputError: unknown kind,
    or a size that is not positive.
    """
    if kind not in KINDS:
        raise InputError("is not a kind of solid element", key="kind", value=kind, allowed=", ".join(KINDS))
    if not (np.isfinite(size) and size > 0):
        raise InputError("is not a length of an element", key="size", value=size, allowed="above 0 m")
    patches = _rectangle(section, size, whole) if isinstance(section, Rectangle) else _round(section, size)
    joined = _joined(patches, kind == "hex20")
    return replace(joined if whole else _part(joined, 1e-6 * section.depth), kind=kind)


def _rectangle(section: Rectangle, size: float, whole: bool) -> list[_Patch]:
    rows, columns = max(1, round(section.height / size)), max(1, round(section.width / size))
    columns += 0 if whole else columns % 2

    def place(s: Array, t: Array) -> Array:
        return np.stack([section.height * (s - 0.5), section.width * (t - 0.5)], axis=-1)

    return [(place, rows, columns)]


def _round(section: Tube, size: float) -> list[_Patch]:
    """Sectors of 90 deg around the hole, or around a square core with bulging sides."""
    outer, inner = section.diameter / 2, (section.inner_diameter or 0.0) / 2
    around = 2 * max(1, round(np.pi * outer / 4 / size))  # even: planes of symmetry run along edges
    near, bulge = (inner, 1.0) if inner else (0.5 * outer, 0.25)
    across = max(1, round((outer - near) / size))
    rings = [(_sector(0.5 * np.pi * i, near, outer, bulge), across, around) for i in range(4)]
    return rings if inner else [*rings, (_core(near, bulge), around, around)]


def _sector(turn: float, near: float, outer: float, bulge: float) -> Callable[[Array, Array], Array]:
    c, s = np.cos(turn), np.sin(turn)

    def place(r: Array, t: Array) -> Array:
        angle = 0.5 * np.pi * (t - 0.5)
        circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        chord = np.stack([np.full_like(t, np.sqrt(0.5)), np.sqrt(2) * (t - 0.5)], axis=-1)
        start = near * (bulge * circle + (1 - bulge) * chord)
        return (start + r[..., None] * (outer * circle - start)) @ np.array([[c, s], [-s, c]])

    return place


def _core(radius: float, bulge: float) -> Callable[[Array, Array], Array]:
    """Square between the four inner sides of the sectors: a blend of its straight form and Coons' patch of a circle."""

    def place(s: Array, t: Array) -> Array:
        p, q = 2 * s - 1, 2 * t - 1
        straight = np.stack([p, q], axis=-1) * np.sqrt(0.5)
        angle_p, angle_q = 0.25 * np.pi * p, 0.25 * np.pi * q
        sides = np.stack([p * np.cos(angle_q) + np.sin(angle_p), q * np.cos(angle_p) + np.sin(angle_q)], axis=-1)
        return radius * (bulge * (sides - straight) + (1 - bulge) * straight)

    return place


def _joined(patches: list[_Patch], quadratic: bool) -> SectionMesh:
    """One mesh of all patches: a grid of half elements in each, equal points made one."""
    points: list[Array] = []
    quads: list[Indices] = []
    offset = 0
    for place, rows, columns in patches:
        s, t = np.meshgrid(np.linspace(0, 1, 2 * rows + 1), np.linspace(0, 1, 2 * columns + 1), indexing="ij")
        points.append(place(s, t).reshape(-1, 2))
        i, j = (2 * x.ravel() for x in np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij"))
        steps = _STEPS[: 8 if quadratic else 4]
        grid = (i[:, None] + steps[:, 0]) * (2 * columns + 1) + j[:, None] + steps[:, 1]
        quads.append(grid + offset)
        offset += s.size
    return _numbered(np.concatenate(points), np.concatenate(quads))


def _numbered(points: Array, quads: Indices) -> SectionMesh:
    """Only the points in use, each once, in ascending z, then y."""
    used = np.unique(quads)
    grain = 1e-7 * np.ptp(points, axis=0).max()
    keys = np.round(points[used][:, ::-1] / grain).astype(int)
    _, first, back = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    number = np.zeros(len(points), dtype=int)
    number[used] = back.ravel()
    renumbered = number[quads]
    corners = np.zeros(len(first), dtype=bool)
    corners[renumbered[:, :4]] = True
    return SectionMesh(points=points[used][first], quads=renumbered, corners=corners)


def _part(mesh: SectionMesh, near: float) -> SectionMesh:
    """Half z >= 0 of a section, and of it y >= 0 where no element lies across y = 0."""
    kept, halves = mesh.quads, []
    for axis in (0, 1):
        low, high = mesh.points[kept, axis].min(axis=1), mesh.points[kept, axis].max(axis=1)
        halves.append(not np.any((low < -near) & (high > near)))
        if halves[-1]:
            kept = kept[low > -near]
    part = _numbered(mesh.points, kept)
    return SectionMesh(points=part.points, quads=part.quads, corners=part.corners, half_y=halves[0], half_z=halves[1])


@dataclass(frozen=True, kw_only=True)
class SectionAverages:
    """Section of a mesh: `area` [m^2], `second_moment` [m^4], and how nodal displacements make averages.

    `deflection` (n,): mean of u_y; `rotation` (n,) [1/m]: times u_x the mean rotation towards y; `stretch` (n,): mean
    of u_x.
    """

    area: float
    second_moment: float
    deflection: Array
    rotation: Array

    @property
    def stretch(self) -> Array:
        """Weights of u_x in the mean axial displacement, (n,): those of u_y in the mean deflection."""
        return self.deflection


def section_averages(section: SectionMesh) -> SectionAverages:
    """Averages over the nodes of a section mesh, by the same quadrature as the elements extruded from it."""
    from skfem import ElementQuad1, ElementQuadS2
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefQuad

    linear = section.quads.shape[1] == 4
    element = ElementQuad1() if linear else ElementQuadS2()
    points, weights = get_quadrature(RefQuad, 3 if linear else 5)
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    places = np.concatenate([corners, (corners + np.roll(corners, -1, axis=0)) / 2])[: section.quads.shape[1]]
    locations = np.asarray(element.doflocs)
    values = [element.lbasis(points, int(np.argmin(np.abs(locations - p).sum(axis=1)))) for p in places]
    shape, local = np.array([v for v, _ in values]).T, np.array([d for _, d in values]).transpose(2, 0, 1)
    nodes = section.points[section.quads]
    area = np.linalg.det(np.einsum("mai,qaj->mqij", nodes, local)) * weights * section.copies
    y = np.einsum("qa,ma->mq", shape, nodes[..., 0])
    mean, moment = np.zeros((2, len(section.points)))
    np.add.at(mean, section.quads, area @ shape)
    np.add.at(moment, section.quads, (area * y) @ shape)
    whole, second = float(area.sum()), float((area * y**2).sum())
    return SectionAverages(area=whole, second_moment=second, deflection=mean / whole, rotation=-moment / second)


def free_unknowns(points: Array, section: SectionMesh) -> Mask:
    """Unknowns (3 a node) of nodes with y, z = ``points`` (n, 2) that bending in the plane of y leaves free, bool.

    u_x and u_z are odd in y, u_z is odd in z: they vanish on the cuts of a half or quarter.
    """
    near = 1e-9 * np.ptp(section.points, axis=0).max()
    free = np.ones((len(points), 3), dtype=bool)
    if section.half_y:
        free[np.abs(points[:, 0]) < near] = False, True, False
    if section.half_z:
        free[np.abs(points[:, 1]) < near, 2] = False
    return free.ravel()
