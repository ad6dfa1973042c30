"""Shape functions of a leg and their closed integrals; quadrature happens here once, never in a kernel."""

from flexapod.bases.axial import AxialBasis, axial_basis
from flexapod.bases.catalogue import lateral_basis
from flexapod.bases.lateral import LateralBasis

__all__ = ["AxialBasis", "LateralBasis", "axial_basis", "lateral_basis"]
