"""Forces of the rigid robot, against MuJoCo."""

from __future__ import annotations

import numpy as np

from flexapod import model, rigid
from flexapod.proof.case import Case, Check
from flexapod.proof.engines.engine import MUJOCO
from flexapod.proof.unlike import unlike_legs
from flexapod.study.kinematics import inverse_dynamics
from flexapod.typing import Array

PIVOT = (0.02, 0.01, 0.1)
DURATION, INSTANTS = 0.2, 40
WRENCH = np.array([30.0, -20.0, 10.0, 5.0, -4.0, 3.0])
AMPLITUDES: dict[str, float] = {"surge": 0.05, "sway": 0.05, "heave": 0.05, "roll": 0.3, "pitch": 0.3, "yaw": 0.3}
COMBINED = {"surge": 0.02, "sway": -0.03, "heave": 0.02, "roll": 0.15, "pitch": -0.1, "yaw": 0.2}
AXIAL = (
    (0.04, 0.3),
    (0.02, 0.2),
)  # of cylinder and piston, odd and even legs [kg m^2]: hardly less than a body can have
LIGHT = 1.0  # kg, and 0.01 kg m^2: a payload beside which the legs' turn about their axes counts


def motions() -> dict[str, model.Motion]:
    """The motions of the case by name."""
    one = {
        axis: model.AxisMotion(type=axis, amplitude=amplitude, duration=DURATION, pivot=PIVOT)  # type: ignore[arg-type]
        for axis, amplitude in AMPLITUDES.items()
    }
    return {**one, "all at once": model.CombinedMotion(amplitudes=COMBINED, duration=DURATION, pivot=PIVOT)}  # type: ignore[arg-type]


def robots() -> dict[str, model.Robot]:
    """The robots of the case by name."""
    layout = model.preset("paper-robot")
    robot = layout.robot
    turning = [
        leg.replace(
            cylinder=leg.cylinder.replace(axial_inertia=AXIAL[i % 2][0]),
            piston=leg.piston.replace(axial_inertia=AXIAL[i % 2][1]),
        )
        for i, leg in enumerate(robot.legs)
    ]
    light = robot.payload.replace(mass=LIGHT, inertia=0.01 * LIGHT * np.eye(3), com=np.zeros(3), tool=np.zeros(3))
    return {
        "preset": robot,
        "axial inertias, light payload": robot.replace(legs=turning, payload=light),
        "unlike legs": unlike_legs(robot),
    }


def _gap(ours: Array, theirs: Array) -> float:
    """Largest difference over the largest value."""
    return float(np.abs(ours - theirs).max() / np.abs(theirs).max())


def _compute() -> list[Check]:
    from flexapod.proof.engines import mujoco_forces

    found: list[Check] = []
    for name, robot in robots().items():
        for axis, motion in motions().items():
            ours = inverse_dynamics(robot, motion, load=WRENCH, output_step=DURATION / INSTANTS)
            theirs = mujoco_forces.inverse_dynamics(robot, rigid.poses(robot, motion, ours.time.values), WRENCH)
            gaps = {
                "drives": _gap(ours.actuator_force_rigid.values, theirs.actuator_force),
                "joints": _gap(ours.joint_force_rigid.values, theirs.joint_force),
            }
            found += [
                Check(what=f"{name}, {axis}, {part}", reference=0, ours=gap, tolerance=1e-8, absolute=True)
                for part, gap in gaps.items()
            ]
    return found


MUJOCO_FORCES = Case(
    name="mujoco-forces",
    statement="Drive and joint forces of the rigid robot that moves along and about every axis, loaded at its tool: "
    "largest difference over the largest force",
    source="MuJoCo, inverse dynamics of the open chains; the joint forces from the universal joints' and the payload's "
    "equations",
    argument="both are exact: rounding times the condition of the leg Jacobian (below 1e3), twice inverted",
    compute=_compute,
    engine=MUJOCO,
)
