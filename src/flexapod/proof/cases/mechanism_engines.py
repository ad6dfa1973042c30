"""Robots of other kinds than six legs UPS, against MuJoCo and CalculiX."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexapod import model, rigid
from flexapod.exchange.export import abaqus_deck
from flexapod.proof.case import Case, Check, checks
from flexapod.proof.engines import calculix
from flexapod.proof.engines.engine import CALCULIX, MUJOCO
from flexapod.study.kinematics import inverse_dynamics
from flexapod.study.static import modes

WRENCH = np.array([30.0, -20.0, 10.0, 5.0, -4.0, 3.0])
DURATION, INSTANTS = 0.4, 20
AMPLITUDES: dict[str, dict[Any, float]] = {
    "tripod": {"heave": 0.02, "roll": 0.1, "pitch": -0.08},
    "flight-simulator": {"surge": 0.05, "heave": 0.05, "roll": 0.1, "yaw": -0.1},
}
COUNT = {"tripod": 6, "flight-simulator": 6}


def _robot(preset: str) -> model.Robot:
    return model.preset(preset).robot  # type: ignore[union-attr]


def _forces() -> list[Check]:
    from flexapod.proof.engines import mujoco_forces

    found = []
    for name, amplitudes in AMPLITUDES.items():
        robot, motion = _robot(name), model.CombinedMotion(amplitudes=amplitudes, duration=DURATION)
        ours = inverse_dynamics(robot, motion, load=WRENCH, output_step=DURATION / INSTANTS)
        theirs = mujoco_forces.inverse_dynamics(robot, rigid.poses(robot, motion, ours.time.values), WRENCH)
        pairs = {
            "drives": (ours.drive_force_rigid.values, theirs.actuator_force),
            "joints": (ours.joint_force_rigid.values, theirs.joint_force),
        }
        found += [
            Check(
                what=f"{name}, {part}",
                reference=0,
                ours=float(np.abs(a - b).max() / np.abs(b).max()),
                tolerance=1e-8,
                absolute=True,
            )
            for part, (a, b) in pairs.items()
        ]
    return found


def _frequencies() -> list[Check]:
    found = []
    for name, count in COUNT.items():
        robot = _robot(name)
        theirs = calculix.run(abaqus_deck(robot, elements=20, modes=count + 2)).frequencies()[:count]
        ours = modes(robot).frequency.values[:count]
        found += checks([f"{name}, mode {i}" for i in range(1, count + 1)], theirs, ours, 5e-3, "Hz")
    return found


MUJOCO_MECHANISMS = Case(
    name="mujoco-mechanisms",
    statement="Drive and joint forces of the presets tripod (3-RPS) and flight-simulator (6-UCU), rigid, moved and "
    "loaded at their tools: largest difference over the largest force",
    source="MuJoCo, inverse dynamics of the open chains; hinges, cylindrical and universal joints as it has them",
    argument="both are exact: rounding times the condition of the closures (below 1e3), twice inverted",
    compute=_forces,
    engine=MUJOCO,
)

CALCULIX_MECHANISMS = Case(
    name="calculix-mechanisms",
    statement="Frequencies of the presets tripod (3-RPS) and flight-simulator (6-UCU) under gravity, drives locked",
    source="CalculiX, *STATIC with NLGEOM, then *FREQUENCY, on the deck of `flexapod export`, 20 elements a piston",
    argument="shear and rotary inertia, which beams have not: ten times (thickness / length)^2 in stiffness, at most "
    "1e-2; and the weight of what turns, which the deck's linear equations leave out",
    compute=_frequencies,
    engine=CALCULIX,
)
