"""Parts of one's own with all that `flexapod.elements.element.Physics` has hooks for."""

from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Annotated, Any, ClassVar

from pydantic import Field

import flexapod as fx
from flexapod.elements.element import Along, Contribution, Moving, Output, SeriesSprings, Standing
from flexapod.elements.frame import Energies, Frame
from flexapod.elements.mount import world
from flexapod.model import Leg, Robot, Simulation, StrokeFriction
from flexapod.schema.base import Key, Quantity
from flexapod.symbolic.vocabulary import cos, dot, vertcat, zeros

NONE = (0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0)  # a leg without friction: nothing rubs, and what could bend is a unit long


class Foot(fx.Element):
    """A rubber foot under the base joint of a leg, which carries the leg: `stiffness` [N/m], `damping` [N s/m]."""

    at: ClassVar[str] = "foot"
    end: ClassVar = "base"
    coordinates: ClassVar = (("f", 1),)
    parameters: ClassVar = (("k", 1), ("c", 1), ("m", 1))
    absent: ClassVar = {"k": 1.0}

    stiffness: Annotated[float, Quantity("stiffness", above=0, why="of the rubber")]
    damping: Annotated[float, Quantity("damping", least=0, why="of the rubber")] = 0.0

    def numbers(self, leg: Leg, standing: Standing) -> Mapping[str, Any]:
        return {"k": self.stiffness, "c": self.damping, "m": 0.2}

    @classmethod
    def carries(cls, base: Frame | None, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> Frame:
        return (base or world()).moved(vertcat(zeros(2), q.f), vertcat(zeros(2), v.f))

    @classmethod
    def energy_along(cls, x: Along) -> Energies:
        kinetic = 0.5 * x.p.m * dot(x.v.f, x.v.f)
        return Energies(kinetic=kinetic, strain=0.5 * x.p.k * x.q.f**2, dissipation=0.5 * x.p.c * x.v.f**2)

    outputs: ClassVar = (Output("sink", "m", "how far the foot is pressed in", lambda p, q: -q.f),)


class Gasket(fx.Element):
    """A seal that rubs along the stroke; one of less than a newton is none."""

    at: ClassVar[str] = "gasket"
    rubs_at: ClassVar[str] = "gasket of the rod"
    parameters: ClassVar = (("friction", 8),)
    absent: ClassVar = {"friction": (*NONE, 0.0)}

    force: Annotated[float, Quantity("force", above=0, why="along the stroke")]

    def numbers(self, leg: Leg, standing: Standing) -> Mapping[str, Any]:
        return {"friction": (*StrokeFriction(force=self.force).numbers, 0.0)}

    @classmethod
    def slides(cls, p, q, v):
        return v.l

    @classmethod
    def ways(cls, has) -> Sequence[str]:
        return ("",)

    @classmethod
    def rubs(cls, leg: Leg) -> bool:
        return any(one.force >= 1.0 for one in cls.all_of(leg))

    @classmethod
    def friction_unit(cls, leg: Leg) -> float:
        return 1.0


class Slack(fx.Element):
    """Free travel in the springs before the piston, with rounded edges; a rigid robot does not see it."""

    at: ClassVar[str] = "slack"
    parameters: ClassVar = (("half", 1),)

    travel: Annotated[float, Quantity("length", above=0, why="from one edge to the other")]

    @classmethod
    def among(cls, robot: Robot, simulation: Simulation) -> bool:
        return simulation.fidelity != "rigid" and super().among(robot, simulation)

    def numbers(self, leg: Leg, standing: Standing) -> Mapping[str, Any]:
        return {"half": self.travel / 2}

    @classmethod
    def past(cls, x, rate, p):
        rounding = (0.2 * p.half) ** 2 + 1e-18
        right, left = x + p.half, x - p.half
        slope = 1 - 0.5 * (right / (right**2 + rounding) ** 0.5 - left / (left**2 + rounding) ** 0.5)
        return x - 0.5 * ((right**2 + rounding) ** 0.5 - (left**2 + rounding) ** 0.5), slope * rate


class Washer(fx.Element):
    """A soft washer in series with screw and nut: their compliance grows by a `share`."""

    at: ClassVar[str] = "washer"
    parameters: ClassVar = (("share", 1),)

    share: Annotated[float, Field(ge=0, le=1), Key("of the compliance at home that it adds")]

    def numbers(self, leg: Leg, standing: Standing) -> Mapping[str, Any]:
        return {"share": self.share}

    @classmethod
    def in_series(cls, s: SeriesSprings, p, q, v) -> SeriesSprings:
        return SeriesSprings(s.softer + p.share, s.nut, s.rate)


class Patience(fx.Element):
    """A sum of the error of a rotor's loop, of a `gain` [N/(m s)]."""

    at: ClassVar[str] = "patience"
    coordinates: ClassVar = (("w", 1),)
    parameters: ClassVar = (("gain", 1),)

    gain: Annotated[float, Field(gt=0), Key("of the sum [N/(m s)]")]

    def numbers(self, leg: Leg, standing: Standing) -> Mapping[str, Any]:
        return {"gain": self.gain}

    @classmethod
    def held(cls, own: Any, leg: Leg, standing: Standing) -> Sequence[str]:
        return ("w",) if own is None or standing.at_rest else ()

    @classmethod
    def energy(cls, p, q, v) -> Energies:
        return Energies(strain=0.5 * q.w**2)  # it forgets, slowly

    @classmethod
    def asked(cls, p, q):
        return p.gain * q.w

    @classmethod
    def pushes(cls, x: Moving) -> Mapping[str, Any]:
        return {"w": x.v.r - x.v_cmd}

    @classmethod
    def inertia(cls, p) -> Mapping[str, Any]:
        return {"w": (1.0, 0.0)}


class Fan(fx.Element):
    """A fan that pushes along the stroke with a `thrust` [N], and what it gives."""

    at: ClassVar[str] = "fan"
    parameters: ClassVar = (("thrust", 1),)

    thrust: Annotated[float, Quantity("force", why="along the stroke")]

    def numbers(self, leg: Leg, standing: Standing) -> Mapping[str, Any]:
        return {"thrust": 0.0 if standing.at_rest else self.thrust}

    @classmethod
    def pushes(cls, x: Moving) -> Mapping[str, Any]:
        return {"l": -x.p.thrust}

    @classmethod
    def given(cls, x: Moving):
        return x.p.thrust * x.v.l


class Cogging(fx.Element):
    """A force that returns along the stroke: `force` [N] with a `pitch` [m]; at rest nobody knows where it stands."""

    at: ClassVar[str] = "cogging"
    parameters: ClassVar = (("wave", 1), ("size", 1), ("home", 1))

    force: Annotated[float, Quantity("force", above=0, why="amplitude")]
    pitch: Annotated[float, Quantity("length", above=0, why="after which it returns")]

    def numbers(self, leg: Leg, standing: Standing) -> Mapping[str, Any]:
        wave = 6.283185307179586 / self.pitch
        return {"wave": wave, "size": self.force / wave, "home": standing.length}

    @classmethod
    def energy(cls, p, q, v) -> Energies:
        return Energies(strain=p.size * (1 - cos(p.wave * (q.l - p.home))))

    def smoothed(self, leg: Leg) -> Leg:
        return leg.replace(elements=tuple(one for one in leg.elements if type(one) is not Cogging))

    def errors(self, leg: Leg) -> Sequence[Contribution]:
        return (Contribution("cogging", "random", lambda length: 1e-8 * length, "a guess", stands=True),)
