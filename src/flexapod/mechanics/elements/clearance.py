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
        """Of a leg whose guide has one."""
        return cls(leg.guide.clearance) if leg.guide is not None and leg.guide.clearance else None

    @classmethod
    def among(cls, robot: Robot, simulation: Simulation) -> bool:
        """In no kernel: a leg that bears no moment leans one way or another."""
        return False

    def shorter(self, leg: Leg, length: float) -> float:
        """How much a leg of some length changes by leaning, at most [m]."""
        d, s = leg.overlap(length), length - leg.cylinder.mouth
        return 0.5 * (self.clearance / d) ** 2 * abs((s + d / 2) ** 2 / length - leg.piston.length)

    def errors(self, leg: Leg) -> Sequence[Contribution]:
        """Whichever way it leans."""
        how = "second order in the kink: legs that lean or do not"
        return (Contribution("guide play", "hysteretic", partial(self.shorter, leg), how),)
