"""Choice of the electric cylinder of a first robot: one that carries loads and speeds of its path."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from flexapod import model
from flexapod.analysis.checks.screws import critical_speed
from flexapod.analysis.description.leg_description import LegDescription
from flexapod.analysis.description.robot_description import describe_legs
from flexapod.analysis.description.screw_description import ScrewDescription, describe_screws
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.errors import InputError
from flexapod.common.quantities import text
from flexapod.design.first_robot import sizing
from flexapod.design.first_robot.catalogue import MOTORS, SCREWS, Screw, speed_limit
from flexapod.design.first_robot.electric import OUTER, TUBE, ElectricActuator, electric_leg, longest_stroke
from flexapod.design.first_robot.sizing import OPTION, Joints, Request, SizedLeg
from flexapod.design.first_robot.study_text import Plan, write_study_text
from flexapod.model.leg.screw import HIGHEST, UNLOADS

STIFF = 33.0  # leg at home over diameter of its screw, at most where one fits: 28 in machine-hexapod
PRELOAD = 0.05  # of the dynamic load rating, at least
SPARE = 1.1  # of loads that choose preload and motor
HOURS = 1e4  # life of the nut, the motion repeated
NEARLY = 0.95  # of the speed that is allowed
INSTANTS = 301
SLOW = 2.0  # duration over that of ideal drives beyond which a faster screw will do
HEAVY = 3.0  # mass of the legs over that of the payload beyond which a thinner screw will do
OF_PISTON = ("buckling of the piston", "stress of the piston")


Described = tuple[tuple[LegDescription, ...], tuple[ScrewDescription, ...], float]


@dataclass(frozen=True, kw_only=True)
class ElectricTrial:
    """A plan, how many times what it is asked for exceeds what it bears, by kind, its largest thrust [N].

    `cost`: 1 where legs are as light and the motion as fast as they should be, more otherwise.
    """

    plan: Plan
    excess: dict[str, float]
    thrust: float
    cost: float

    @property
    def worst(self) -> float:
        """The largest excess; none up to 1."""
        return max(self.excess.values())


def electric_robot(ideal: Plan) -> Plan:
    """The robot with electric cylinders.

    Parameters
    ----------
    ideal : Plan
        The robot with ideal legs, whose motion is that of the path.

    Raises
    ------
    InputError
        No cylinder of the catalogue fits or carries it; the message names the number to change.
    """
    request, joints, stroke = ideal.request, ideal.joints, sizing.leg_stroke(ideal.request)
    fitting = [screw for screw in SCREWS if _diameters(request, joints, screw)]
    if not fitting:
        raise _no_room(request, joints)
    stiff = [screw for screw in fitting if STIFF * screw.nominal >= joints.length]
    order = stiff + [screw for screw in reversed(fitting) if screw not in stiff]
    tried: list[ElectricTrial] = []
    for screw in order:
        for leg in _legs(request, joints, stroke, screw):
            tried.append(_try_leg(ideal, screw, leg))
            if tried[-1].worst <= 1:
                if tried[-1].cost <= 1:
                    return tried[-1].plan
                break
            if max(tried[-1].excess[kind] for kind in OF_PISTON) <= 1:
                break  # a thicker piston would not help
    if not tried:
        raise _no_stroke(request, joints, stroke, fitting[0])
    if able := [found for found in tried if found.worst <= 1]:
        return min(able, key=lambda found: found.cost).plan
    raise _too_much(request, min(tried, key=lambda found: found.worst))


def _diameters(request: Request, joints: Joints, screw: Screw) -> list[float]:
    """Pistons that house the screw and leave room between the legs of a pair [m], thinnest first."""
    most = joints.gap / 1.25 / OUTER
    rods = sizing.RODS if request.diameter is None else (request.diameter,)
    return [d for d in rods if TUBE * screw.nominal <= d <= most]


def _legs(request: Request, joints: Joints, stroke: float, screw: Screw) -> Iterator[SizedLeg]:
    """Legs to try, with stout pistons; where none is stout, the stoutest."""
    legs = [electric_leg(joints, stroke, screw, d) for d in _diameters(request, joints, screw)]
    there = [leg for leg in legs if leg is not None]
    stout = [leg for leg in there if leg.longest - leg.mouth <= sizing.SLENDER * leg.diameter]
    yield from stout or there[-1:]


def _try_leg(ideal: Plan, screw: Screw, leg: SizedLeg) -> ElectricTrial:
    """The robot with a screw and a leg: preload by the thrust, duration by the speed, then the motor by its torque."""
    parts = ElectricActuator(screw=screw, torque=MOTORS[0], preload=PRELOAD * screw.dynamic_load, load=1.0, leg_=leg)
    plan = _slowed(replace(ideal, leg=leg, parts=parts))
    found = _described(plan)
    for _ in MOTORS:
        chosen = _chosen(parts, found)
        if chosen == parts:
            break
        parts, plan = chosen, replace(plan, parts=chosen)
        found = _described(plan)
    legs, screws, _ = found
    thrust = max(one.thrust.value for one in screws)
    weight = sum(x.piston.mass + x.cylinder.mass for x in _study(plan).robot.legs)
    heavy, slow = weight / (HEAVY * ideal.request.payload), plan.duration / (SLOW * ideal.duration)
    return ElectricTrial(
        plan=plan, excess=_excess(plan, parts, legs, screws), thrust=thrust, cost=max(heavy, 1.0) * max(slow, 1.0)
    )


def _chosen(parts: ElectricActuator, found: Described) -> ElectricActuator:
    """The cylinder with a preload and a motor for the loads that were found; its motor no smaller than before."""
    _, screws, rest = found
    thrust, rating = max(one.thrust.value for one in screws), parts.screw.dynamic_load
    preload = float(np.clip(SPARE * thrust / UNLOADS / rating, PRELOAD, HIGHEST)) * rating
    needed = max(max(s.rms_torque, s.torque.value / 3, s.back_torque) for s in screws)
    larger = [torque for torque in MOTORS if torque >= max(SPARE * needed, parts.torque)]
    torque = larger[0] if larger else MOTORS[-1]
    return replace(parts, torque=torque, preload=sizing.round_significant(preload), load=sizing.round_significant(rest))


def _slowed(plan: Plan) -> Plan:
    """The plan, its motion no faster than the screw may turn, unless its duration is given."""
    if plan.request.duration is not None:
        return plan
    _, screws, _ = _described(plan)
    fast = max(s.speed.value for s in screws) / (NEARLY * _allowed(plan))
    if fast <= 1:
        return plan
    slow = (
        "the screws turn no faster than motor, nut and shaft allow (3000 rpm, 70,000 mm rpm, 0.8 of the critical speed)"
    )
    return replace(plan, duration=math.ceil(100 * plan.duration * fast) / 100, slow=slow)


def _allowed(plan: Plan) -> float:
    """Speed of the screw [rad/s] that motor, nut and shaft allow."""
    parts: ElectricActuator = plan.parts  # type: ignore[assignment]
    drive = _study(plan).robot.legs[0].screw
    return min(speed_limit(parts.screw), critical_speed(drive))  # type: ignore[arg-type]


def _study(plan: Plan) -> model.Study:
    return model.loads(write_study_text(plan))  # type: ignore[return-value]


def _described(plan: Plan) -> Described:
    """Legs and screws on the path; the thrust at rest [N]."""
    study = _study(plan)
    path = RigidPath(study, np.linspace(0.0, study.duration, INSTANTS))
    rest = np.abs(np.einsum("li,li->l", path.forces.joint_force[0], path.axes[0])).max()
    return describe_legs(path), describe_screws(path), float(rest)


def _excess(
    plan: Plan, parts: ElectricActuator, legs: tuple[LegDescription, ...], screws: tuple[ScrewDescription, ...]
) -> dict[str, float]:
    """Ratio of what the path demands to what the cylinder bears, by kind of load."""
    thrust = max(s.thrust.value for s in screws)
    stress = max(leg.stress.total.value / (leg.stress.yield_stress or np.inf) for leg in legs if leg.stress is not None)
    return {
        "speed": max(s.speed.value for s in screws) / _allowed(plan),
        "buckling of the screw": max(s.buckling.value for s in screws),
        "preload of the nut": thrust / (UNLOADS * parts.preload),
        "support bearing": thrust / parts.screw.bears,
        "life of the nut": max(HOURS / (s.hours or np.inf) for s in screws) ** (1 / 3),  # as a load
        "torque of the motor": max(max(s.rms_torque, s.torque.value / 3, s.back_torque) for s in screws) / parts.torque,
        "buckling of the piston": sizing.SAFETY * max(leg.euler_share.value for leg in legs),
        "stress of the piston": sizing.SAFETY * stress,
    }


def _no_room(request: Request, joints: Joints) -> InputError:
    least = 1.25 * OUTER * min(d for d in sizing.RODS if d >= TUBE * SCREWS[0].nominal)
    home = 1.01 * request.home * least / joints.gap
    if request.diameter is not None:
        return InputError(
            f"houses no screw of the catalogue, {SCREWS[0].name} to {SCREWS[-1].name}, with room between the legs",
            key=f"{OPTION} diameter", value=request.texts["diameter"],
            allowed=f"{text(TUBE * SCREWS[0].nominal, 'm')} to {text(joints.gap / 1.25 / OUTER, 'm')}",
            next_step="Leave it out, or give drive=hydraulic, or --ideal",
        )  # fmt: skip
    return InputError(
        "is too small for electric cylinders: joints of a pair are "
        f"{text(joints.gap, 'm')} apart, and the thinnest need {text(least, 'm')}",
        key=f"{OPTION} {'home' if request.platform is None else 'platform'}",
        value=request.texts.get("home" if request.platform is None else "platform"),
        allowed=f"{text(home, 'm')} and more"
        if request.platform is None
        else f"{text(least / joints.gap * joints.platform, 'm')} and more",
        next_step=f"Give home = {text(home, 'm')}, or --ideal for legs without drives",
    )


def _no_stroke(request: Request, joints: Joints, stroke: float, screw: Screw) -> InputError:
    diameter = _diameters(request, joints, screw)[0]
    most = longest_stroke(joints, screw, diameter)
    legs = f"legs of {text(joints.length, 'm')} and screws {screw.name}"
    larger = 1.05 * request.home * stroke / max(most, 0.05 * joints.length)
    return InputError(
        "does not fit into electric cylinders of this length: bearing, nut and stroke are one behind the other",
        key=f"{OPTION} stroke",
        value=request.texts.get("stroke", text(stroke, "m")),
        allowed=f"at most {text(0.995 * most, 'm')} with {legs}" if most > 0 else f"none with {legs}",
        next_step=f"Give a shorter stroke, or home = {text(larger, 'm')}, or drive=hydraulic, or --ideal",
    )


def _too_much(request: Request, tried: ElectricTrial) -> InputError:
    kind, ratio = max(tried.excess.items(), key=lambda item: item[1])
    parts: ElectricActuator = tried.plan.parts  # type: ignore[assignment]
    if request.duration is not None and kind in ("speed", "torque of the motor"):
        least = tried.plan.duration * (ratio if kind == "speed" else math.sqrt(ratio))
        return InputError(
            f"is too fast for screws {parts.screw.name}: {kind}, {ratio:.3g} times what it may be",
            key=f"{OPTION} duration",
            value=request.texts["duration"],
            allowed=f"about {math.ceil(100 * least) / 100:g} s and more",
            next_step="Give a longer duration or none, a shorter stroke, or drive=hydraulic",
        )
    enough = [
        screw for screw in SCREWS
        if min(UNLOADS * HIGHEST * screw.dynamic_load, screw.bears) >= tried.thrust
        and screw.nominal > parts.screw.nominal
    ]  # fmt: skip
    larger = 1.02 * 1.25 * OUTER * TUBE * 1.15 * enough[0].nominal / tried.plan.joints.gap if enough else 1.5
    share = 1.3 * 9.81 * request.payload / 6  # of its weight on a leg, in a robot that stands well
    able = share <= UNLOADS * HIGHEST * SCREWS[-1].dynamic_load and (enough or parts.screw != SCREWS[-1])
    grow = f"home = {text(max(larger, 1.1) * request.home, 'm')}, or " if able else ""
    most = " (the largest that fit)" if enough else ""
    return InputError(
        f"is too much for electric cylinders with screws {parts.screw.name}{most}: {kind}, {ratio:.3g} times what it "
        f"may be at a thrust of {text(tried.thrust, 'N')}",
        key=f"{OPTION} payload",
        value=request.texts.get("payload", request.payload),
        allowed=f"screws {SCREWS[0].name} to {SCREWS[-1].name} of the catalogue",
        next_step=f"Give {grow}a smaller payload, or drive=hydraulic, or --ideal",
    )
