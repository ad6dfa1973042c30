"""Play of a leg as a gap in the springs before its piston, Eqs. (T16.26)-(T16.27)."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeVar

from flexapod.mechanics.elements.element import LegContext, Named, Physics

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
        """Build the gap of a leg with play and with springs before its piston; None of others."""
        return cls(leg.half_play) if leg.half_play and leg.gives else None

    @classmethod
    def in_kernel(cls, robot: Robot, simulation: Simulation) -> bool:
        """Test whether the simulation models play as a gap, and some leg has it."""
        return simulation.play == "gap" and super().in_kernel(robot, simulation)

    def numbers(self, leg: Leg, standing: LegContext) -> dict[str, Any]:
        """Half of the play of the leg."""
        return {"half_play": self.half}

    @classmethod
    def gap_deflection(cls, x: SX, rate: SX, p: SimpleNamespace) -> tuple[SX, SX]:
        """Stretch of springs that touch past the play only, and its rate, Eqs. (T16.26)-(T16.27)."""
        return dead_zone(x, p.half_play), dead_zone_slope(x, p.half_play) * rate


def dead_zone(x: T, half: Any) -> T:
    """Displacement x beyond the edges of a gap `half` wide on either side; of numbers or symbols."""
    rounding = (ROUNDED * half) ** 2 + LEAST**2  # type: ignore[operator]
    return x - 0.5 * (((x + half) ** 2 + rounding) ** 0.5 - ((x - half) ** 2 + rounding) ** 0.5)  # type: ignore[operator]


def dead_zone_slope(x: T, half: Any) -> T:
    """Derivative of `dead_zone` by x: 0 within the gap, 1 past it, Eq. (T16.27)."""
    rounding = (ROUNDED * half) ** 2 + LEAST**2  # type: ignore[operator]
    right, left = x + half, x - half  # type: ignore[operator]
    return 1 - 0.5 * (right / (right**2 + rounding) ** 0.5 - left / (left**2 + rounding) ** 0.5)
