"""Clearance of the bushings of a piston, in which a pinned leg leans without a force, Eq. (T25.17)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Self

from flexapod.mechanics.elements.element import Contribution, Physics

if TYPE_CHECKING:
    from flexapod.model import Leg, Robot, Simulation


@dataclass(frozen=True)
class Clearance(Physics):
    """Free travel across the leg in gland and head, of each [m]."""

    clearance: float

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Build the clearance of a leg whose guide has one; None of others."""
        return cls(leg.guide.clearance) if leg.guide is not None and leg.guide.clearance else None

    @classmethod
    def in_kernel(cls, robot: Robot, simulation: Simulation) -> bool:
        """Return False: no kernel has it, as a leg that bears no moment leans either way."""
        return False

    def shorter(self, leg: Leg, length: float) -> float:
        """Largest change of a leg's length by leaning in its bushings, at a length [m]."""
        d, s = leg.overlap(length), length - leg.cylinder.mouth
        return 0.5 * (self.clearance / d) ** 2 * abs((s + d / 2) ** 2 / length - leg.piston.length)

    def errors(self, leg: Leg) -> Sequence[Contribution]:
        """Hysteretic error of the stroke, as the leg leans either way."""
        how = "second order in the kink: legs that lean or do not"
        return (Contribution("guide play", "hysteretic", partial(self.shorter, leg), how),)
