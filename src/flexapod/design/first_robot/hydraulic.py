"""Hydraulic cylinders of a first robot: the smallest usual bore that carries its path, and its tables."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from flexapod import model
from flexapod.analysis.description.hydraulic_description import HydraulicDescription, describe_hydraulics
from flexapod.analysis.description.robot_description import describe_legs
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.errors import InputError
from flexapod.common.quantities import text
from flexapod.design.first_robot import sizing
from flexapod.design.first_robot.catalogue import CYLINDERS
from flexapod.design.first_robot.electric import SLENDER, joint_lines, plate_lines
from flexapod.design.first_robot.sizing import OPTION, SizedLeg
from flexapod.design.first_robot.study_text import (
    LEG,
    Plan,
    comment_lines,
    length_text,
    material_words,
    stroke_origin,
    value_origin,
    write_study_text,
)
from flexapod.design.first_robot.warm import accuracy_tables
from flexapod.model import MATERIALS

SUPPLY = 140e5  # pressure [Pa]
SHARE = 0.25  # of the supply that the largest thrust takes: room for the valve, and stiff
FASTEST = 1.0  # of the piston [m/s]
WALL = 1.2  # diameter of the tube over the bore
JOINT = 0.6  # bore of a joint's bearings over that of the cylinder
INSTANTS = 301
STEEL = MATERIALS["steel"].density


@dataclass(frozen=True, kw_only=True)
class HydraulicActuator:
    """A cylinder of a `bore` [m] with its leg; `load`: thrust at rest [N]."""

    bore: float
    leg_: SizedLeg
    load: float = 1.0
    sources: tuple[str, ...] = (
        "The legs are hydraulic cylinders of usual bores and rods; what is chosen besides is in proportion to the "
        "presets motion-base and machine-hexapod.",
    )

    @property
    def area(self) -> float:
        """Area on which the oil pushes the piston out [m^2]."""
        return math.pi / 4 * self.bore**2

    def cylinder(self) -> tuple[float, float, float, float]:
        """Mass [kg], centre of mass [m], inertia across about it and along the axis [kg m^2]."""
        outer, inner, mouth = WALL * self.bore / 2, self.bore / 2, self.leg_.mouth
        tube = STEEL * math.pi * (outer**2 - inner**2) * mouth
        mass = 2 * tube
        return mass, mouth / 2, mass * (3 * (outer**2 + inner**2) + mouth**2) / 12, 2 * tube * outer**2

    def leg(self, plan: Plan) -> list[str]:
        """The table of the legs."""
        return [LEG, *_leg(self, plan), "", *_drive(self)]

    def tables(self, plan: Plan) -> list[str]:
        """Tables of temperatures and tolerances of the machine."""
        warm = {"piston": (25, "between the oil and the hall"), "cylinder": (30, "warmed by its oil of some 40 degC")}
        return accuracy_tables(plan, warm, lead=False)


def hydraulic_robot(ideal: Plan) -> Plan:
    """The robot with hydraulic cylinders.

    Parameters
    ----------
    ideal : Plan
        The robot with ideal legs, whose motion is that of the path.

    Raises
    ------
    InputError
        No cylinder fits or carries it; the message names the number to change.
    """
    joints, stroke, given_ = ideal.joints, sizing.leg_stroke(ideal.request), ideal.request.diameter
    worst: tuple[float, str, Plan] | None = None
    for bore, rod in CYLINDERS:
        if 1.25 * WALL * bore > joints.gap or (given_ is not None and rod != given_):
            continue
        leg = sizing.size_leg(joints, stroke, rod)
        if leg is None:
            continue
        plan, excess = _try_bore(ideal, leg, bore)
        ratio, kind = max((value, name) for name, value in excess.items())
        if ratio <= 1:
            return plan
        if worst is None or ratio < worst[0]:
            worst = ratio, kind, plan
    raise _unfit(ideal, worst)


def _try_bore(ideal: Plan, leg: SizedLeg, bore: float) -> tuple[Plan, dict[str, float]]:
    """The robot with a cylinder, and what its path asks for over what it bears, by kind."""
    plan = _slowed(replace(ideal, leg=leg, parts=HydraulicActuator(bore=bore, leg_=leg)))
    path = _path(plan)
    oil, legs = describe_hydraulics(path), describe_legs(path)
    rest = float(np.abs(np.einsum("li,li->l", path.forces.joint_force[0], path.axes[0])).max())
    parts = HydraulicActuator(bore=bore, leg_=leg, load=sizing.round_significant(rest))
    stress = max(x.stress.total.value / (x.stress.yield_stress or np.inf) for x in legs if x.stress is not None)
    return replace(plan, parts=parts), {
        "pressure": max(x.pressure.value for x in oil) / (SHARE * SUPPLY),
        "speed": _speed(oil, parts) / FASTEST,
        "buckling of the rod": sizing.SAFETY * max(x.euler_share.value for x in legs),
        "stress of the rod": sizing.SAFETY * stress,
        "length of the rod": (leg.longest - leg.mouth) / (sizing.SLENDER * leg.diameter),
    }


def _path(plan: Plan) -> RigidPath:
    study: model.Study = model.loads(write_study_text(plan))  # type: ignore[assignment]
    return RigidPath(study, np.linspace(0.0, study.duration, INSTANTS))


def _speed(oil: tuple[HydraulicDescription, ...], parts: HydraulicActuator) -> float:
    return max(x.flow.value for x in oil) / parts.area


def _slowed(plan: Plan) -> Plan:
    """The plan, its pistons no faster than seals like it, unless its duration is given."""
    fast = _speed(describe_hydraulics(_path(plan)), plan.parts) / (0.95 * FASTEST)  # type: ignore[arg-type]
    if fast <= 1 or plan.request.duration is not None:
        return plan
    slow = "pistons move by 1 m/s at most"
    return replace(plan, duration=math.ceil(100 * plan.duration * fast) / 100, slow=slow)


def _leg(self: HydraulicActuator, plan: Plan) -> list[str]:
    leg, request = self.leg_, plan.request
    mass, com, across, along = self.cylinder()
    shear = leg.shortest - leg.mouth < SLENDER * leg.diameter
    diameter = value_origin(
        request.diameter,
        f"the rod of the cylinder, {sizing.SAFETY:g} times safe against buckling and yield, no longer outside than "
        f"{sizing.SLENDER:g} times its width",
    )
    return [
        *joint_lines(max(round(JOINT * self.bore, 3), 0.003), self.load, ""),
        *plate_lines(plan),
        f'cylinder = {{ mass = "{mass:.4g} kg", com = "{length_text(com)}", inertia = {across:.4g}, '
        f'mouth = "{length_text(leg.mouth)}", axial_inertia = {along:.3g} }}',
        *comment_lines(
            f"mouth: computed, {sizing.MOUTH:g} of the leg at home, but as deep as the rod needs when drawn in; mass: "
            f"a steel tube with a wall of {length_text(round((WALL - 1) / 2 * self.bore, 6))}, ends, manifold and oil "
            "as much again; com, inertia: of such a rod"
        ),
        f'piston = {{ diameter = "{length_text(leg.diameter)}", length = "{length_text(leg.piston)}", '
        f'material = "{request.material}"{", shear = true" if shear else ""} }}',
        *comment_lines(
            f"diameter: {diameter}; length: as far as it comes out and two widths that stay guided; "
            f"{material_words(request)}{'; shear: it is short and thick' if shear else ''}"
        ),
        f'stroke = {{ min = "{length_text(leg.shortest)}", max = "{length_text(leg.longest)}" }}   # joint to joint',
        *comment_lines(f"stroke: {stroke_origin(request)}; half of it either way"),
        "damping = 0.005              # chosen: usual for bare metal; the oil damps more",
    ]  # fmt: skip


def _drive(self: HydraulicActuator) -> list[str]:
    leg = self.leg_
    swept = 1e3 * self.area * (leg.longest - leg.shortest)
    return [
        "[leg.drive]",
        'type = "hydraulic"',
        f'bore = "{length_text(self.bore)}"',
        *comment_lines(f"bore: computed, the smallest usual one that carries the path with a quarter of the supply's "
               f"{SUPPLY / 1e5:g} bar: the valve keeps most, and the oil is stiff"),
        f'rod = "{length_text(leg.diameter)}"   # as the piston: half of the area, as usual',
        f'stroke = "{length_text(round(leg.longest - leg.shortest, 9))}"   # as leg.stroke',
        f'dead_volume = ["{0.05 * swept:.3g} l", "{0.09 * swept:.3g} l"]',
        *comment_lines("dead_volume: chosen, ports, cushions and pipes: a twentieth of what the head sweeps, and more "
               "at the rod's end, as in motion-base"),
        'bulk_modulus = "1.4 GPa"     # industrialmonitordirect.com: the lower end, of oil without free air',
        f'leakage = "{2e-12 * self.bore / 0.1:.2g} m^3/(s Pa)"   # chosen: by the gap, from motion-base',
        f'limits = {{ pressure = "{SUPPLY / 1e5:g} bar", flow = "{6e4 * self.area * FASTEST:.3g} l/min" }}',
        *comment_lines("limits: chosen, a supply of 2000 psi, and pistons of 1 m/s"),
    ]  # fmt: skip


def _unfit(ideal: Plan, worst: tuple[float, str, Plan] | None) -> InputError:
    request, joints = ideal.request, ideal.joints
    if request.diameter is not None and request.diameter not in [rod for _, rod in CYLINDERS]:
        return InputError(
            "is not the rod of a usual cylinder", key=f"{OPTION} diameter", value=request.texts["diameter"],
            allowed=", ".join(text(rod, "m") for _, rod in CYLINDERS), next_step="Leave it out, or give --ideal",
        )  # fmt: skip
    bore, rod = CYLINDERS[0]
    if worst is None and 1.25 * WALL * bore <= joints.gap and request.diameter is None:
        most = sizing.longest_stroke(joints, rod)
        larger = 1.05 * request.home * sizing.leg_stroke(request) / max(most, 0.05 * joints.length)
        return InputError(
            "does not fit into legs of this length", key=f"{OPTION} stroke", value=request.texts.get("stroke"),
            allowed=f"at most {text(0.995 * most, 'm')}",
            next_step=f"Give a shorter stroke, or home = {text(larger, 'm')}, or --ideal",
        )  # fmt: skip
    if worst is None:
        larger = max(1.02 * request.home * 1.25 * WALL * bore / joints.gap, 1.2 * request.home)
        return InputError(
            f"is too small for hydraulic cylinders: the thinnest is {text(WALL * bore, 'm')} wide",
            key=f"{OPTION} home", value=request.texts.get("home"), allowed=f"{text(larger, 'm')} and more",
            next_step=f"Give home = {text(larger, 'm')}, or --ideal",
        )  # fmt: skip
    ratio, kind, plan = worst
    if kind == "speed":
        return InputError(
            f"is too fast: pistons would move with {ratio * FASTEST:.3g} m/s", key=f"{OPTION} duration",
            value=request.texts.get("duration"),
            allowed=f"{math.ceil(100 * plan.duration * ratio) / 100:g} s and more",
            next_step="Give a longer duration or none",
        )  # fmt: skip
    larger = 1.05 * request.home * math.sqrt(max(ratio, 1.1))
    return InputError(
        f"is too much for hydraulic cylinders that fit: {kind}, {ratio:.3g} times what it may be",
        key=f"{OPTION} payload", value=request.texts.get("payload"), allowed="a smaller payload, or a larger robot",
        next_step=f"Give home = {text(larger, 'm')}, or a smaller payload, or --ideal",
    )  # fmt: skip
