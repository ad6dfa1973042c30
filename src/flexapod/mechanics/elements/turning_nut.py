"""A piston that is not keyed: it takes the nut along as it turns in its cylinder, Eq. (T23.41)."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar, Self

from flexapod.mechanics.elements.element import Named, Physics, SeriesSprings, Standing

if TYPE_CHECKING:
    from flexapod.model import Leg


@dataclass(frozen=True)
class TurningNut(Physics):
    """A nut that turns with the piston: its `travel` by that angle [m/rad]."""

    travel: float

    parameters: ClassVar[Named] = (("series_turn", 1),)

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Of a screw's leg whose piston turns, outside of a loop that would see it."""
        return cls(leg.turning) if leg.turning else None

    def numbers(self, leg: Leg, standing: Standing) -> dict[str, Any]:
        """Its travel."""
        return {"series_turn": self.travel}

    @classmethod
    def in_series(cls, s: SeriesSprings, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> SeriesSprings:
        """The springs end at the nut, which is on its way along the piston."""
        return SeriesSprings(s.softer, s.nut - p.series_turn * q.spin, s.rate - p.series_turn * v.spin)
