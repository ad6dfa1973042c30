"""Play of a leg as a gap in the springs before its piston, Eqs. (T16.26)-(T16.27)."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeVar

from flexapod.mechanics.elements.element import Named, Physics, Standing

if TYPE_CHECKING:
    from flexapod.mechanics.symbolic.vocabulary import SX
    from flexapod.model import Leg, Robot, Simulation

ROUNDED = 0.2  # width over half of the play within which the gap's edges are rounded
LEAST = 1e-9  # m, of a leg without play

T = TypeVar("T")


@dataclass(frozen=True)
class Gap(Physics):
    """Free travel along a leg, `half` to either side [m]."""

    half: float

    parameters: ClassVar[Named] = (("half_play", 1),)

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Of a leg with play and with springs before its piston."""
        return cls(leg.half_play) if leg.half_play and leg.gives else None

    @classmethod
    def among(cls, robot: Robot, simulation: Simulation) -> bool:
        """Where the simulation takes play for a gap."""
        return simulation.play == "gap" and super().among(robot, simulation)

    def numbers(self, leg: Leg, standing: Standing) -> dict[str, Any]:
        """Half of the play."""
        return {"half_play": self.half}

    @classmethod
    def past(cls, x: SX, rate: SX, p: SimpleNamespace) -> tuple[SX, SX]:
        """The springs touch past the play only, Eqs. (T16.26)-(T16.27)."""
        return past_gap(x, p.half_play), touching(x, p.half_play) * rate


def past_gap(x: T, half: Any) -> T:
    """How far a displacement x is past the edges of a gap that is `half` wide on either side. Numbers and symbols."""
    rounding = (ROUNDED * half) ** 2 + LEAST**2  # type: ignore[operator]
    return x - 0.5 * (((x + half) ** 2 + rounding) ** 0.5 - ((x - half) ** 2 + rounding) ** 0.5)  # type: ignore[operator]


def touching(x: T, half: Any) -> T:
    """Its derivative by x: 0 within the gap, 1 past it, Eq. (T16.27)."""
    rounding = (ROUNDED * half) ** 2 + LEAST**2  # type: ignore[operator]
    right, left = x + half, x - half  # type: ignore[operator]
    return 1 - 0.5 * (right / (right**2 + rounding) ** 0.5 - left / (left**2 + rounding) ** 0.5)
