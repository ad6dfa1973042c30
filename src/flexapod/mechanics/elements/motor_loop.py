"""Motor loop about a rotor: lagging force and integral action, Eqs. (T23.15)-(T23.16), (T23.51)-(T23.53).

The force follows what the loop measures, and may lag behind what it requests.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar, Self

from flexapod.mechanics.elements.element import LegContext, MovingLeg, Named, Physics, extra_loop_force

if TYPE_CHECKING:
    from flexapod.mechanics.symbolic.vocabulary import SX
    from flexapod.model import Leg, ScrewDrive


@dataclass(frozen=True)
class MotorLoop(Physics):
    """A motor that lags, or whose loop is closed about another place than its rotor: j is its impulse."""

    screw: ScrewDrive
    about: str  # the other place, see `model.Leg.closed_about`

    coordinates: ClassVar[Named] = (("j", 1),)
    parameters: ClassVar[Named] = (
        ("loop_stiffness", 1),  # N/m
        ("loop_damping", 1),  # N s/m
        ("loop_lag", 1),  # s
        ("loop_at_once", 1),  # 1 of a force that comes at once, else 0
        ("loop_at", 2),  # shares of the stroke and of the distance of the joints in what is measured
        ("loop_rate_at_rotor", 1),  # 1 where the rate is that of the rotor, else 0
    )
    absent: ClassVar[Mapping[str, Any]] = {"loop_lag": 1.0, "loop_at_once": 1.0}

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Build the loop of a screw whose motor is more than a spring and damper on its rotor; None of others."""
        return cls(leg.screw, leg.closed_about) if leg.screw is not None and leg.screw.loops else None

    def numbers(self, leg: Leg, standing: LegContext) -> dict[str, Any]:
        """Parameters of the loop; at rest one about another place is a spring of the drive there, Eq. (T23.55)."""
        screw, found = self.screw, {"loop_at": [float(self.about == place) for place in ("stroke", "joint-to-joint")]}
        if standing.at_rest and not self.about:
            return found
        found |= {"rotor_stiffness": 0.0, "rotor_damping": 0.0}
        if standing.at_rest:
            return found | {"series_stiffness": 0.0}
        found |= {"loop_stiffness": screw.loop_spring[0], "loop_damping": screw.loop_spring[1]}
        found["loop_rate_at_rotor"] = float(screw.encoder.rate == "rotor")
        return found | ({"loop_lag": screw.lag, "loop_at_once": 0.0} if screw.lag else {})

    @classmethod
    def prescribed(cls, own: Any, leg: Leg, standing: LegContext) -> Sequence[str]:
        """Impulse j of a force without lag; at rest also what the loop's place determines, Eq. (T23.55)."""
        if own is None or not standing.at_rest:
            return () if own is not None and own.screw.lag else ("j",)
        return ("j", *(("r",) if own.about else ()), *(("l",) if own.about and own.screw.rests else ()))

    @classmethod
    def place(cls, x: MovingLeg) -> SX:
        """Position that the loop measures, Eq. (T23.52)."""
        p, q = x.p, x.q
        return q.r + p.loop_at[0] * (q.l - q.r) + p.loop_at[1] * (x.distance - q.r)

    @classmethod
    def requested_force(cls, x: MovingLeg) -> SX:
        """Force that the loop requests of its motor, Eq. (T23.52)."""
        p, place = x.p, cls.place(x)
        rate = x.rate(place)
        rate = rate + p.loop_rate_at_rotor * (x.v.r - rate)
        held = p.loop_stiffness * (x.q_cmd - place) + p.loop_damping * (x.v_cmd - rate)
        more = extra_loop_force(x.elements, p, x.q)
        return held if more is None else held + more

    @classmethod
    def force(cls, x: MovingLeg, asked: SX) -> SX:
        """Force on the rotor: the requested force at once, or one that lags behind it."""
        return x.p.loop_at_once * asked + (1 - x.p.loop_at_once) * x.v.j

    @classmethod
    def nonpotential_force(cls, x: MovingLeg) -> Mapping[str, SX]:
        """Force on the rotor, and the requested force that it lags behind, Eq. (T23.53)."""
        asked = cls.requested_force(x)
        return {"r": -cls.force(x, asked), "j": -asked}

    @classmethod
    def inertia(cls, p: SimpleNamespace) -> Mapping[str, tuple[SX | float, SX | float]]:
        """Time constant of the force's lag as a mass of j, with a damper of 1, Eq. (T23.53)."""
        return {"j": (p.loop_lag, 1.0)}

    @classmethod
    def input_power(cls, x: MovingLeg) -> SX:
        """Power of the motor."""
        return cls.force(x, cls.requested_force(x)) * x.v.r


@dataclass(frozen=True)
class SummedError(Physics):
    """Integral w of the error of a loop: its `gain` [N/(m s)] by the travel that the rotor drives."""

    gain: float

    coordinates: ClassVar[Named] = (("w", 1),)
    parameters: ClassVar[Named] = (("rotor_integral", 1),)

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Build the integral of a leg whose screw has a loop with integral action; None of others."""
        return cls(leg.screw.integral) if leg.screw is not None and leg.screw.integral > 0 else None

    def numbers(self, leg: Leg, standing: LegContext) -> dict[str, Any]:
        """Integral gain of the loop."""
        return {"rotor_integral": self.gain}

    @classmethod
    def prescribed(cls, own: Any, leg: Leg, standing: LegContext) -> Sequence[str]:
        """Sum w without the element; w and r at rest, where integral action has left no error."""
        if own is None:
            return ("w",)
        return ("w", "r") if standing.at_rest else ()

    @classmethod
    def loop_force(cls, p: SimpleNamespace, q: SimpleNamespace) -> SX:
        """Force of the integral action."""
        return p.rotor_integral * q.w

    @classmethod
    def nonpotential_force(cls, x: MovingLeg) -> Mapping[str, SX]:
        """Error of the loop as rate of the sum w, Eq. (T23.16)."""
        return {"w": (x.rate(MotorLoop.place(x)) if x.holds(MotorLoop) else x.v.r) - x.v_cmd}

    @classmethod
    def inertia(cls, p: SimpleNamespace) -> Mapping[str, tuple[SX | float, SX | float]]:
        """Mass of 1 of w; its coupling to the rotor is slow, and left out of the iterations."""
        return {"w": (1.0, 0.0)}
