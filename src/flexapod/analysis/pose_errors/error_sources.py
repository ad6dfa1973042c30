"""What is known of the accuracy of a robot at one pose, each part computed when it is asked for."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from flexapod import kinematics
from flexapod.analysis.pose_errors.backlash import Play, half_play, play_along
from flexapod.analysis.pose_errors.bent_legs import Bent, bent, is_crooked, thrust
from flexapod.analysis.pose_errors.sensitivity import Sensitivity, sensitivity, systematic
from flexapod.analysis.pose_errors.tolerances import Spreading, spreading
from flexapod.analysis.pose_errors.weight import by_density
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.model import Robot, Study

__all__ = ["AtPose"]


class AtPose:
    """A study's robot at rest at a pose, under gravity and the load at t = 0; `known`: its sensitivity there.

    Raises
    ------
    InputError
        The platform is fixed.
    """

    def __init__(self, study: Study, pose: kinematics.Poses, known: Sensitivity | None = None) -> None:
        if study.robot.platform_fixed:
            raise InputError(
                "leaves no pose that could be wrong", key="robot.platform.fixed", value=True,
                next_step="Use `flexapod modes`, or `flexapod check`",
            )  # fmt: skip
        self._known = known
        self.study: Study = study
        self.robot: Robot = study.robot
        self.pose: kinematics.Poses = kinematics.Poses.at_rest(pose.position, pose.rotation)

    @cached_property
    def path(self) -> RigidPath:
        """The pose as a path of one instant."""
        return RigidPath(self.study, np.zeros(1), self.pose)

    @cached_property
    def sensitivity(self) -> Sensitivity:
        """What errors do to the tool."""
        return self._known or sensitivity(self.robot, self.pose)

    @cached_property
    def play(self) -> Play:
        """Play, and the forces that press it."""
        return play_along(self.path, self.sensitivity)

    @property
    def is_loose(self) -> bool:
        """Whether any joint or drive has play."""
        return bool(half_play(self.robot).any())

    @cached_property
    def thrust(self) -> Array:
        """Thrust along the pistons, (n,) [N]."""
        return thrust(self.play)

    @cached_property
    def bent(self) -> Bent | None:
        """Legs that are not straight, if any."""
        return bent(self.robot, self.sensitivity, self.thrust) if is_crooked(self.robot) else None

    @cached_property
    def parts(self) -> dict[str, Array]:
        """Errors of the machine as built and warm, and of legs that are not straight, (n, 6) by part."""
        found = systematic(self.robot, self.sensitivity)
        crooked = {} if self.bent is None else {"bent_legs": self.bent.effect(self.path.axes[0], self.sensitivity)}
        return found | crooked

    @cached_property
    def spreading(self) -> list[Spreading]:
        """Its tolerances."""
        push = self.thrust if self._by_thrust else np.zeros(self.robot.count)
        return spreading(self.robot, self.sensitivity, push, lambda: self.weight)

    @property
    def _by_thrust(self) -> bool:
        return any(getattr(self.robot.tolerances, name, None) is not None for name in ("EA", "EI", "bow"))

    @cached_property
    def weight(self) -> Array:
        """What more density of the piston of each leg, relative to it, does to the tool at rest, (n, 6)."""
        return by_density(self.study, self.pose)
