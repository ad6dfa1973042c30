"""A piston that is not keyed: it takes the nut along as it turns in its cylinder, Eq. (T23.41)."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar, Self

from flexapod.mechanics.elements.element import LegContext, Named, Physics, SeriesSprings

if TYPE_CHECKING:
    from flexapod.model import Leg


@dataclass(frozen=True)
class TurningNut(Physics):
    """A nut that turns with the piston: its `travel` by that angle [m/rad]."""

    travel: float

    parameters: ClassVar[Named] = (("series_turn", 1),)

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Build the element of a leg whose piston turns with a screw's nut, unseen by its loop; None of others."""
        return cls(leg.turning) if leg.turning else None

    def numbers(self, leg: Leg, standing: LegContext) -> dict[str, Any]:
        """Travel of the nut by the piston's angle [m/rad]."""
        return {"series_turn": self.travel}

    @classmethod
    def in_series(cls, s: SeriesSprings, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> SeriesSprings:
        """Springs that end at the nut, which moves along as the piston turns."""
        return SeriesSprings(s.softer, s.nut - p.series_turn * q.spin, s.rate - p.series_turn * v.spin)
