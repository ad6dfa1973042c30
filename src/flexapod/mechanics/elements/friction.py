"""Friction with presliding after LuGre: a bristle for each direction of sliding, Eqs. (T19.1)-(T19.6)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

import numpy as np

from flexapod.mechanics.elements.drive_train import twisting
from flexapod.mechanics.elements.element import LegContext, Named, Physics
from flexapod.mechanics.elements.springs import twist_with_length
from flexapod.mechanics.symbolic.vocabulary import cos, dot, exp, sin, sqrt, vertcat

if TYPE_CHECKING:
    from flexapod.mechanics.symbolic.vocabulary import SX
    from flexapod.model import Leg, Robot, Simulation

#: Of a place without friction: nothing rubs, and what could bend is a unit long.
NO_FRICTION = (0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0)

STILL = 1e-60  # added to squares: a root has no slope at zero


class _OfJoint(Physics):
    """Friction of a joint about its angles, see `bristle_friction`; legs without it have a force of none."""

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Build the element of every leg: friction in one leg is computed in all."""
        return cls()

    @classmethod
    def in_kernel(cls, robot: Robot, simulation: Simulation) -> bool:
        """Test whether this joint has friction in some leg."""
        return any(map(cls.has_friction, robot.legs))

    @classmethod
    def has_friction(cls, leg: Leg) -> bool:
        """Test whether this joint of a leg has friction."""
        return getattr(leg, cls.rubs_at).friction is not None

    def numbers(self, leg: Leg, standing: LegContext) -> dict[str, Any]:
        """Friction parameters of the joint, and 1 where its directions slide together."""
        joint, letter = getattr(leg, f"{self.end}_joint"), getattr(leg.letters, self.end)
        numbers = NO_FRICTION if joint.friction is None else joint.friction.numbers
        return {f"{self.end}_friction": (*numbers, float(letter == "S"))}


class BaseFriction(_OfJoint):
    """Friction of the base joint about its angles."""

    end: ClassVar[Literal["base", "", "platform"]] = "base"
    rubs_at: ClassVar[str] = "base_joint"
    parameters: ClassVar[Named] = (("base_friction", 8),)

    @classmethod
    def friction_directions(cls, has: Callable[[str], bool]) -> tuple[str, ...]:
        """Angles of the base joint: two, or three with a spin."""
        return ("alpha", "beta", "spin") if has("spin") else ("alpha", "beta")

    @classmethod
    def sliding_speed(cls, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> SX:
        """Rates of its angles, of a ball its angular velocity."""
        if not hasattr(q, "spin"):
            return vertcat(v.alpha, v.beta)
        rates = vertcat(v.alpha, v.beta, p.cylinder_spins * v.spin)  # else the piston spins in its cylinder
        return joint_sliding_speed(vertcat(q.alpha, q.beta, q.spin), rates, p.base_friction[7])


class PlatformFriction(_OfJoint):
    """Friction of the platform joint about its angles."""

    end: ClassVar[Literal["base", "", "platform"]] = "platform"
    rubs_at: ClassVar[str] = "platform_joint"
    parameters: ClassVar[Named] = (("platform_friction", 8),)

    @classmethod
    def friction_directions(cls, has: Callable[[str], bool]) -> tuple[str, ...]:
        """Three angles of the platform joint."""
        return ("gamma1", "gamma2", "gamma3")

    @classmethod
    def sliding_speed(cls, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> SX:
        """Rates of its angles, of a ball its angular velocity."""
        angles, rates = (vertcat(x.gamma1, x.gamma2, x.gamma3) for x in (q, v))
        return joint_sliding_speed(angles, rates, p.platform_friction[7])


class DriveFriction(Physics):
    """Friction of a drive along its travel."""

    rubs_at = "drive"

    parameters: ClassVar[Named] = (
        ("drive_friction", 8),
        ("drive_friction_at_stroke", 1),  # 1 where it acts on the stroke, else, of a rotor,
        ("drive_friction_twist", 2),  # its shaft's share in what springs before the stroke give; by length [1/m]
    )

    @classmethod
    def of(cls, leg: Leg) -> Self | None:
        """Build the element of every leg: friction in one leg is computed in all, as of joints."""
        return cls()

    @classmethod
    def in_kernel(cls, robot: Robot, simulation: Simulation) -> bool:
        """Test whether a drive has friction in some leg."""
        return any(map(cls.has_friction, robot.legs))

    @classmethod
    def has_friction(cls, leg: Leg) -> bool:
        """Test whether the drive of a leg has friction."""
        return leg.drive.friction is not None

    def numbers(self, leg: Leg, standing: LegContext) -> dict[str, Any]:
        """Friction parameters of the drive; those of a screw by the nut's travel, Eq. (T19.12).

        At rest a loop about another place than the rotor is one spring there, Eq. (T23.55): friction slides with it.
        """
        drive, screw, twist = leg.drive.friction, leg.screw, (0.0, 0.0)
        at_rotor = screw is not None and not (standing.at_rest and leg.closed_about)
        numbers = NO_FRICTION if drive is None else drive.numbers
        if screw is not None:
            turn = screw.per_turn
            numbers = tuple(np.array(numbers) * np.array([1 / turn, 0.0, turn, 1.0, 1 / turn, turn**-2, 1.0]))
        if at_rotor:
            twist = twist_with_length(leg, standing.length)
        return {
            "drive_friction": (*numbers, 0.0),
            "drive_friction_at_stroke": float(not at_rotor),
            "drive_friction_twist": twist,
        }

    @classmethod
    def friction_directions(cls, has: Callable[[str], bool]) -> tuple[str, ...]:
        """Single direction of sliding, the drive's travel, without a name."""
        return ("",)

    @classmethod
    def friction_unit(cls, leg: Leg) -> float:
        """Travel per angle of a screw, whose friction is given by its angle; else 1."""
        return 1.0 if leg.screw is None else leg.screw.per_turn

    @classmethod
    def sliding_speed(cls, p: SimpleNamespace, q: SimpleNamespace, v: SimpleNamespace) -> SX:
        """Rate of the stroke, or of the rotor and what its shaft's twist leaves of it."""
        if not hasattr(q, "r"):
            return v.l
        at_stroke = p.drive_friction_at_stroke + twisting(p, q.l)
        return at_stroke * v.l + (1 - at_stroke) * v.r


@dataclass(frozen=True, kw_only=True)
class BristleFriction:
    """Friction at one place, direction by direction.

    ``force`` against the sliding [N m, of drives N]; ``bristles`` bent by now, and their ``rate``; ``stored``: energy.
    """

    force: SX
    bristles: SX
    rate: SX
    stored: SX


def bristle_friction(p: SX, load: SX, v: SX, before: SX, z: SX, h: SX, *, falling: bool = True) -> BristleFriction:
    """Friction at the end of a step.

    Parameters
    ----------
    p : SX
        Force that is there without load, force per ``load``, presliding, static force over sliding force less one,
        one over the Stribeck rate, viscous friction, damping time of the bristles, and 1 where directions slide
        together (a ball), 0 where each slides by itself.
    load : SX
        Force that presses [N].
    v, before : SX
        Rates of sliding at the end of the step and at its begin.
    z, h : SX
        Bristles at its begin, and its length; with a step of 0 they are what they are.
    falling : bool
        The damping of the bristles falls with the rate, so that they never give energy, Eq. (T19.4).
    """
    sliding, reach, damping_time = p[0] + p[1] * load, p[2], p[6]
    way, mean = 0.5 * h * (before + v), 0.5 * (before + v)
    x = _size(way, p[7]) / _limit(p, mean)  # (T19.5)
    bent = (z + way * (1 + x / 2 + x**2 / 6)) / (1 + x + x**2 / 2 + x**3 / 6)
    fast = _size(v, p[7])
    rate = v - fast * bent / _limit(p, v)  # (T19.1)
    if falling:
        damping_time = damping_time / (1 + 0.25 * damping_time * fast / reach)  # (T19.4)
    return BristleFriction(
        force=sliding / reach * (bent + damping_time * rate) + p[5] * v,  # (T19.3)
        bristles=bent,
        rate=rate,
        stored=0.5 * sliding / reach * dot(bent, bent),
    )


def bristle_decay(p: SX, v: SX) -> SX:
    """Share of their bending that bristles lose in a second at a rate of sliding, Eq. (T19.1) [1/s]."""
    return _size(v, p[7]) / _limit(p, v)


def _limit(p: SX, v: SX) -> SX:
    """Largest deflection of the bristles at a rate of sliding, Eq. (T19.2)."""
    return p[2] * (1 + p[3] * exp(-((_size(v, p[7]) * p[4]) ** 2)))


def _size(v: SX, together: SX) -> SX:
    """Speed of sliding in each direction, or of all directions where they slide together."""
    square = v**2
    return sqrt(square + together * (dot(v, v) - square) + STILL)


def joint_sliding_speed(angles: SX, rates: SX, together: SX) -> SX:
    """Sliding rates of a joint: of its successive angles, or its angular velocity where it is a ball."""
    first, second = angles[0], angles[1]
    of_ball = vertcat(  # (T19.6)
        rates[0] + sin(second) * rates[2],
        cos(first) * rates[1] - sin(first) * cos(second) * rates[2],
        sin(first) * rates[1] + cos(first) * cos(second) * rates[2],
    )
    return rates + together * (of_ball - rates)
