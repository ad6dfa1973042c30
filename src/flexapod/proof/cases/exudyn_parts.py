"""A hexapod on joints that give way, springs and screws, against Exudyn."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from flexapod import model
from flexapod.proof.case import Check, case
from flexapod.proof.engines.engine import EXUDYN
from flexapod.proof.engines.exudyn_integration import Integration
from flexapod.proof.engines.exudyn_robot import STEP, simulate_robot
from flexapod.study.simulation import simulate

ELEMENTS, GUIDE = 10, 0.03
DURATION, DAMPER = 0.3, 2e4  # s, N s/m
LOOP = model.Feedback(stiffness=2e3, damping=2.0)  # N m/rad, N m s/rad
MOTION = model.CombinedMotion(
    amplitudes={"surge": 0.03, "sway": 0.01, "heave": 0.02, "pitch": 0.05, "yaw": 0.04},
    duration=0.2,
    profile="smooth",
)


def damped(robot: model.Robot, **drive: Any) -> model.Robot:
    """A robot on screws with a damper for every loss factor, as drawn, without damping of its pistons."""
    none = {"stiffness_loss": None, "stiffness_damping": DAMPER}

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
            drive=screw.replace(**lossy, **drive),
        )

    return robot.replace(heat=None, tolerances=None, legs=tuple(leg(old) for old in robot.legs))


def _compared(name: str, robot: model.Robot) -> Iterator[Check]:
    """Path, drive forces and deflections of a robot, by Exudyn and by us."""
    plan = Integration(duration=DURATION, step=STEP)
    theirs = simulate_robot(robot, MOTION, plan, elements=ELEMENTS, guide=GUIDE)
    data = simulate(robot, MOTION, modes=3, axial_modes=2, step=STEP, output_step=STEP, duration=DURATION)
    a, b = theirs.com_deviation, data.com_deviation.values
    yield Check(f"{name}: sag at the start, z", a[0, 2], b[0, 2], 1e-4, "m")
    for what, x, y, unit, bound in (
        ("deviation from the path", a, b, "m", 1e-2),
        ("drive force", theirs.actuator_force, data.actuator_force.values, "N", 2e-3),
        ("deflection of a tip", theirs.tip_deflection, data.tip_deflection.values, "m", 8e-2),
    ):
        peak = float(np.abs(x).max())
        yield Check(f"{name}: {what}, largest", peak, float(np.abs(y).max()), bound, unit)
        worst = float(np.abs(x - y).max())
        yield Check(f"{name}: {what}, largest difference", 0.0, worst, bound * peak, unit, absolute=True)


@case(
    name="exudyn-real-parts",
    statement="Preset machine-hexapod with viscous dampers, as drawn: joints that give way along and across their "
    "legs, plates, screws with rotors, flexible pistons; moved in five directions in 0.2 s, rotors held and in loops",
    source="Exudyn, run on the spot: springs on slides of kinematic trees and between bodies, rotors as masses, "
    "pistons of 10 cable elements through two rings",
    argument="rings 30 mm apart are softer than a clamp by d/s, a tenth of the deflection of a tip, of which the path "
    "hears little; k of a screw at the commanded length, wrong by the deviation over the length, 1e-4; the same step",
    engine=EXUDYN,
)
def exudyn_real_parts() -> list[Check]:
    """The machine hexapod with rotors that are held and with servo loops."""
    robot = model.preset("machine-hexapod").robot
    return [
        *_compared("held", damped(robot)),
        *_compared("loop", damped(robot, command="servo", loop=LOOP)),
    ]
