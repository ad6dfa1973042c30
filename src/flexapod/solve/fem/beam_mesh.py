"""Hermite beam elements fixed to the sliding beam of an actuator, Eqs. (T11.1)-(T11.4)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray

from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.mechanics.shapes.piecewise import FALLING, RISING
from flexapod.model import Actuator

Indices = NDArray[np.int_]

#: Upper diagonals besides the main one: an element joins displacement and slope of two neighbouring nodes.
HALF_BAND = 3
_SHAPES = (FALLING[0], FALLING[1], RISING[0], RISING[1])


@dataclass(frozen=True, kw_only=True)
class BeamGrid:
    """`elements` of equal length on the whole `beam`; unknowns are deflection [m] and slope of every node."""

    beam: Actuator
    elements: int

    @property
    def size(self) -> float:
        """Length of an element [m]."""
        return self.beam.length / self.elements

    @property
    def unknowns(self) -> int:
        """Number of unknowns, from the inner end on; the last two are deflection and slope of the tip."""
        return 2 * self.elements + 2

    def rows(self, local: Array, order: Indices | int = 0) -> Array:
        """Weights (..., 4) of an element's unknowns in the ``order``-th derivative along the beam at ``local``.

        ``local`` in [0, 1] from the inner to the outer node; ``order`` 0 to 2, of the same shape or one for all.
        """
        places = np.asarray(local, dtype=float)
        orders = np.broadcast_to(np.asarray(order, dtype=int), places.shape)[..., None]
        unit = np.array([1.0, self.size, 1.0, self.size])
        kinds = [np.stack([shape.deriv(d)(places) for shape in _SHAPES], axis=-1) for d in range(3)]
        chosen = np.choose(orders, kinds)
        return unit * chosen / self.size**orders

    def assemble_band(self, element: Indices, matrices: Array) -> Array:
        """Band matrix (4, 2 n + 2) of symmetric ``matrices`` (P, 4, 4) on the unknowns of ``element`` (P,)."""
        band = np.zeros((HALF_BAND + 1, self.unknowns))
        for i in range(4):
            for j in range(i, 4):
                sums = np.bincount(element, matrices[:, i, j], minlength=self.elements)
                band[HALF_BAND - (j - i), j : j + 2 * self.elements : 2] += sums
        return band

    def assemble_vector(self, element: Indices, vectors: Array) -> Array:
        """Vector (2 n + 2,) of ``vectors`` (P, 4) on the unknowns of ``element`` (P,)."""
        whole = np.zeros(self.unknowns)
        for i in range(4):
            whole[i : i + 2 * self.elements : 2] += np.bincount(element, vectors[:, i], minlength=self.elements)
        return whole


@dataclass(frozen=True, kw_only=True)
class BeamMesh(BeamGrid):
    """A grid with its matrices.

    `mass`, `transverse`, `bending`, `tension`, `spin` (4, 2 n + 2): symmetric, in upper band form, inertia with and
    without that of the tip body's rotation, EI u'' u''^T, and the integrals of the two parts of the axial force, Eqs.
    (T11.3)-(T11.4); `push`, `turn` (2 n + 2,): lateral loads per uniform acceleration, and what an angular acceleration
    adds by distance from the tip.
    """

    mass: Array = field(repr=False)
    transverse: Array = field(repr=False)
    bending: Array = field(repr=False)
    tension: Array = field(repr=False)
    spin: Array = field(repr=False)
    push: Array = field(repr=False)
    turn: Array = field(repr=False)


def band_product(band: Array, vector: Array) -> Array:
    """Symmetric matrix in upper band form times a vector (N,)."""
    product = band[HALF_BAND] * vector
    for offset in range(1, HALF_BAND + 1):
        diagonal = band[HALF_BAND - offset, offset:]
        product[:-offset] += diagonal * vector[offset:]
        product[offset:] += diagonal * vector[:-offset]
    return product


def gauss() -> tuple[Array, Array]:
    """Four Gauss points on [0, 1] and their weights: exact for products of two cubics."""
    x, w = leggauss(4)
    return (x + 1) / 2, w / 2


def beam_mesh(beam: Actuator, elements: int) -> BeamMesh:
    """Mesh of ``elements`` equal elements on the whole ``beam``.

    InputError: fewer than four elements, or a beam with damping, which has no meaning at fixed material points.
    """
    if elements < 4:
        raise InputError("is too few for a beam that is partly in its guide", key="elements", value=elements,
                         allowed="4 or more")  # fmt: skip
    if beam.damping:
        raise InputError(
            "is not modelled by a mesh that slides: damping belongs to the shapes of the free length",
            key="actuator.damping",
            value=beam.damping,
            allowed="0",
            next_step='Choose fidelity = "beam-fem" or "assumed-modes"',
        )
    grid = BeamGrid(beam=beam, elements=elements)
    local, weight = gauss()
    return _filled(grid, np.tile(local, elements), np.tile(weight, elements) * grid.size)


def _filled(grid: BeamGrid, local: Array, weight: Array) -> BeamMesh:
    """The grid with its matrices, by quadrature at ``local`` places with ``weight`` [m], (4 n,) both, Eq. (T11.3)."""
    beam, element = grid.beam, np.repeat(np.arange(grid.elements), 4)
    xi = beam.length - grid.size * (element + local)  # distance from the tip
    value, slope, curvature = (grid.rows(local, order) for order in range(3))

    def integral(rows: Array, factor: Array | float) -> Array:
        return grid.assemble_band(element, (factor * weight)[:, None, None] * rows[:, :, None] * rows[:, None, :])

    transverse = integral(value, beam.rhoA)
    transverse[HALF_BAND, -2] += beam.tip_mass
    mass = transverse.copy()
    mass[HALF_BAND, -1] += beam.tip_inertia
    push = grid.assemble_vector(element, (beam.rhoA * weight)[:, None] * value)
    push[-2] += beam.tip_mass
    turn = grid.assemble_vector(element, (beam.rhoA * xi * weight)[:, None] * value)
    turn[-1] -= beam.tip_inertia
    return BeamMesh(
        beam=beam,
        elements=grid.elements,
        mass=mass,
        transverse=transverse,
        bending=integral(curvature, beam.EI),
        tension=integral(slope, beam.rhoA * xi + beam.tip_mass),
        spin=integral(slope, beam.rhoA * xi**2 / 2),
        push=push,
        turn=turn,
    )
