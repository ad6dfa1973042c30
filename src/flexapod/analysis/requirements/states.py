"""States in which a requirement is judged: cold and warm, with the least and the most payload."""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import numpy as np

from flexapod import kinematics
from flexapod.analysis.pose_errors.tolerances import thermal_drift
from flexapod.common.errors import ComputationError
from flexapod.common.quantities import number
from flexapod.model import Heat, Requirement, Robot, Study
from flexapod.model.heat import HEAT_PARTS, LEG_PARTS

COLD, WARM = "cold", "warm"


@dataclass(frozen=True, kw_only=True)
class LoadState:
    """A study as it is in one state: ``heat`` "cold", "warm", or "" of a robot without temperatures, ``mass`` [kg].

    ``words``: "cold, 25 kg".
    """

    study: Study
    heat: str
    mass: float

    @property
    def words(self) -> str:
        """LoadState in words."""
        return ", ".join(filter(None, [self.heat, f"{number(self.mass, 4)} kg"]))


def states_of(study: Study) -> list[LoadState]:
    """States of a study: of a robot with temperatures cold first, of a payload between two masses the most first."""
    robot, wanted = study.robot, cast("Requirement", study.requirement)
    masses = [robot.payload.mass] if wanted.payload is None else sorted({*wanted.payload.tolist()}, reverse=True)
    loaded = [with_payload(robot, mass, wanted.payload_com) for mass in masses]
    heats = {"": robot.heat} if robot.heat is None else {COLD: None, WARM: warm_heat(robot)}
    return [
        LoadState(study=_with_robot(study, one.replace(heat=heat)), heat=words, mass=mass)
        for words, heat in heats.items()
        for mass, one in zip(masses, loaded, strict=True)
    ]


def _with_robot(study: Study, robot: Robot) -> Study:
    return study if robot == study.robot else study.replace(robot=robot)


def as_drawn(study: Study) -> Study:
    """The study of the robot with its own payload, at the temperature of the drawing and made exactly to it."""
    return _with_robot(study, study.robot.replace(heat=None, geometry=None, tolerances=None))


def with_payload(robot: Robot, mass: float, com: np.ndarray | None) -> Robot:
    """The robot with a payload of another mass [kg], inertia in proportion, perhaps another centre of mass."""
    payload = robot.payload
    if mass == payload.mass and com is None:
        return robot
    inertia = payload.inertia * (mass / payload.mass)
    return robot.replace(
        payload=payload.replace(
            mass=mass, inertia=inertia, com=payload.com if com is None else com, tool=payload.tool
        )
    )  # fmt: skip


def warm_heat(robot: Robot) -> Heat:
    """Temperatures of the warm robot: of a table over time those at which the tool has drifted farthest at home."""
    heat = cast("Heat", robot.heat)
    if heat.time is None:
        return heat
    try:
        drift = thermal_drift(robot, kinematics.home_pose(robot), heat.time)[:, :3]
        at = int(np.argmax(np.linalg.norm(drift, axis=1)))
    except ComputationError:  # held more often than it needs: the end of the table
        at = len(heat.time) - 1
    parts = {}
    for name in HEAT_PARTS:
        if heat.warms(name):
            there = heat.temperatures(name, robot.count)[at]
            parts[name] = there.tolist() if name in LEG_PARTS else float(there[0])
    return Heat(reference=heat.reference, expansion=heat.expansion, gradient=heat.gradient, **parts)
