"""Shape functions of a leg and their closed integrals; quadrature happens here once, never in a kernel."""

from flexapod.mechanics.shapes.axial import AxialBasis, axial_basis
from flexapod.mechanics.shapes.lateral import LateralBasis
from flexapod.mechanics.shapes.registry import lateral_basis

__all__ = ["AxialBasis", "LateralBasis", "axial_basis", "lateral_basis"]
