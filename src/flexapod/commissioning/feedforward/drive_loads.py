"""What a path asks of the drives, over what they may do, Eq. (T22.17)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod import kinematics
from flexapod.analysis.checks.screws import motor_torque
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.units import quantity
from flexapod.kinematics import COORDINATES, DRIVEN
from flexapod.model import Robot, Study

__all__ = ["DriveLimits", "limits_of"]

Given = float | str | None


@dataclass(frozen=True, kw_only=True)
class DriveLimits:
    """Largest `speed` [m/s], `acceleration` [m/s^2] and `force` [N] of every drive, of cranks in rad and N m; or none.

    What screws and motors of the study are made for counts besides.
    """

    speed: float | None
    acceleration: float | None
    force: float | None

    def forces(self, robot: Robot) -> bool:
        """Whether they bound forces or torques of the drives."""
        return self.force is not None or _motors(robot)

    def shares(self, path: RigidPath, force: Array | None = None) -> tuple[Array, Array]:
        """Speeds (T, any), and what grows with accelerations (T, any), each over its limit, with sign.

        `force`, (T, legs) [N]: of the drives where these are not those of the rigid robot.
        """
        robot = path.robot
        driven = kinematics.rigid_limbs(robot).state == DRIVEN
        values = np.stack([np.stack(path.legs.coordinate(name), axis=0) for name in COORDINATES], axis=-1)
        rate, bend = values[1][:, driven], values[2][:, driven]
        force = path.forces.drive_force if force is None else force
        fast = [rate / self.speed] if self.speed is not None else []
        strong = [bend / self.acceleration] if self.acceleration is not None else []
        strong += [force / self.force] if self.force is not None else []
        for i, leg in enumerate(robot.legs):
            if leg.screw is None:
                continue
            limits, rates = leg.screw.limits, (path.legs.rate[:, i], path.legs.accel[:, i])
            if limits.speed is not None:
                fast.append((rates[0] / leg.screw.per_turn * leg.screw.rotor.ratio / limits.speed)[:, None])
            if limits.force is not None:
                strong.append((force[:, i] / limits.force)[:, None])
            if limits.torque is not None:
                strong.append((motor_torque(leg.screw, force[:, i], *rates) / limits.torque)[:, None])
        none = np.zeros((len(path.time), 1))
        return np.concatenate([none, *fast], axis=1), np.concatenate([none, *strong], axis=1)


def limits_of(study: Study, speed: Given, acceleration: Given, force: Given) -> DriveLimits:
    """The limits that are given and those of the study.

    Raises
    ------
    InputError
        None of them bounds accelerations: the least time would be 0.
    """
    kinds = {"speed": "velocity", "acceleration": "acceleration", "force": "force"}
    found: dict[str, float | None] = {}
    for (name, dimension), value in zip(kinds.items(), (speed, acceleration, force), strict=True):
        found[name] = None if value is None else quantity(value, dimension, key=name)
        if found[name] is not None and not found[name] > 0:  # type: ignore[operator]
            raise InputError("is not a limit", key=name, value=value, allowed="above 0")
    limits = DriveLimits(**found)
    if limits.acceleration is None and not limits.forces(study.robot):
        raise InputError(
            "says nowhere what its drives may do: the least time would be 0",
            file=study.path,
            key="force",
            allowed='force = "2 kN" or acceleration = "5 m/s^2" of every drive; leg.drive.limits of screws',
        )
    return limits


def _motors(robot: Robot) -> bool:
    given = [leg.screw.limits for leg in robot.legs if leg.screw is not None]
    return any(limits.force is not None or limits.torque is not None for limits in given)
