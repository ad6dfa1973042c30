"""What an encoder does not tell apart, Eq. (T23.12)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

from flexapod.mechanics.elements.element import Contribution, Physics

if TYPE_CHECKING:
    from flexapod.model import Leg, Robot, Simulation


@dataclass(frozen=True)
class Resolution(Physics):
    """Of the encoder of a screw: the least `increment` of the stroke [m]."""

    increment: float

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Of a leg whose screw has an encoder with a resolution."""
        return cls(leg.screw.increment) if leg.screw is not None and leg.screw.increment else None

    @classmethod
    def among(cls, robot: Robot, simulation: Simulation) -> bool:
        """In no kernel: motions do not see it."""
        return False

    def errors(self, leg: Leg) -> Sequence[Contribution]:
        """Anywhere within an increment, alike."""
        how = "increment over the root of 12, legs independent"
        return (Contribution("encoder", "random", self.increment / 12**0.5, how),)
