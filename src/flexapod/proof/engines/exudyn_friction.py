"""Friction in Exudyn's terms: user functions of connectors, bristles that are integrated beside it. Imports Exudyn.

The bristles of a step follow the mean of the rates at its ends, exactly for a rate that is constant; rates at its end
are Newton's, so that the friction of a step is part of what it solves for.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flexapod.model import Leg
from flexapod.proof.engines.exudyn_system import System, exu, items
from flexapod.typing import Array

__all__ = ["Bristles", "rub_ball", "rub_coordinate"]

Numbers = tuple[float, ...]


class Bristles:
    """LuGre's bristles at one place, a vector (n,), Eqs. (T19.1)-(T19.4).

    `numbers`: force of sliding, its share of the load [m], presliding, what breaks away over it less one, one over the
    rate of Stribeck's law, viscous friction, damping time; `step` [s].
    """

    def __init__(self, numbers: Numbers, step: float, count: int = 1) -> None:
        self.sliding, self.arm, self.presliding, self.excess, self.slower, self.viscous, self.time = numbers
        self.step, self.bent, self.rate = step, np.zeros(count), np.zeros(count)

    def force(self, rate: Array, load: float = 0.0) -> Array:
        """Against the sliding at a rate (n,) at the step's end."""
        speed = float(np.linalg.norm(rate))
        sliding, z = self.sliding + self.arm * load, self._bent(rate)
        slip = rate - speed * z / self._limit(speed)
        time = self.time / (1 + self.time * speed / (4 * self.presliding))
        return sliding / self.presliding * (z + time * slip) + self.viscous * rate

    def keep(self, rate: Array) -> None:
        """A step has ended with this rate."""
        self.bent, self.rate = self._bent(rate), rate.copy()

    def _bent(self, rate: Array) -> Array:
        mean = 0.5 * (self.rate + rate)
        speed = float(np.linalg.norm(mean))
        if not speed:
            return self.bent
        most = self._limit(speed)
        steady = most * mean / speed
        return steady + (self.bent - steady) * np.exp(-speed * self.step / most)

    def _limit(self, speed: float) -> float:
        return self.presliding * (1 + self.excess * float(np.exp(-((speed * self.slower) ** 2))))


def rub_coordinate(system: System, marker: int, numbers: Numbers, load: Callable[[], float] = lambda: 0.0) -> None:
    """Friction against the rate of a marker's coordinate; `load` [N] that presses."""
    bristles = Bristles(numbers, system.step)

    def force(_mbs: object, _t: float, _number: int, _u: float, v: float, *_given: float) -> float:
        return float(bristles.force(np.array([v]), load())[0])

    number = system.mbs.AddObject(
        items.ObjectConnectorCoordinateSpringDamper(
            markerNumbers=[system.ground, marker], springForceUserFunction=force
        )
    )
    speed = exu.OutputVariableType.Velocity
    system.before_step.append(lambda: bristles.keep(np.atleast_1d(system.mbs.GetObjectOutput(number, speed))))


def rub_ball(system: System, markers: list[int], numbers: Numbers, load: Callable[[], float]) -> None:
    """Friction against the turning of two bodies in a ball, at their markers, in the axes of the first."""
    bristles = Bristles(numbers, system.step, 3)

    def moment(_mbs: object, _t: float, _number: int, _u: Array, _turn: Array, _v: Array, w: Array, *_given: Array):  # type: ignore[no-untyped-def]
        return [0.0, 0.0, 0.0, *bristles.force(np.array(w), load()).tolist()]

    number = system.mbs.AddObject(
        items.ObjectConnectorRigidBodySpringDamper(markerNumbers=markers, springForceTorqueUserFunction=moment)
    )
    speed = exu.OutputVariableType.AngularVelocityLocal
    system.before_step.append(lambda: bristles.keep(np.array(system.mbs.GetObjectOutput(number, speed))))


def pressing(system: System, connector: int | None) -> Callable[[], float]:
    """The force of a platform joint as the last step left it [N]; of a rigid one none is told."""
    if connector is None:
        return lambda: 0.0
    now = [0.0]
    force = exu.OutputVariableType.ForceLocal
    system.before_step.append(
        lambda: now.__setitem__(0, float(np.linalg.norm(system.mbs.GetObjectOutput(connector, force))))
    )
    return lambda: now[0]


def rub(system: System, leg: Leg, turns: list[int], ends: list[int], pressed: Callable[[], float]) -> None:
    """Friction of a leg's joints: of the markers of its base joint's angles, of those of tip and platform joint."""
    if leg.base_joint.friction is not None:
        for marker in turns:
            rub_coordinate(system, marker, leg.base_joint.friction.numbers, pressed)
    if leg.platform_joint.friction is not None:
        rub_ball(system, ends, leg.platform_joint.friction.numbers, pressed)
