"""Forces of the rigid robot, against MuJoCo."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.kinematics import inverse_dynamics
from flexapod.verification.case import Check, case, checks
from flexapod.verification.engines import mujoco_forces
from flexapod.verification.engines.engine import MUJOCO
from flexapod.verification.robots import with_unequal_legs

PIVOT = (0.02, 0.01, 0.1)
DURATION, INSTANTS = 0.2, 40
WRENCH = np.array([30.0, -20.0, 10.0, 5.0, -4.0, 3.0])
AMPLITUDES: dict[str, float] = {"surge": 0.05, "sway": 0.05, "heave": 0.05, "roll": 0.3, "pitch": 0.3, "yaw": 0.3}
COMBINED = {"surge": 0.02, "sway": -0.03, "heave": 0.02, "roll": 0.15, "pitch": -0.1, "yaw": 0.2}
# Of cylinder and piston, odd and even legs [kg m^2]: hardly less than a body can have
AXIAL = ((0.04, 0.3), (0.02, 0.2))
MECHANISMS: dict[str, dict[Any, float]] = {
    "tripod": {"heave": 0.02, "roll": 0.1, "pitch": -0.08},
    "flight-simulator": {"surge": 0.05, "heave": 0.05, "roll": 0.1, "yaw": -0.1},
}
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
        "unlike legs": with_unequal_legs(robot),
    }


def _gaps(what: str, robot: model.Robot, motion: model.Motion, output_step: float) -> list[Check]:
    """Largest differences of drive and joint forces over the largest force."""
    ours = inverse_dynamics(robot, motion, load=WRENCH, output_step=output_step)
    theirs = mujoco_forces.inverse_dynamics(robot, kinematics.poses(robot, motion, ours.time.values), WRENCH)
    gap = (
        float(np.abs(a.values - b).max() / np.abs(b).max())
        for a, b in ((ours.drive_force_rigid, theirs.actuator_force), (ours.joint_force_rigid, theirs.joint_force))
    )
    return checks([f"{what}, drives", f"{what}, joints"], [0, 0], list(gap), 1e-8, absolute=True)


@case(
    "Drive and joint forces of the rigid robot that moves along and about every axis, loaded at its tool: "
    "largest difference over the largest force",
    source="MuJoCo, inverse dynamics of the open chains; the joint forces from the universal joints' and the "
    "payload's equations",
    argument="both are exact: rounding times the condition of the leg Jacobian (below 1e3), twice inverted",
    engine=MUJOCO,
)
def _mujoco_forces() -> Iterator[Check]:
    for name, robot in robots().items():
        for axis, motion in motions().items():
            yield from _gaps(f"{name}, {axis}", robot, motion, DURATION / INSTANTS)


@case(
    "Drive and joint forces of the presets tripod (3-RPS) and flight-simulator (6-UCU), rigid, moved and "
    "loaded at their tools: largest difference over the largest force",
    source="MuJoCo, inverse dynamics of the open chains; hinges, cylindrical and universal joints as it has them",
    argument="both are exact: rounding times the condition of the closures (below 1e3), twice inverted",
    engine=MUJOCO,
)
def _mujoco_mechanisms() -> Iterator[Check]:
    for name, amplitudes in MECHANISMS.items():
        robot = model.preset(name).robot  # type: ignore[union-attr]
        yield from _gaps(name, robot, model.CombinedMotion(amplitudes=amplitudes, duration=0.4), 0.02)
