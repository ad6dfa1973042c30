"""A motor whose force lags behind what its loop asks for, by what that measures, Eqs. (T23.51)-(T23.53).

A loop about a rotor that sums its error, Eqs. (T23.15)-(T23.16).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar, Self

from flexapod.mechanics.elements.element import Moving, Named, Physics, Standing, asked_beside

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
        """Of a screw whose motor is more than a spring and a damper on its rotor."""
        return cls(leg.screw, leg.closed_about) if leg.screw is not None and leg.screw.loops else None

    def numbers(self, leg: Leg, standing: Standing) -> dict[str, Any]:
        """The loop; at rest, about another place, it is a spring of the drive there, Eq. (T23.55)."""
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
    def held(cls, own: Any, leg: Leg, standing: Standing) -> Sequence[str]:
        """The impulse of a force that comes at once; at rest what the loop leaves to its place, Eq. (T23.55)."""
        if own is None or not standing.at_rest:
            return () if own is not None and own.screw.lag else ("j",)
        return ("j", *(("r",) if own.about else ()), *(("l",) if own.about and own.screw.rests else ()))

    @classmethod
    def place(cls, x: Moving) -> SX:
        """What the loop measures, Eq. (T23.52)."""
        p, q = x.p, x.q
        return q.r + p.loop_at[0] * (q.l - q.r) + p.loop_at[1] * (x.distance - q.r)

    @classmethod
    def asks(cls, x: Moving) -> SX:
        """Force that the loop asks for, Eq. (T23.52)."""
        p, place = x.p, cls.place(x)
        rate = x.rate(place)
        rate = rate + p.loop_rate_at_rotor * (x.v.r - rate)
        held = p.loop_stiffness * (x.q_cmd - place) + p.loop_damping * (x.v_cmd - rate)
        more = asked_beside(x.elements, p, x.q)
        return held if more is None else held + more

    @classmethod
    def force(cls, x: Moving, asked: SX) -> SX:
        """Force on the rotor: at once what is asked for, or what lags behind it."""
        return x.p.loop_at_once * asked + (1 - x.p.loop_at_once) * x.v.j

    @classmethod
    def pushes(cls, x: Moving) -> Mapping[str, SX]:
        """The force on the rotor, and what it lags behind, Eq. (T23.53)."""
        asked = cls.asks(x)
        return {"r": -cls.force(x, asked), "j": -asked}

    @classmethod
    def inertia(cls, p: SimpleNamespace) -> Mapping[str, tuple[SX | float, SX | float]]:
        """The lag of the force, Eq. (T23.53)."""
        return {"j": (p.loop_lag, 1.0)}

    @classmethod
    def given(cls, x: Moving) -> SX:
        """Power of the motor."""
        return cls.force(x, cls.asks(x)) * x.v.r


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
