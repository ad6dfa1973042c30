"""Resolution of an encoder as a random error of the stroke, Eq. (T23.12)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

from flexapod.mechanics.elements.element import Contribution, Physics

if TYPE_CHECKING:
    from flexapod.model import Leg, Robot, Simulation


@dataclass(frozen=True)
class Resolution(Physics):
    """Resolution of the encoder of a screw: the least `increment` of the stroke [m]."""

    increment: float

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Build the resolution of a leg whose screw has an encoder with one; None of others."""
        return cls(leg.screw.increment) if leg.screw is not None and leg.screw.increment else None

    @classmethod
    def in_kernel(cls, robot: Robot, simulation: Simulation) -> bool:
        """Return False: no kernel has it, as motions do not depend on it."""
        return False

    def errors(self, leg: Leg) -> Sequence[Contribution]:
        """Random error of the stroke, uniform within an increment."""
        how = "increment over the root of 12, legs independent"
        return (Contribution("encoder", "random", self.increment / 12**0.5, how),)
