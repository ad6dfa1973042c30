"""What a guide feels of a section: its mean lateral displacement and its mean rotation, Eqs. (T10.5)-(T10.6)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod.fem.section_mesh import SectionMesh
from flexapod.typing import Array, Mask

__all__ = ["SectionAverages", "free_unknowns", "section_averages"]


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
    """Averages over the nodes of a section mesh, by the same quadrature as the elements that stand on it."""
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
