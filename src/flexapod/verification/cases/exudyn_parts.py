"""Hexapod on compliant joints, springs and screws, against Exudyn."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from flexapod import model
from flexapod.analysis.simulation import simulate
from flexapod.common.arrays import Array
from flexapod.model.leg.friction import TurningStribeck
from flexapod.verification.case import Check, case, curve_checks
from flexapod.verification.engines.engine import EXUDYN
from flexapod.verification.engines.exudyn_integration import Integration
from flexapod.verification.engines.exudyn_robot import simulate_robot

ELEMENTS, GUIDE = 10, 0.03
DURATION, STEP, DAMPER = 0.3, 5e-4, 2e4  # s, s, N s/m
FRICTION = {
    "base_joint": model.JointFriction(moment=10.0, stribeck=TurningStribeck(moment=15.0, rate=0.02), presliding=2e-3),
    "platform_joint": model.JointFriction(mu=0.2, diameter=0.06, presliding=2e-3),
}
LOOP = model.Feedback(stiffness=2e3, damping=2.0)  # N m/rad, N m s/rad
MOTION = model.CombinedMotion(
    amplitudes={"surge": 0.03, "sway": 0.01, "heave": 0.02, "pitch": 0.05, "yaw": 0.04},
    duration=0.2,
    profile="smooth",
)


def with_dampers(robot: model.Robot, **drive: Any) -> model.Robot:
    """Nominal robot on screws with a damper for every loss factor, without friction and damping of its pistons."""
    none = {"stiffness_loss": None, "stiffness_damping": DAMPER, "friction": None}

    def leg(old: model.Leg) -> model.Leg:
        screw = old.screw
        if screw is None:
            raise ValueError("a robot on screws is needed")
        lossy = {name: getattr(screw, name).replace(loss=None, damping=DAMPER) for name in ("nut", "bearing")}
        return old.replace(
            damping=0.0,
            base_joint=old.base_joint.replace(**none),
            platform_joint=old.platform_joint.replace(**none),
            springs=tuple(spring.replace(loss=None, damping=DAMPER) for spring in old.springs),
            drive=screw.replace(friction=None, **lossy, **drive),
        )

    return robot.replace(heat=None, tolerances=None, legs=tuple(leg(old) for old in robot.legs))


def with_joint_friction(robot: model.Robot) -> model.Robot:
    """The robot with friction in all its joints and screws."""

    def leg(old: model.Leg) -> model.Leg:
        below, above = (getattr(old, end).replace(friction=law) for end, law in FRICTION.items())
        screw = old.drive.replace(friction=model.ScrewFriction(torque=0.8))
        return old.replace(base_joint=below, platform_joint=above, drive=screw)

    return robot.replace(legs=tuple(leg(old) for old in robot.legs))


def _curves(robot: model.Robot, *, flexible: bool = True) -> dict[str, tuple[Array, Array]]:
    """Path, drive forces and deflections of a robot, by Exudyn and by us."""
    plan: Any = {"step": STEP, "duration": DURATION}
    shapes: Any = {"modes": 3, "axial_modes": 2} if flexible else {"fidelity": "rigid"}
    theirs = simulate_robot(robot, MOTION, Integration(**plan), elements=ELEMENTS * flexible, guide=GUIDE)
    data = simulate(robot, MOTION, **shapes, **plan, output_step=STEP)
    names = ("com_deviation", "actuator_force", "tip_deflection")
    return {name: (getattr(theirs, name), data[name].values) for name in names}


def _checked(name: str, found: dict[str, tuple[Array, Array]]) -> Iterator[Check]:
    """Check largest values and largest differences of the curves of Exudyn and ours."""
    a, b = found["com_deviation"]
    yield Check(f"{name}: sag at the start, z", a[0, 2], b[0, 2], 1e-4, "m")
    for what, key, unit, bound in (
        ("deviation from the path", "com_deviation", "m", 1e-2),
        ("drive force", "actuator_force", "N", 5e-3),
        ("deflection of a tip", "tip_deflection", "m", 8e-2),
    ):
        if key in found:
            yield from curve_checks(f"{name}: {what}", *found[key], bound, bound, unit)


@case(
    "Preset machine-hexapod with viscous dampers, as drawn: joints that give way along and across their "
    "legs, plates, screws with rotors, flexible pistons; moved in five directions in 0.2 s, rotors held, in loops, and "
    "with friction of joints and screws",
    source="Exudyn, run on the spot: springs on slides of kinematic trees and between bodies, rotors as masses, "
    "pistons of 10 cable elements through two rings, LuGre's bristles in user functions",
    argument="rings 30 mm apart are softer than a clamp by d/s, a tenth of the deflection of a tip, of which the path "
    "hears little; k of a screw at the commanded length, wrong by the deviation over the length, 1e-4; the same step; "
    "what friction changes: loads of the step before, half a step of the 6 ms in which bristles bend",
    engine=EXUDYN,
)
def _exudyn_real_parts() -> list[Check]:
    robot = model.preset("machine-hexapod").robot
    plain = with_dampers(robot, command="servo", loop=LOOP)
    held, loop, everything = (_curves(x) for x in (with_dampers(robot), plain, with_joint_friction(plain)))
    del everything["tip_deflection"]  # by their moment: its friction acts on the cylinder, as cables have no frame
    without, rubbed = (_curves(x, flexible=False)["com_deviation"] for x in (plain, with_joint_friction(plain)))
    theirs, ours = (y - x for x, y in zip(without, rubbed, strict=True))
    return [
        *_checked("held", held),
        *_checked("loop", loop),
        *_checked("everything", everything),
        *curve_checks("what friction changes of the path, pistons rigid", theirs, ours, 0.04, 0.04, "m"),
    ]
