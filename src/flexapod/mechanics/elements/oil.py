"""Oil on both sides of a piston head: two springs side by side whose compliance goes with their length, Eq. (T23.2)."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar, Self

from flexapod.mechanics.elements.element import LegContext, Named, Physics, SeriesSprings
from flexapod.mechanics.elements.springs import oil_shares, springs_before_stroke

if TYPE_CHECKING:
    from flexapod.model import HydraulicDrive, Leg


@dataclass(frozen=True)
class Oil(Physics):
    """Two columns of oil of a hydraulic cylinder."""

    drive: HydraulicDrive

    #: Their share in the compliance of the springs before the stroke at home; of the two the share of the pushing one
    #: in their stiffness there; one over their lengths [1/m].
    parameters: ClassVar[Named] = (("oil", 4),)

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Build the oil of a leg with a hydraulic drive; None of others."""
        return None if leg.cylinder_of_oil is None else cls(leg.cylinder_of_oil)

    def numbers(self, leg: Leg, standing: LegContext) -> dict[str, Any]:
        """Shares and lengths of the columns at home."""
        return {"oil": oil_shares(springs_before_stroke(leg), standing.length)}

    @classmethod
    def in_series(cls, s: SeriesSprings, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> SeriesSprings:
        """Springs in series with the oil's compliance beyond that at home, over that of all springs there."""
        away = q.l - p.series_home
        share, push, longer, shorter = (p.oil[k] for k in range(4))
        more = share * (1 / (push / (1 + away * longer) + (1 - push) / (1 - away * shorter)) - 1)
        return SeriesSprings(s.softer + more, s.nut, s.rate)
