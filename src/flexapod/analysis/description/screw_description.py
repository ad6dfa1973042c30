"""A screw drive on the rigid path, against its catalogue: thrust, speed, torque, life; remarks on what is exceeded."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from flexapod.analysis.checks.plausibility import worst_of_each
from flexapod.analysis.checks.screws import (
    back_efficiency,
    buckling_thrust,
    critical_speed,
    half_loads,
    mean_load,
    motor_torque,
    turns_of_life,
)
from flexapod.analysis.description.leg_description import Extreme, largest
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.arrays import Array
from flexapod.common.quantities import number, text
from flexapod.common.ranking import first_largest, most
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
    allowed = buckling_thrust(screw, along)
    pushed = np.abs(thrust) if screw.mounting == "fixed-fixed" else np.maximum(thrust, 0.0)
    buckling = largest(t, pushed / allowed)
    speed, torque = np.abs(rate) / screw.per_turn, motor_torque(screw, thrust, rate, accel)
    rms, constant = float(np.sqrt(np.trapezoid(torque**2, t) / (t[-1] - t[0]))), screw.motor.torque_constant
    load, rating = half_loads(screw.nut, thrust), screw.nut.static_load
    life, hours = _life(screw, load, t, rate)
    return ScrewDescription(
        leg=i + 1,
        thrust=largest(t, np.abs(thrust)),
        buckling=buckling,
        buckling_thrust=float(allowed[first_largest(pushed / allowed)]),
        speed=largest(t, speed * screw.rotor.ratio),
        critical=float(speed.max() / critical_speed(screw)),
        torque=largest(t, np.abs(torque)),
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
    """What a motion asks of screws beyond their catalogue: one sentence of a kind, of the leg that is worst."""
    return worst_of_each(
        [
            (found.leg - 1, *excess)
            for found in screws
            if (screw := robot.legs[found.leg - 1].screw) is not None
            for excess in _excesses(screw, found)
            if excess[1] > 1
        ]
    )


def _excesses(screw: ScrewDrive, found: ScrewDescription) -> Iterator[tuple[str, float, str]]:
    """Kind, value over limit, words."""
    limits = screw.limits
    for kind, what, extreme, limit, unit, factor in (
        ("force", "the thrust", found.thrust, limits.force, "N", 1.0),
        ("speed", "the motor's speed", found.speed, limits.speed, "rpm", RPM),
        ("torque", "the motor's torque", found.torque, limits.torque, "N m", 1.0),
    ):
        if limit is not None:
            yield (
                kind,
                extreme.value / limit,
                (
                    f"{what} reaches {number(factor * extreme.value, 4)} {unit} at t = {extreme.time:.6g} s, above the "
                    f"limit of {number(factor * limit, 4)} {unit}"
                ),
            )
    if limits.rms_torque is not None:
        yield (
            "rms",
            found.rms_torque / limits.rms_torque,
            (
                f"the motor's torque is {number(found.rms_torque, 4)} N m (root mean square), above the limit of "
                f"{number(limits.rms_torque, 4)} N m. It gets too hot"
            ),
        )
    yield (
        "buckling",
        found.buckling.value,
        (
            f"the screw is pushed with {number(found.buckling.value, 3)} times the {text(found.buckling_thrust, 'N')} "
            f"that its shaft may bear at t = {found.buckling.time:.6g} s (half the Euler load). A thicker shaft would "
            "do, or both ends held"
        ),
    )
    yield (
        "critical",
        found.critical,
        (
            f"the screw turns {number(found.critical, 3)} times as fast as its shaft may (0.8 of the first bending "
            "frequency). A thicker or shorter shaft would do, a longer lead, or its far end held"
        ),
    )
    if found.safety is not None:
        yield (
            "static",
            SAFE / found.safety,
            (f"the nut bears {number(SAFE / found.safety, 3)} times its static load rating: its grooves keep dents"),
        )
    if screw.brake is not None:
        yield (
            "brake",
            found.back_torque / screw.brake.torque,
            (
                f"the brake holds {text(screw.brake.torque, 'N m')}, and the largest thrust turns the motor back with "
                f"{text(found.back_torque, 'N m')}"
            ),
        )


def back_words(path: RigidPath, screws: tuple[ScrewDescription, ...]) -> str:
    """What happens with the motors off."""
    worst = most(screws, key=lambda found: found.back_torque)
    screw = path.robot.legs[worst.leg - 1].screw
    if screw is None or back_efficiency(screw) <= 0:
        return "with the motors off the screws stay where they are: at efficiencies up to 0.5 no thrust turns them back"
    if worst.back_torque == 0:
        return "with the motors off nothing turns the screws: no leg bears a thrust"
    brake = "no brake is given" if screw.brake is None else f"its brake holds {text(screw.brake.torque, 'N m')}"
    return (
        f"with the motors off the legs give way: the thrust turns the motor of leg {worst.leg} back with up to "
        f"{text(worst.back_torque, 'N m')} (efficiency {number(back_efficiency(screw), 2)} backwards); {brake}"
    )


def screw_table(screws: tuple[ScrewDescription, ...]) -> tuple[list[str], list[list[str]]]:
    """Heads, and a row of texts for each screw, its leg first."""
    head = ["thrust [N]", "of buckling [%]", "motor [rpm]", "of critical speed [%]", "motor [N m]", "rms [N m]",
            "static safety", "life [h]"]  # fmt: skip
    known = any(s.current is not None for s in screws)
    head += ["current [A]", "rms [A]"] if known else []
    return head, [
        [
            f"{s.leg}",
            f"{s.thrust.value:.4g}",
            f"{100 * s.buckling.value:.3g}",
            f"{RPM * s.speed.value:.4g}",
            f"{100 * s.critical:.3g}",
            f"{s.torque.value:.3g}",
            f"{s.rms_torque:.3g}",
            "-" if s.safety is None else f"{s.safety:.3g}",
            "-" if s.hours is None else f"{s.hours:.3g}",
            *("-" if x is None else f"{x:.3g}" for x in (s.current, s.rms_current) if known),
        ]
        for s in screws
    ]
