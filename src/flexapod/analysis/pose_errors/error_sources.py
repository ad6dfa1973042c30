"""Error sources of a robot at one pose, each computed on request, and their rows of an error budget."""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np

from flexapod import kinematics
from flexapod.analysis.pose_errors.backlash import PLACES, Play, half_play, play_along
from flexapod.analysis.pose_errors.bent_legs import BentLegs, bent_legs, has_bent_legs, thrust
from flexapod.analysis.pose_errors.sensitivity import Sensitivity, sensitivity, systematic
from flexapod.analysis.pose_errors.tolerances import ToleranceEffect, density_effect, tolerance_effects
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.kinematics.leg_geometry import COORDINATES
from flexapod.kinematics.robot import cache_per_robot
from flexapod.mechanics.elements.element import Contribution
from flexapod.mechanics.elements.registry import kinds_of
from flexapod.mechanics.elements.trial import wrap_hook_errors
from flexapod.model import Robot, Study


class PoseErrors:
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
        """Sensitivity of the tool to errors at the pose."""
        return self._known or sensitivity(self.path)

    @cached_property
    def play(self) -> Play:
        """Play, and the forces that press it."""
        return play_along(self.path, self.sensitivity)

    @property
    def has_backlash(self) -> bool:
        """Test whether any joint or drive has play."""
        return bool(half_play(self.robot).any())

    @cached_property
    def thrust(self) -> Array:
        """Thrust along the pistons, (n,) [N]."""
        return thrust(self.play)

    @cached_property
    def bent_legs(self) -> BentLegs | None:
        """Legs that are not straight, if any."""
        return bent_legs(self.robot, self.sensitivity, self.thrust) if has_bent_legs(self.robot) else None

    @cached_property
    def parts(self) -> dict[str, Array]:
        """Errors of the machine as built, with heat, and of legs that are not straight, (n, 6) by part."""
        found = systematic(self.robot, self.sensitivity)
        crooked = (
            {} if self.bent_legs is None else {"bent_legs": self.bent_legs.effect(self.path.axes[0], self.sensitivity)}
        )
        return found | crooked

    @cached_property
    def tolerance_effects(self) -> list[ToleranceEffect]:
        """Effects of the tolerances on the tool."""
        push = self.thrust if self._by_thrust else np.zeros(self.robot.count)
        return tolerance_effects(self.robot, self.sensitivity, push, lambda: self.density_effect)

    @property
    def _by_thrust(self) -> bool:
        return any(getattr(self.robot.tolerances, name, None) is not None for name in ("EA", "EI", "bow"))

    @cached_property
    def density_effect(self) -> Array:
        """Motion of the tool at rest per relative increase of piston density of each leg, (n, 6)."""
        return density_effect(self.study, self.pose)


class ErrorRow(NamedTuple):
    """One part: its `kind` of error (systematic, hysteretic, random, dynamic), and its `nature`.

    `nature`: of a systematic one calibratable, repeatable or drifting; empty of others. `stands`: of a random one, that
    it is the same at each approach of one machine.

    `by_leg` (n, 6): displacement [m] and rotation [rad] of the tool, world axes; of a random one standard
    deviations, of a hysteretic one bounds; (1, 6) of what acts on all legs at once. `how` it was computed, in words.
    """

    part: str
    kind: str
    nature: str
    by_leg: Array
    how: str
    stands: bool = False


def accuracy_rows(study: Study, pose: kinematics.Poses, known: Sensitivity | None = None) -> list[ErrorRow]:
    """Rows of geometry, heat, bent legs, tolerances and play at one pose; of what the study does not name none.

    `known`: the sensitivity there, where it is.
    """
    at = PoseErrors(study, pose, known)
    found = [ErrorRow(name, "systematic", _nature(name), by_leg, "first order") for name, by_leg in at.parts.items()]
    found += [
        ErrorRow(f"{one.name} tolerance", "random", "", one.sigma, "first order, errors independent", stands=True)
        for one in at.tolerance_effects
    ]
    found += _of_elements(study, at)
    if at.has_backlash:
        effect = np.abs(at.play.effect[0])
        how = "first order, whichever way the play is pressed"
        table = zip(PLACES, effect, strict=True)
        found += [ErrorRow(f"{place} play", "hysteretic", "", by_leg, how) for place, by_leg in table if by_leg.any()]
    return found


def _of_elements(study: Study, at: PoseErrors) -> list[ErrorRow]:
    """Rows of the errors of strokes by elements; equal ones of all legs are one row."""
    lengths, found = at.sensitivity.q[0, :, COORDINATES.index("l")], {}
    for i, error in _errors(study.robot):
        sizes = found.setdefault(error._replace(size=0.0), np.zeros(len(lengths)))
        size = error.size(lengths[i]) if callable(error.size) else error.size
        sizes[i] = np.hypot(sizes[i], size) if error.kind == "random" else sizes[i] + size
    moves = at.sensitivity.coordinate[0, :, COORDINATES.index("l")]
    by_leg = {error: sizes[:, None] * moves for error, sizes in found.items()}
    return [
        ErrorRow(error.name, error.kind, "", x if error.kind == "random" else np.abs(x), error.how, error.stands)
        for error, x in by_leg.items()
    ]


@cache_per_robot
def _errors(robot: Robot) -> list[tuple[int, Contribution]]:
    """The errors that elements of the legs make, each with the index of its leg."""
    found = []
    for i, leg in enumerate(robot.legs):
        for kind in kinds_of(robot.legs):
            with wrap_hook_errors(kind, "errors"):
                found += [(i, error) for own in kind.all_of(leg) for error in own.errors(leg)]
    return found


def _nature(part: str) -> str:
    if part.startswith("heat"):
        return "drifting"
    return "repeatable" if part == "bent_legs" else "calibratable"
