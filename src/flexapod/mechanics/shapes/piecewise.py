"""Hermite cubics: beam elements of equal length on the free length, clamped at the mouth, Eq. (T1.15)."""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import Polynomial

from flexapod.common.arrays import Array

#: Displacement, and slope times element length, of an element's right and left node in u in [0, 1].
RISING = (Polynomial([0.0, 0.0, 3.0, -2.0]), Polynomial([0.0, 0.0, -1.0, 1.0]))
FALLING = (Polynomial([1.0, 0.0, -3.0, 2.0]), Polynomial([0.0, 1.0, -2.0, 1.0]))


@dataclass(frozen=True, kw_only=True)
class HermiteShape:
    """Displacement (``order`` 0) or slope times element length (1) of one at ``node`` of ``elements``, Eq. (T1.15)."""

    node: int
    elements: int
    order: int

    def __call__(self, zeta: Array, derivative: int = 0) -> Array:
        """Value (or ``derivative``-th derivative in zeta) at ``zeta`` (any shape), dimensionless."""
        u = np.asarray(zeta, dtype=float) * self.elements
        element = np.clip(np.floor(u), 0, self.elements - 1)
        left, right = (
            np.where(element == self.node + shift, part[self.order].deriv(derivative)(u - element), 0.0)
            for shift, part in ((-1, RISING), (0, FALLING))
        )
        return self.elements**derivative * (left + right)


def hermite_shapes(count: int) -> list[HermiteShape]:
    """Two shapes for each of ``count / 2`` elements: displacement and slope of their outer nodes; the tip is free.

    Raises
    ------
    ValueError
        Odd count (the study file is checked before).
    """
    if count % 2:
        raise ValueError(f"{count} shapes are not a whole number of beam elements: each has two")
    elements = count // 2
    return [HermiteShape(node=i, elements=elements, order=d) for i in range(1, elements + 1) for d in (0, 1)]
