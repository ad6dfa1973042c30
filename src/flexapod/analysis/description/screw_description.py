"""A screw drive on the rigid path, against its catalogue: thrust, speed, torque, life; remarks on what is exceeded."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from flexapod.analysis.checks.screws import (
    back_efficiency,
    buckling_shares,
    buckling_thrust,
    critical_speed,
    half_loads,
    mean_load,
    motor_torque,
    turns_of_life,
)
from flexapod.analysis.description.leg_description import Extreme, maximum
from flexapod.analysis.results.remarks import Doubt, worst_remarks
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.arrays import Array
from flexapod.common.ranking import first_largest, largest_item
from flexapod.model import Leg, Robot, ScrewDrive

SAFE = 1.0  # static load rating over load
RPM = 30 / math.pi  # per rad/s


@dataclass(frozen=True, kw_only=True)
class ScrewDescription:
    """One screw on the rigid path, SI units.

    `thrust`: largest size; `buckling`: largest push over what the shaft may bear, `buckling_thrust` there; `speed`
    [rad/s] and `torque` [N m] of the motor, largest sizes; `critical`: largest speed of the screw over what it may turn
    at; `rms_torque` over the study's duration; `back_torque`: of the motor, by which the
    largest thrust turns it back, not positive where friction holds; `life` in turns and `hours` of the motion repeated,
    `safety`: static rating over the largest load; `current`, `rms_current` of the motor [A]; None where ratings or
    torque constant are not given or nothing turns.
    """

    leg: int
    thrust: Extreme
    buckling: Extreme
    buckling_thrust: float
    speed: Extreme
    critical: float
    torque: Extreme
    rms_torque: float
    back_torque: float
    life: float | None
    hours: float | None
    safety: float | None
    current: float | None
    rms_current: float | None


@dataclass(frozen=True, kw_only=True)
class BackDriving:
    """The screw that its thrust turns back hardest, of `leg`, with the motors off.

    `torque` at its motor [N m]; `efficiency` backwards, not positive where friction holds; torque of its `brake` [N m].
    """

    leg: int
    torque: float
    efficiency: float
    brake: float | None


def describe_screws(path: RigidPath) -> tuple[ScrewDescription, ...]:
    """The screws of a robot on the rigid path of its study."""
    legs, thrust = path.legs, path.forces.drive_force
    return tuple(
        describe_screw(i, leg, path.time, legs.length[:, i], thrust[:, i], legs.rate[:, i], legs.accel[:, i])
        for i, leg in enumerate(path.robot.legs)
        if leg.screw is not None
    )


def describe_screw(
    i: int, leg: Leg, t: Array, length: Array, thrust: Array, rate: Array, accel: Array
) -> ScrewDescription:
    """The screw of leg i at instants `t`, each shape (T,).

    `length` of the leg [m], `thrust` on its piston [N], `rate` and `accel` of the nut's travel by the rotor.
    """
    screw: ScrewDrive = leg.screw  # type: ignore[assignment]
    along = length - leg.begins
    shares = buckling_shares(screw, along, thrust)
    buckling = maximum(t, shares)
    speed, torque = np.abs(rate) / screw.per_turn, motor_torque(screw, thrust, rate, accel)
    rms, constant = float(np.sqrt(np.trapezoid(torque**2, t) / (t[-1] - t[0]))), screw.motor.torque_constant
    load, rating = half_loads(screw.nut, thrust), screw.nut.static_load
    life, hours = _life(screw, load, t, rate)
    return ScrewDescription(
        leg=i + 1,
        thrust=maximum(t, np.abs(thrust)),
        buckling=buckling,
        buckling_thrust=float(buckling_thrust(screw, along)[first_largest(shares)]),
        speed=maximum(t, speed * screw.rotor.ratio),
        critical=float(speed.max() / critical_speed(screw)),
        torque=maximum(t, np.abs(torque)),
        rms_torque=rms,
        current=None if constant is None else float(np.abs(torque).max()) / constant,
        rms_current=None if constant is None else rms / constant,
        back_torque=float(np.abs(thrust).max() * screw.per_turn * back_efficiency(screw) / screw.rotor.ratio),
        life=life,
        hours=hours,
        safety=None if rating is None or not load.any() else float(rating / load.max()),
    )


def _life(screw: ScrewDrive, load: Array, t: Array, rate: Array) -> tuple[float | None, float | None]:
    travel = float(np.trapezoid(np.abs(rate), t))
    if screw.nut.dynamic_load is None or travel == 0 or not load.any():
        return None, None
    life = turns_of_life(screw.nut.dynamic_load, mean_load(load, rate))
    return life, life / (travel / screw.lead) * (t[-1] - t[0]) / 3600


def screw_remarks(robot: Robot, screws: tuple[ScrewDescription, ...]) -> list[str]:
    """Remarks on screws beyond their catalogue limits: one sentence of a kind, for the worst leg."""
    return worst_remarks(
        Doubt(leg=found.leg - 1, kind=kind, severity=excess, numbers=numbers)
        for found in screws
        if (screw := robot.legs[found.leg - 1].screw) is not None
        for kind, excess, numbers in _excesses(screw, found)
        if excess > 1
    )


def _excesses(screw: ScrewDrive, found: ScrewDescription) -> Iterator[tuple[str, float, Mapping[str, object]]]:
    """Kind, value over limit, numbers of a remark."""
    limits = screw.limits
    for kind, extreme, limit, factor in (
        ("force", found.thrust, limits.force, 1.0),
        ("speed", found.speed, limits.speed, RPM),
        ("torque", found.torque, limits.torque, 1.0),
    ):
        if limit is not None:
            numbers = {"value": factor * extreme.value, "time": extreme.time, "limit": factor * limit}
            yield kind, extreme.value / limit, numbers
    if limits.rms_torque is not None:
        numbers = {"value": found.rms_torque, "limit": limits.rms_torque}
        yield "rms torque", found.rms_torque / limits.rms_torque, numbers
    numbers = {"share": found.buckling.value, "thrust": found.buckling_thrust, "time": found.buckling.time}
    yield "buckling shaft", found.buckling.value, numbers
    yield "critical speed", found.critical, {"share": found.critical}
    if found.safety is not None:
        yield "static load", SAFE / found.safety, {"share": SAFE / found.safety}
    if screw.brake is not None:
        numbers = {"brake": screw.brake.torque, "torque": found.back_torque}
        yield "brake", found.back_torque / screw.brake.torque, numbers


def back_driving(path: RigidPath, screws: tuple[ScrewDescription, ...]) -> BackDriving | None:
    """Back-driving of a robot with its motors off; None without screws."""
    if not screws:
        return None
    worst = largest_item(screws, key=lambda found: found.back_torque)
    screw: ScrewDrive = path.robot.legs[worst.leg - 1].screw  # type: ignore[assignment]
    return BackDriving(
        leg=worst.leg,
        torque=worst.back_torque,
        efficiency=back_efficiency(screw),
        brake=None if screw.brake is None else screw.brake.torque,
    )
