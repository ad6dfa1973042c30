"""A loop about a rotor that sums its error, Eqs. (T23.15)-(T23.16)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar, Self

from flexapod.mechanics.elements.element import Moving, Named, Physics, Standing
from flexapod.mechanics.elements.motor_loop import MotorLoop

if TYPE_CHECKING:
    from flexapod.mechanics.symbolic.vocabulary import SX
    from flexapod.model import Leg


@dataclass(frozen=True)
class SummedError(Physics):
    """The sum w of the error of a loop: its `gain` [N/(m s)] by the travel that the rotor drives."""

    gain: float

    coordinates: ClassVar[Named] = (("w", 1),)
    parameters: ClassVar[Named] = (("rotor_integral", 1),)

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Of a leg whose screw has a loop with an integral."""
        return cls(leg.screw.integral) if leg.screw is not None and leg.screw.integral > 0 else None

    def numbers(self, leg: Leg, standing: Standing) -> dict[str, Any]:
        """Its gain."""
        return {"rotor_integral": self.gain}

    @classmethod
    def held(cls, own: Any, leg: Leg, standing: Standing) -> Sequence[str]:
        """At rest it has left no error: then the rotor is where it is to be, and there is nothing to sum."""
        if own is None:
            return ("w",)
        return ("w", "r") if standing.at_rest else ()

    @classmethod
    def asked(cls, p: SimpleNamespace, q: SimpleNamespace) -> SX:
        """Force of the summed error."""
        return p.rotor_integral * q.w

    @classmethod
    def pushes(cls, x: Moving) -> Mapping[str, SX]:
        """The error is the rate of the sum, Eq. (T23.16)."""
        return {"w": (x.rate(MotorLoop.place(x)) if x.holds(MotorLoop) else x.v.r) - x.v_cmd}

    @classmethod
    def inertia(cls, p: SimpleNamespace) -> Mapping[str, tuple[SX | float, SX | float]]:
        """A mass of 1; what couples it to the rotor is slow, and left out of the iterations."""
        return {"w": (1.0, 0.0)}
