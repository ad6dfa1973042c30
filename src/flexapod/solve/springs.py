"""The springs along a leg as polynomials in its length, and what they are in series, Eqs. (T15.3)-(T15.4)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from flexapod.model import Leg, PrescribedDrive, Robot, Simulation
from flexapod.model.joint import Joint
from flexapod.rigid.robot import once
from flexapod.typing import Array

__all__ = ["PLACES", "Place", "Spring", "in_series", "loss_frequency", "springs_along"]

Place = Literal["base", "nut", "platform"]
PLACES: tuple[Place, ...] = ("base", "nut", "platform")


@dataclass(frozen=True, kw_only=True)
class Spring:
    """A spring along a leg: where it is, its compliance c0 + c1 l + c2 l^2 [m/N] and damper [N s/m] or loss factor."""

    name: str
    at: Place
    compliance: tuple[float, float, float]
    damping: float | None = None
    loss: float | None = None

    def at_length(self, length: Array) -> Array:
        """Compliance [m/N] of legs of some lengths [m]."""
        c0, c1, c2 = self.compliance
        return np.asarray(c0 + length * (c1 + length * c2))


def springs_along(leg: Leg) -> list[Spring]:
    """All springs along a leg in the order in which causes name them: joints first."""
    joints = (("base_joint", "base", leg.base_joint), ("platform_joint", "platform", leg.platform_joint))
    return [_of_joint(name, at, joint) for name, at, joint in joints if joint.across_and_along is not None]  # type: ignore[arg-type]


def _of_joint(name: str, at: Place, joint: Joint) -> Spring:
    return constant_spring(name, at, joint.across_and_along[1], joint)  # type: ignore[index]


def constant_spring(name: str, at: Place, stiffness: float, lossy: object = None) -> Spring:
    """A spring whose stiffness does not depend on the leg's length; `lossy` has its `damping` and `loss`."""
    damping, loss = (getattr(lossy, key, None) for key in ("damping", "loss"))
    return Spring(name=name, at=at, compliance=(1.0 / stiffness, 0.0, 0.0), damping=damping, loss=loss)


def in_series(springs: Iterable[Spring], length: float, frequency: float) -> tuple[float, float]:
    """Stiffness [N/m] and damping [N s/m] of springs in series, Eqs. (T15.3)-(T15.4); 0, 0 of none.

    ``frequency`` [Hz]: at which loss factors are made viscous.
    """
    total = lost = 0.0
    for spring in springs:
        softness = float(spring.at_length(np.array(length)))
        total += softness
        lost += viscous(spring, 1.0 / softness, frequency) * softness**2
    return (1.0 / total, lost / total**2) if total else (0.0, 0.0)


def viscous(lossy: Spring | Joint, stiffness: float, frequency: float) -> float:
    """Damping of a spring as given, or loss factor times stiffness over angular frequency [N s/m], Eq. (T15.2)."""
    if lossy.loss:
        return lossy.loss * stiffness / (2 * np.pi * frequency)
    return lossy.damping or 0.0


@once
def loss_frequency(robot: Robot) -> float:
    """First undamped frequency [Hz] at home, drives locked, pistons straight; 0 where no loss factor asks for it."""
    if not any(spring.loss for leg in robot.legs for spring in springs_along(leg)):
        return 0.0
    from flexapod.solve.modes import robot_modes  # asks for the system, whose parameters ask here

    legs = tuple(_locked(leg) for leg in robot.legs)
    return float(robot_modes(robot.replace(legs=legs), Simulation(fidelity="lumped")).frequency[0])


def _locked(leg: Leg) -> Leg:
    """The same without loss factors and with a locked drive."""
    ends = {name: getattr(leg, name).replace(loss=None) for name in ("base_joint", "platform_joint")}
    return leg.replace(drive=PrescribedDrive(), **ends)
