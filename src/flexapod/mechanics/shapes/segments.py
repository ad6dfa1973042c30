"""Piecewise-linear shapes: rigid segments with hinge springs, Eqs. (T1.13)-(T1.14)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexapod.common.arrays import Array


@dataclass(frozen=True, kw_only=True)
class SegmentShape:
    """One at node ``node`` and zero at the others: ``count`` hinges at (j - 1/2)/count, and the tip, Eq. (T1.13)."""

    node: int
    count: int

    @cached_property
    def _knots(self) -> Array:
        hinges = (np.arange(self.count) + 0.5) / self.count
        return np.concatenate([[0.0], hinges, [1.0]])

    @cached_property
    def _values(self) -> Array:
        return np.eye(self.count + 2)[self.node + 2]  # the first hinge and the clamp stay at zero

    @cached_property
    def _slopes(self) -> Array:
        return np.diff(self._values) / np.diff(self._knots)

    def __call__(self, zeta: Array, derivative: int = 0) -> Array:
        """Value, slope or curvature at ``zeta`` (any shape), dimensionless; no higher derivatives.

        The curvature is the turn of a hinge spread over the segment of length 1/count around it, Eq. (T1.14): its
        square integrates to the hinges' energy, and times EI it is the moment of their springs.
        """
        z = np.asarray(zeta, dtype=float)
        if derivative == 0:
            return np.interp(z, self._knots, self._values)
        if derivative == 1:
            return self._slopes[np.clip(np.searchsorted(self._knots, z, side="right") - 1, 0, self.count)]
        if derivative == 2:
            return self.count * np.diff(self._slopes)[np.clip((z * self.count).astype(int), 0, self.count - 1)]
        return np.zeros_like(z)


def segment_shapes(count: int) -> list[SegmentShape]:
    """The ``count`` shapes of ``count`` equal segments between the hinges, half a one at the mouth and at the tip."""
    return [SegmentShape(node=j, count=count) for j in range(count)]
