"""The springs along a leg as functions of its length, and what they are in series, Eqs. (T15.3)-(T15.7), (T23.2)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeVar

import numpy as np

from flexapod.common.arrays import Array

if TYPE_CHECKING:
    from flexapod.model import HydraulicDrive, Joint, Leg, ScrewDrive

Place = Literal["base", "nut", "platform"]
KEPT = 64  # legs whose springs are remembered: a simulation asks for them a hundred times
_known: dict[int, tuple[Leg, tuple[Spring, ...]]] = {}
T = TypeVar("T", float, Array)


class OilColumn(NamedTuple):
    """A column of oil: its compliance [m/N] at a length l of the leg is ``fixed`` + ``slope`` l; `area` [m^2]."""

    fixed: float
    slope: float
    area: float

    def at_length(self, length: Array) -> Array:
        """Compliance [m/N] at lengths of the leg [m]."""
        return np.asarray(self.fixed + self.slope * length)


@dataclass(frozen=True, kw_only=True)
class Spring:
    """A spring along a leg: where it is, its compliance c0 + c1 l + c2 l^2 [m/N] and damper [N s/m] or loss factor.

    Of oil, `columns` side by side, between which there is a `leakage` [m^3/(s Pa)].
    """

    name: str
    at: Place
    compliance: tuple[float, float, float]
    damping: float | None = None
    loss: float | None = None
    columns: tuple[OilColumn, ...] = ()
    leakage: float = 0.0

    def at_length(self, length: Array) -> Array:
        """Compliance [m/N] of legs of some lengths [m]."""
        c0, c1, c2 = self.compliance
        found = np.asarray(c0 + length * (c1 + length * c2))
        return found + 1 / sum(1 / x.at_length(length) for x in self.columns) if self.columns else found

    def creep(self, length: Array) -> Array:
        """Rate at which leaking oil lets the spring yield, over the force [m/(N s)], Eq. (T23.4)."""
        stiffness = [1 / x.at_length(length) for x in self.columns]
        pressure = sum(k / x.area for k, x in zip(stiffness, self.columns, strict=True))
        return np.asarray(self.leakage * (pressure / sum(stiffness)) ** 2) if self.columns else np.zeros_like(length)


def springs_along(leg: Leg) -> list[Spring]:
    """All springs along a leg but its piston, in the order in which causes name them: joints, screw, named ones."""
    known = _known.get(id(leg))
    if known is None or known[0] is not leg:
        if len(_known) >= KEPT:
            _known.clear()
        known = _known[id(leg)] = leg, tuple(_springs(leg))
    return list(known[1])


def _springs(leg: Leg) -> list[Spring]:
    joints: tuple[tuple[str, Place, Joint], ...] = (
        ("base_joint", "base", leg.base_joint),
        ("platform_joint", "platform", leg.platform_joint),
    )
    found = [
        _constant(name, at, k[1], joint.stiffness_damping, joint.loss_of_stiffness)
        for name, at, joint in joints
        if (k := joint.across_and_along) is not None
    ]
    if leg.screw is not None:
        found += _of_screw(leg.screw, leg.begins)
    if leg.cylinder_of_oil is not None:
        found.append(_of_oil(leg.cylinder_of_oil, leg.begins))
    if leg.pressed:
        found.append(_constant("cylinder", "nut", leg.cylinder.beam[1] / leg.pressed, None, None))  # (T25.14)
    return found + [_constant(x.name, x.at, x.stiffness, x.damping, x.loss) for x in leg.springs]


def _constant(name: str, at: Place, stiffness: float, damping: float | None, loss: float | None) -> Spring:
    return Spring(name=name, at=at, compliance=(1.0 / stiffness, 0.0, 0.0), damping=damping, loss=loss)


def springs_before_piston(leg: Leg) -> list[Spring]:
    """The springs between a drive's command and the piston, those of a servo or of a screw's loop among them.

    What is inside of a loop is not.
    """
    springs = [x for x in springs_along(leg) if x.at == "nut" and not leg.closed_about]
    if leg.drive.type == "servo":
        springs.append(servo_spring(leg.drive.stiffness, leg.drive.damping))
    elif leg.screw is not None and leg.screw.loop_spring[0] and not leg.screw.rests:
        springs.append(servo_spring(leg.screw.loop_spring[0]))
    return springs


def springs_before_stroke(leg: Leg) -> list[Spring]:
    """The springs between rotor and stroke, a servo's among them: nothing has a mass between it and these."""
    springs = [spring for spring in springs_along(leg) if spring.at == "nut"]
    if springs and leg.drive.type == "servo":
        springs.append(servo_spring(leg.drive.stiffness, leg.drive.damping))
    return springs


def servo_spring(stiffness: float, damping: float = 0.0) -> Spring:
    """The spring [N/m] and damper [N s/m] of a servo, in series with what is behind it."""
    return Spring(name="drive", at="nut", compliance=(1.0 / stiffness, 0.0, 0.0), damping=damping)


def _of_screw(screw: ScrewDrive, begin: float) -> list[Spring]:
    """Shaft, twist, nut and bearing of a screw; ``begin`` [m]: length of the leg with the nut at the bearing."""
    E, G = screw.material.E, screw.material.E / (2 * (1 + screw.material.poisson))
    polar = np.pi / 32 * screw.root_diameter**4
    stretch, turn = 1.0 / (E * screw.area), screw.per_turn**2 / (G * polar)
    if screw.mounting == "fixed-fixed":  # (T15.6)  a b / (E A (a + b))
        along = -begin - begin**2 / screw.length, 1.0 + 2 * begin / screw.length, -1.0 / screw.length
    else:
        along = -begin, 1.0, 0.0
    c0, c1, c2 = (stretch * x for x in along)
    return [
        Spring(name="screw", at="nut", compliance=(c0, c1, c2)),  # (T15.5)-(T15.6)
        Spring(name="twist", at="nut", compliance=(-turn * begin, turn, 0.0)),  # (T15.7)
        _constant("nut", "nut", screw.nut.k, screw.nut.damping, screw.nut.loss),
        _constant("bearing", "nut", screw.bearing.k, screw.bearing.damping, screw.bearing.loss),
    ]


def _of_oil(drive: HydraulicDrive, begin: float) -> Spring:
    """The oil on both sides of the piston; ``begin`` [m]: length of the leg with the piston at the bottom."""
    columns = []
    for area, at_bottom, way in zip(drive.areas, drive.volumes(np.array(0.0)), (1, -1), strict=True):
        per_volume = 1 / (drive.bulk_modulus * area**2)  # (T23.2)
        slope = way * area * per_volume
        columns.append(OilColumn(fixed=float(at_bottom) * per_volume - slope * begin, slope=slope, area=area))
    return Spring(name="oil", at="nut", compliance=(0.0, 0.0, 0.0), columns=tuple(columns), leakage=drive.leakage)


def oil_shares(springs: Iterable[Spring], length: float) -> tuple[float, ...]:
    """Parameters of `elements.oil.Oil` for springs in series at a length of the leg [m]; 0 without oil."""
    at, springs = np.array(length), list(springs)
    oil = next((spring for spring in springs if spring.columns), None)
    if oil is None:
        return (0.0,) * 4
    push, pull = oil.columns
    softness = oil.at_length(at)
    whole = sum(spring.at_length(at) for spring in springs)
    pair = (push.slope / push.at_length(at), -pull.slope / pull.at_length(at))
    return float(softness / whole), float(softness / push.at_length(at)), float(pair[0]), float(pair[1])


def twist_share(leg: Leg, length: Array) -> Array:
    """Share of a screw's twist in the compliance before its piston, at lengths [m], Eq. (T19.12)."""
    softness = {x.name: x.at_length(length) for x in springs_along(leg) if x.at == "nut"}
    return np.asarray(softness["twist"] / np.sum(list(softness.values()), axis=0))


def twist_with_length(leg: Leg, length: float) -> tuple[float, float]:
    """Share of a screw's twist at a length [m], see `twist_share`, and its growth with the length [1/m]."""
    share = float(twist_share(leg, np.array(length)))
    twist = next(x for x in springs_along(leg) if x.name == "twist")
    return share, share * twist.compliance[1] / float(twist.at_length(np.array(length)))


def softening(springs: Iterable[Spring], length: float) -> tuple[float, float]:
    """Growth of the compliance of springs in series with the length, over itself at a length [1/m, 1/m^2]."""
    springs = list(springs)
    c0, c1, c2 = np.sum([spring.compliance for spring in springs], axis=0)
    total = c0 + length * (c1 + length * c2)
    for spring in springs:
        total += float(spring.at_length(np.array(length))) if spring.columns else 0.0
    return float((c1 + 2 * c2 * length) / total), float(c2 / total)


def series_stiffness(springs: Iterable[Spring], length: float, per_loss: float) -> tuple[float, float]:
    """Stiffness [N/m] and damping [N s/m] of springs in series, Eqs. (T15.3)-(T15.4); 0, 0 of none.

    ``per_loss`` [s]: viscous damping over stiffness of a spring of loss factor 1, see `losses`.
    """
    total = lost = 0.0
    for spring in springs:
        softness = float(spring.at_length(np.array(length)))
        total += softness
        lost += viscous(1.0 / softness, spring.damping, spring.loss, per_loss) * softness**2
        lost += float(spring.creep(np.array(length))) * per_loss**2  # (T23.5)
    return (1.0 / total, lost / total**2) if total else (0.0, 0.0)


def viscous(stiffness: T, damping: T | float | None, loss: float | None, per_loss: float) -> T:
    """Viscous damping of a spring: given, or of its loss factor, Eq. (T13.19)."""
    return (0.0 if damping is None else damping) + (loss or 0.0) * per_loss * stiffness  # type: ignore[return-value]
