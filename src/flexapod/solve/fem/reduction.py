"""Reduction of a solid beam to two scalars a station, and its shapes, Eqs. (T10.7)-(T10.11), (T10.22)-(T10.24).

Stations cut the long beam into equal intervals. One interval is meshed and condensed onto all unknowns of its
end planes; the chain of such intervals, conforming at the stations, is condensed onto section averages. The
basis of a leg has lateral shapes of its clamped solid piston, Eqs. (T10.22)-(T10.24).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csc_array, csr_array

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.mechanics.shapes.lateral import LateralBasis, integrate, proportional_damping
from flexapod.model import Rectangle, Tube
from flexapod.solve.fem.frequencies import check_material
from flexapod.solve.fem.hexahedra import (
    SolidMesh,
    check_count,
    extrude_section,
    field_load,
    integrals,
    mass,
    slope_stiffness,
    stiffness,
)
from flexapod.solve.fem.section_mesh import SectionAverages, free_unknowns, section_averages, section_mesh

MOST = 20_000  # elements of an interval: its condensation is dense, one or two gigabytes there


@dataclass(frozen=True, kw_only=True)
class StationModel:
    """A whole straight solid beam, not held, in its section averages (w, theta) at n + 1 stations.

    Stations lie at the distances ``xi = spacing * (0, 1, .. n)`` [m] from the tip; unknowns are w [m], theta [rad] of
    the first, the second, ... Matrices (2n + 2, 2n + 2), Eqs. (T10.9)-(T10.11): elastic `stiffness`, `mass`, `slopes`
    (3, ...), the stiffness of axial forces 1, xi and xi^2 [N]; `loads` (2, 2n + 2) of lateral forces rhoA and rhoA xi
    per length; `mass_per_length` [kg/m]; `section_size` [m]: largest extent of the section, end effects fade over a few
    of it; `unknowns`: displacements of the solid mesh of the whole beam.
    """

    spacing: float
    stiffness: Array
    mass: Array
    slopes: Array
    loads: Array
    mass_per_length: float
    section_size: float
    unknowns: int

    @property
    def stations(self) -> int:
        """Number of stations, the two ends included."""
        return len(self.stiffness) // 2

    @property
    def length(self) -> float:
        """Length of the whole beam [m]."""
        return self.spacing * (self.stations - 1)


def reduced_beam(
    section: Tube | Rectangle,
    length: float,
    size: float,
    *,
    E: float,
    density: float,
    poisson: float = 0.0,
    kind: str = "hex20",
    spacing: float | None = None,
) -> StationModel:
    """Solid beam of elements near ``size`` [m] condensed onto stations near ``spacing`` [m].

    `E` [Pa], `density` [kg/m^3], Poisson's ratio `poisson`; `kind` of elements as of `beam_mesh`; default `spacing`: a
    36th of the beam, at least one element. InputError: sizes that are not positive or do not fit, material that is not
    physical.
    """
    check_material(E, density, poisson)
    wanted = max(length / 36, size) if spacing is None else spacing
    _check(length, size, wanted)
    count = max(1, round(length / wanted))
    step = length / count
    check_count(section, step, size, MOST)
    across = section_mesh(section, size, kind, whole=False)
    interval = extrude_section(across, step, max(1, round(step / size)))
    averages = section_averages(across)
    blocks = _interval(interval, averages.area, E, density, poisson)
    return _chain(interval, averages, blocks, count, density)


def _check(length: float, size: float, spacing: float) -> None:
    for key, value in (("length", length), ("size", size), ("spacing", spacing)):
        if not (np.isfinite(value) and value > 0):
            raise InputError("is not a length", key=key, value=value, allowed="above 0 m")
    if size > spacing or 4 * spacing > length:
        raise InputError(
            "does not fit: elements are at most as long as the stations are apart, and these a quarter of the beam",
            key="size" if size > spacing or 4 * size > length else "spacing",
            value=size if size > spacing or 4 * size > length else spacing,
            allowed=f"size <= spacing <= {length / 4:g} m",
            next_step=f"Take elements of {length / 100:.2g} m or less; the stations then find their place",
        )


@dataclass(frozen=True, kw_only=True)
class _Interval:
    """Matrices of one interval on the free unknowns of its planes, that at smaller xi first; eta = xi - xi_0."""

    stiffness: Array
    mass: Array
    slopes: Array
    loads: Array


def _interval(mesh: SolidMesh, area: float, E: float, density: float, poisson: float) -> _Interval:
    """Condense an interval onto its end planes: T = [-K_ii^-1 K_ib; 1], Eq. (T10.7)."""
    from scipy.sparse.linalg import splu

    parts, length = integrals(mesh), mesh.length
    free = np.flatnonzero(free_unknowns(mesh.nodes[:, 1:], mesh.section))
    nodes = free // 3
    # x runs to the tip: the plane at x = length is the one at smaller xi.
    ends = [np.flatnonzero(np.isin(nodes, mesh.plane(end))) for end in (1, 0)]
    edge = np.concatenate(ends)
    inner = np.setdiff1d(np.arange(len(free)), edge)
    K = csr_array(stiffness(parts, E, poisson)[free][:, free])
    T = np.zeros((len(free), len(edge)))
    T[edge, np.arange(len(edge))] = 1.0
    if len(inner):
        T[inner] = -splu(csc_array(K[inner][:, inner])).solve(K[inner][:, edge].toarray())
    slopes = [slope_stiffness(parts, lambda x, n=n: (length - x) ** n / area)[free][:, free] for n in range(3)]
    loads = [field_load(parts, density, lambda x, n=n: (length - x) ** n)[free] for n in range(2)]
    return _Interval(
        stiffness=T.T @ (K @ T),
        mass=T.T @ (mass(parts, density)[free][:, free] @ T),
        slopes=np.array([T.T @ (G @ T) for G in slopes]),
        loads=np.array([load @ T for load in loads]),
    )


def _chain(
    interval: SolidMesh, averages: SectionAverages, blocks: _Interval, count: int, density: float
) -> StationModel:
    """Join ``count`` intervals and condense them onto section averages, Eqs. (T10.8)-(T10.11)."""
    H = interval.length
    T, size = _constraint_modes(interval, averages, blocks.stiffness, count)
    two = [T[j * size : (j + 2) * size] for j in range(count)]
    n = T.shape[1]
    K, M, G, p = np.zeros((n, n)), np.zeros((n, n)), np.zeros((3, n, n)), np.zeros((2, n))
    for j, t in enumerate(two):
        K += t.T @ blocks.stiffness @ t
        M += t.T @ blocks.mass @ t
        g, xi = np.array([t.T @ slope @ t for slope in blocks.slopes]), j * H
        G += np.array([g[0], xi * g[0] + g[1], xi**2 * g[0] + 2 * xi * g[1] + g[2]])
        q = blocks.loads @ t
        p += np.array([q[0], xi * q[0] + q[1]])
    section = interval.section
    step = 3 * (len(interval.nodes) - len(section.points))
    return StationModel(
        spacing=H,
        stiffness=_free(K, H),
        mass=0.5 * (M + M.T),
        slopes=0.5 * (G + G.transpose(0, 2, 1)),
        loads=p,
        mass_per_length=density * averages.area,
        section_size=float((np.ptp(section.points, axis=0) * [1 + section.half_y, 1 + section.half_z]).max()),
        unknowns=step * count + 3 * len(section.points),
    )


def _free(K: Array, H: float) -> Array:
    """K with the rounding residue of rigid motions (1e-11 of its entries) moved out of it, by its diagonal blocks.

    The residue would hold a long beam like an elastic foundation.
    """
    n = len(K) // 2
    blocks = K.reshape(n, 2, n, 2).transpose(0, 2, 1, 3).copy()
    arm = np.zeros((n, n, 2, 2))  # motion of station j when station i moves by (w, theta) and the beam is rigid
    arm[..., 0, 0], arm[..., 1, 1] = 1.0, 1.0
    arm[..., 0, 1] = H * (np.arange(n)[:, None] - np.arange(n))
    diagonal = np.arange(n)
    blocks[diagonal, diagonal] = 0.0
    own = -np.einsum("ijab,ijbc->iac", blocks, arm)
    blocks[diagonal, diagonal] = own
    free = blocks.transpose(0, 2, 1, 3).reshape(2 * n, 2 * n)
    return 0.5 * (free + free.T)


def _constraint_modes(
    interval: SolidMesh, averages: SectionAverages, stiffness: Array, count: int
) -> tuple[Array, int]:
    """Displacements of all planes, (planes * size, 2 * planes), of unit averages at one station, and size of a plane.

    The chain is singular; adding C^T C (scaled) for the held averages changes no solution and makes it regular.
    """
    from scipy.sparse import block_diag, kron
    from scipy.sparse.linalg import splu

    size, planes = len(stiffness) // 2, count + 1
    C = _averages_of(interval, averages)
    scale = np.diag(stiffness).max() / (C**2).sum(axis=1)
    K = csr_array((planes * size, planes * size))
    shift = csr_array(np.eye(planes, k=1)[:count]), csr_array(np.eye(planes)[:count])
    place = [kron(s, csr_array(np.eye(size))) for s in (shift[1], shift[0])]  # first plane, second plane
    one = csr_array(np.eye(count))
    for a in range(2):
        for b in range(2):
            part = stiffness[a * size : (a + 1) * size, b * size : (b + 1) * size]
            K = K + place[a].T @ kron(one, csr_array(part)) @ place[b]
    big = csr_array(block_diag([C] * planes))
    K = K + block_diag([C.T @ np.diag(scale) @ C] * planes)
    modes = splu(csc_array(K)).solve(big.T.toarray())
    forces = np.linalg.inv(big @ modes)
    kept = np.arange(planes * len(C)).reshape(planes, len(C))[:, :2].ravel()
    return modes @ forces[:, kept], size


def _averages_of(interval: SolidMesh, averages: SectionAverages) -> Array:
    """Rows (w, theta, and mean axial displacement where it is not zero by symmetry) on a plane's free unknowns."""
    section = interval.section
    rows = np.zeros((2 if section.half_y else 3, 3 * len(section.points)))
    rows[0, 1::3], rows[1, 0::3] = averages.deflection, averages.rotation
    if not section.half_y:
        rows[2, 0::3] = averages.stretch
    return rows[:, free_unknowns(section.points, section)]


_INTERVALS = 24


def solid_leg_shapes(
    section: Tube | Rectangle,
    length: float,
    count: int,
    size: float | None = None,
    *,
    poisson: float = 0.0,
    moment: bool = False,
) -> LateralBasis:
    """Lateral basis of a solid piston held by a guide: static tip-load shape, then modes with the tip held.

    Shapes are section averages of deflection and rotation at 24 equal intervals, cubic between them; the stiffness is
    the solid's strain energy at ``length``, shear and mouth included. Material cancels but for Poisson's ratio.

    `length`: free length of the piston [m]; the basis is used at other lengths with the stiffness scaled as that of a
    beam. `count`: shapes, 1 to 12. `size`: wanted edge of the elements [m], default a sixth of the larger side of the
    section, at most an interval. `moment`: the tip takes a moment from a joint, the static shape under one takes the
    place of the last mode. InputError: sizes or counts that do not fit.
    """
    if not 1 <= count <= 12:
        raise InputError("is not a number of shapes", key="count", value=count, allowed="1 to 12")
    if not (np.isfinite(length) and length > 0):
        raise InputError("is not a length", key="length", value=length, allowed="above 0 m")
    spacing = length / _INTERVALS
    # Quadratic elements need no second one across the smaller side of a section.
    side = max(section.width, section.height) if isinstance(section, Rectangle) else section.diameter
    # Behind the mouth as much as the section's end effects need to fade.
    held = max(4, int(np.ceil(3 * section.depth / spacing)))
    model = reduced_beam(
        section,
        spacing * (_INTERVALS + held),
        min(side / 6, spacing) if size is None else size,
        E=1.0 / section.second_moment,
        density=1.0 / section.area,
        poisson=poisson,
        spacing=spacing,
    )
    shapes, stiffness = _shapes(model, length, count, moment)
    basis = integrate("solid-fem", shapes, pieces=_INTERVALS)
    damping = proportional_damping(basis.mass[:count, :count], stiffness)
    return replace(basis, stiffness=stiffness, damping=damping)


def _shapes(model: StationModel, length: float, count: int, moment: bool) -> tuple[list[Callable[..., Array]], Array]:
    """Shapes over zeta and their stiffness matrix K^ (count, count), of EI = rhoA = 1."""
    from scipy.linalg import eigh

    n = 2 * _INTERVALS
    K, M = model.stiffness[:n, :n], model.mass[:n, :n]
    unit = np.zeros(n)
    unit[0] = 1.0
    load = np.linalg.solve(K, unit)
    vectors = np.zeros((n, count))
    vectors[:, 0] = load / load[0]
    K_held, M_held = K[1:, 1:], M[1:, 1:]
    modes = eigh(K_held, M_held)[1][:, : count - 1]
    if moment and count > 1:
        span = np.column_stack([np.linalg.solve(K_held, unit[:-1]), modes[:, :-1]])
        modes = span @ eigh(span.T @ K_held @ span, span.T @ M_held @ span)[1]
    vectors[1:, 1:] = modes * np.sqrt(length)
    # The last free station is the one nearest to the mouth: positive there, as in the other bases.
    vectors *= np.sign(vectors[-2])
    stiffness = length**3 * vectors.T @ K @ vectors
    return [_shape(v, length) for v in vectors.T], 0.5 * (stiffness + stiffness.T)


def _shape(averages: Array, length: float) -> Callable[..., Array]:
    """Cubic between stations with the given (w, theta) from the tip to the mouth, where both vanish."""
    from scipy.interpolate import CubicHermiteSpline

    values = np.concatenate([[0.0], averages[0::2][::-1]])
    slopes = np.concatenate([[0.0], averages[1::2][::-1]]) * length
    spline = CubicHermiteSpline(np.linspace(0.0, 1.0, len(values)), values, slopes)

    def shape(zeta: Array, derivative: int = 0) -> Array:
        return spline(np.asarray(zeta, dtype=float), derivative)

    return shape
