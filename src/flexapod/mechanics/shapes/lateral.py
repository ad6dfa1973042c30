"""A lateral basis is data: the closed integrals of its shapes, Eqs. (T1.6)-(T1.9)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from flexapod.common.arrays import Array
from flexapod.mechanics.shapes.beam_functions import eigh, gauss_pieces

Shape = Callable[..., Array]

#: Powers of (1 - zeta) whose moments are kept: the coupling with the axial sine shapes is a polynomial of this degree.
MOMENTS = 26


@dataclass(frozen=True, kw_only=True, eq=False)
class LateralBasis:
    """k shapes phi_i(zeta), zeta in [0, 1] from the mouth to the tip, with all integrals the mechanics needs.

    Attributes
    ----------
    name : str
        Name in the study file.
    shapes : sequence of callables
        ``phi(zeta, derivative)``.
    tip, tip_slope : (k,) arrays
        phi(1) and phi'(1).
    mass : (2k, 2k) array
        int Phi Phi^T of the extended shapes Phi = [phi; (1 - zeta) phi'], Eq. (T1.6): sliding adds the second half.
    first, moment : (2k,) arrays
        int Phi and int zeta Phi, Eq. (T1.7).
    powers : (MOMENTS, 2k) array
        int (1 - zeta)^j Phi, Eq. (T1.7).
    stiffness : (k, k) array
        int phi'' phi''^T, Eq. (T1.8).
    slope_tip, slope_first, slope_moment : (k, k) arrays
        int phi' phi'^T, int (1 - zeta) phi' phi'^T, int (1 - zeta^2)/2 phi' phi'^T: foreshortening, Eq. (T1.9).
    turn : (k, k) array
        int phi' phi''^T - phi'' phi'^T, antisymmetric: how far bending in two planes turns the tip, Eq. (T1.17).
    damping : (k, k) array
        Equal damping ratio for every clamped-free mode of the bare piston, Eq. (T5.2).
    """

    name: str
    shapes: Sequence[Shape]
    tip: Array
    tip_slope: Array
    mass: Array
    first: Array
    moment: Array
    powers: Array
    stiffness: Array
    slope_tip: Array
    slope_first: Array
    slope_moment: Array
    turn: Array
    damping: Array

    @property
    def count(self) -> int:
        """Number of shapes k in one plane."""
        return len(self.tip)

    def values(self, zeta: Array, derivative: int = 0) -> Array:
        """Shapes (or derivatives in zeta) at ``zeta`` of any shape: (k, ...), dimensionless."""
        return np.array([phi(zeta, derivative) for phi in self.shapes]).reshape(self.count, *np.shape(zeta))


def proportional_damping(mass: Array, stiffness: Array) -> Array:
    """D^ = M^(1/2) (M^(-1/2) K M^(-1/2))^(1/2) M^(1/2), Eq. (T5.2); 2 zeta D^ damps every mode with the ratio zeta.

    With modal vectors X (X^T M X = 1, X^T K X = W^2) the same matrix is M X W X^T M.
    """
    if not len(mass):
        return np.zeros_like(mass)
    squared, vectors = eigh(stiffness, mass)
    half = mass @ vectors
    return (half * np.sqrt(squared)) @ half.T


def _clean(matrix: Array) -> Array:
    """Set the rounding residues of exact orthogonalities to zero, so that kernels skip them."""
    scale = np.sqrt(np.abs(np.outer(np.diag(matrix), np.diag(matrix))))
    return np.where(np.abs(matrix) < 1e-13 * scale, 0.0, matrix)


def integrate(name: str, shapes: Sequence[Shape], pieces: int = 1) -> LateralBasis:
    """Evaluate every closed integral of ``shapes`` by Gauss-Legendre quadrature, once.

    Parameters
    ----------
    name : str
    shapes : sequence of callables
        ``phi(zeta, derivative)``.
    pieces : int
        Equal pieces of [0, 1] inside which the shapes and their derivatives are smooth.
    """
    zeta, weight = gauss_pieces(pieces)
    count = len(shapes)

    def table(derivative: int) -> Array:
        return np.array([phi(zeta, derivative) for phi in shapes]).reshape(count, zeta.size)

    def ends(derivative: int) -> Array:
        return np.array([phi(np.ones(1), derivative)[0] for phi in shapes])

    phi, slope, curvature = table(0), table(1), table(2)
    rest = 1.0 - zeta
    extended = np.concatenate([phi, rest * slope])
    bent = (slope * weight) @ curvature.T
    mass, stiffness = _clean((extended * weight) @ extended.T), _clean((curvature * weight) @ curvature.T)
    return LateralBasis(
        name=name,
        shapes=tuple(shapes),
        tip=ends(0),
        tip_slope=ends(1),
        mass=mass,
        first=extended @ weight,
        moment=extended @ (weight * zeta),
        powers=np.array([extended @ (weight * rest**j) for j in range(MOMENTS)]),
        stiffness=stiffness,
        slope_tip=(slope * weight) @ slope.T,
        slope_first=(slope * weight * rest) @ slope.T,
        slope_moment=(slope * weight * 0.5 * (1.0 - zeta**2)) @ slope.T,
        turn=bent - bent.T,
        damping=_clean(proportional_damping(mass[:count, :count], stiffness)),
    )
