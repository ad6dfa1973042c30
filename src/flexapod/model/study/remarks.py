"""Plausibility remarks: what is legal but strains the theory, in words."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import cast

from flexapod.common.quantities import number, text
from flexapod.model.heat import HEAT_PARTS, Heat
from flexapod.model.leg.actuator import Actuator
from flexapod.model.leg.drive import ServoDrive
from flexapod.model.leg.leg import Leg
from flexapod.model.leg.material import MATERIALS
from flexapod.model.study.robot import Robot
from flexapod.model.study.simulation import Simulation

_SLENDER = 0.1
_RATIO = 0.1  # damping ratio of the advice for a drive without damping


def robot_remarks(robot: Robot) -> tuple[str, ...]:
    """Remarks on a robot's legs; the same remark for several legs is made once."""
    return _remarks_on(robot)


def _remarks(robot: Robot) -> tuple[str, ...]:
    numbers: dict[str, list[int]] = {}
    driven = sum(bool(leg.driven) for leg in robot.legs)
    share = 0.0 if robot.payload is None or not driven else robot.payload.mass / driven
    for i, leg in enumerate(robot.legs, start=1):
        for remark in (*_leg_remarks(leg), *_undamped(leg, share)):
            numbers.setdefault(remark, []).append(i)
        if robot.heat is not None and robot.heat.warms("piston") and _expands_unknown(robot.heat, leg):
            numbers.setdefault(_LIKE_STEEL, []).append(i)
        for element in leg.elements:
            what = f"[leg.{element.at}] is not in the forces of the rigid robot"
            numbers.setdefault(what, []).append(i)
    told = (f"{_legs(which, robot.count)}: {remark}" for remark, which in numbers.items())
    return (*told, *(() if robot.heat is None else _cold(robot.heat)), *_straight(robot))


_remarks_on = cast("Callable[[Robot], tuple[str, ...]]", lru_cache(maxsize=64)(_remarks))


def _straight(robot: Robot) -> list[str]:
    """Scatter of bending stiffness of legs that are straight."""
    joints = (joint for leg in robot.legs for joint in (leg.base_joint, leg.platform_joint))
    bent = any(leg.piston.bow for leg in robot.legs) or any(joint.eccentricity for joint in joints)
    bent = bent or (robot.heat is not None and robot.heat.gradient is not None)
    if robot.tolerances is None or robot.tolerances.EI is None or bent:
        return []
    return ["tolerances.EI has no effect: it counts in legs under thrust with a bow, an eccentricity or heat.gradient"]


def settings_remarks(robot: Robot, simulation: Simulation) -> tuple[str, ...]:
    """Settings about friction and play of robots in which nothing rubs or has play."""
    rubs = any(x.friction for leg in robot.legs for x in (leg.base_joint, leg.platform_joint, leg.drive))
    slack = any(leg.half_play for leg in robot.legs)
    found = {"friction": simulation.friction == "stuck" and not rubs, "play": simulation.play == "gap" and not slack}
    return tuple(
        f"simulation.{name} = {getattr(simulation, name)!r} has no effect: no joint and no drive has {name}"
        for name, idle in found.items()
        if idle
    )


def _cold(heat: Heat) -> list[str]:
    """Temperatures that warm nothing: parts whose expansion is given and whose temperature is not."""
    across = heat.gradient is not None and heat.gradient.piston is not None
    warm = [part for part in HEAT_PARTS if heat.warms(part)] + ["piston"] * across
    if not warm:
        return ["heat has no effect: every part is as warm as heat.reference"]
    given = [part for part in HEAT_PARTS if getattr(heat.expansion, part, None) is not None]
    return [
        f"heat.expansion.{part} has no effect: without heat.{part} it is as warm as heat.reference"
        for part in given
        if part not in warm
    ]


_LIKE_STEEL = "the piston's expansion is not known, and steel's is taken: give heat.expansion.piston"


def _expands_unknown(heat: Heat, leg: Leg) -> bool:
    return leg.piston.expansion is None and (heat.expansion is None or heat.expansion.piston is None)


def actuator_remarks(actuator: Actuator, basis: str | None) -> tuple[str, ...]:
    """Remarks on a single actuator's beam and the lateral shapes chosen for it (None: rigid beam)."""
    remarks = []
    depth = actuator.section.depth if actuator.section is not None else 0.0
    if depth > _SLENDER * actuator.free_length:
        remarks.append(f"the beam is {depth:g} m deep, {_fat(depth, actuator.free_length, 'free length at t = 0')}")
    if basis == "clamped-free" and (actuator.tip_mass > 0 or actuator.tip_inertia > 0):
        remarks.append(
            'shapes of basis "clamped-free" know nothing of the inertia at the tip and converge slowly with it: '
            'check with more modes, or choose basis = "tip-load" or "tip-mass"'
        )
    return tuple(remarks)


def _leg_remarks(leg: Leg) -> list[str]:
    piston, cylinder = leg.piston, leg.cylinder
    remarks = []
    if piston.diameter is not None and piston.diameter > _SLENDER * piston.length and not piston.shear:
        remarks.append(f"the piston is {piston.diameter:g} m wide, {_fat(piston.diameter, piston.length, 'length')}")
    known = piston.sections or (piston.depth is not None and piston.E is not None)
    if piston.yield_stress is not None and not known:
        remarks.append("yield_stress has no effect: stress needs the piston's diameter and material, not EI and EA")
    unknown = [str(j) for j, section in enumerate(piston.sections, start=1) if section.yield_stress is None]
    if 0 < len(unknown) < len(piston.sections):
        remarks.append(f"yield_stress of some sections has no effect: sections without: {', '.join(unknown)}")
    ball, springs = leg.platform_joint, ("stiffness", "bending", "torsion")
    sprung = any(getattr(ball, name) is not None for name in springs)
    if leg.letters.platform == "S" and ball.axis is not None and not sprung:
        remarks.append("platform_joint.axis has no effect: a joint S has none")
    bodies = {"cylinder": cylinder.material, "drive": None if leg.screw is None else leg.screw.material}
    for key, material in bodies.items():
        usual = None if material is None else MATERIALS.get(material.name)
        if material is not None and material.yield_stress != (usual and usual.yield_stress):
            remarks.append(f"{key}.yield_stress has no effect: stress is looked at in pistons and struts")
    oil = leg.cylinder_of_oil
    if oil is not None and piston.diameter is not None and abs(oil.rod - piston.diameter) > 1e-9:
        remarks.append(
            f"drive.rod is {text(oil.rod, 'm', 4)}, the piston's diameter {text(piston.diameter, 'm', 4)}: one for the "
            "oil, one for the stretch"
        )
    if cylinder.mass > 0 and cylinder.mouth > 0 and not 0 <= cylinder.com <= cylinder.mouth:
        remarks.append(
            f"the cylinder's centre of mass ({cylinder.com:g} m) lies outside the cylinder "
            f"(0 to its mouth at {cylinder.mouth:g} m)"
        )
    if cylinder.mass == 0 and cylinder.inertia > 0:
        remarks.append(f"the cylinder has inertia ({cylinder.inertia:g} kg m^2) but no mass")
    return remarks


def _undamped(leg: Leg, mass: float) -> list[str]:
    """A drive that is a spring and no damper: a leg's share of the payload and the spring go on vibrating."""
    drive = leg.drive
    if leg.driven == "carriage" or not mass:
        return []
    spring = drive if isinstance(drive, ServoDrive) else getattr(drive, "feedback", None)
    if spring is None or spring.stiffness == 0 or spring.damping > 0:
        return []
    key = "drive" if isinstance(drive, ServoDrive) else "drive.feedback"
    good = 2 * _RATIO * math.sqrt(spring.stiffness * mass)
    return [
        f"the {drive.type} drive has stiffness but no damping: what once vibrates on it goes on; "
        f"leg.{key}.damping = {number(good, 2)} N s/m, for example, is {_RATIO:.0%} of the critical one"
    ]


def _fat(depth: float, length: float, name: str) -> str:
    return (
        f"{depth / length:.0%} of its {name} of {length:g} m: above 10 % an Euler-Bernoulli beam is strained "
        "(shear and rotary inertia are left out)"
    )


def _legs(numbers: list[int], count: int) -> str:
    if len(numbers) == count:
        return "all legs"
    return ("leg " if len(numbers) == 1 else "legs ") + ", ".join(map(str, numbers))
