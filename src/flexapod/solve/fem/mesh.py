"""Hexahedral meshes of straight beams and pistons: a section mesh drawn out along the axis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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
        """Of the elements, one of `section_mesh.KINDS`."""
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
    return extruded(section_mesh(section, size, kind, whole=whole), length, max(1, round(length / size)))


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


def extruded(section: SectionMesh, length: float, layers: int) -> SolidMesh:
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
