"""The robot at rest at an instant of its path: equilibrium, modes, and the vibration that a motion leaves there."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.checks.estimates import residual_vibration
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.errors import FlexapodError
from flexapod.common.ranking import EQUALS, first_largest
from flexapod.solve.modal.elastic_robot import ElasticRobot
from flexapod.solve.modal.modes import RobotModes, single_pose_modes
from flexapod.solve.statics.locked_robot import LockedPoses

BAND = 1e-6  # amplitude at which the tool counts as settled [m]
HIGHEST = 2e3  # [Hz]: no motion of a machine excites a mode above
PER_PERIOD, FEWEST, MOST = 12, 2000, 100_000  # instants of the motion: of a period of the highest mode, of all


@dataclass(frozen=True)
class RestingRobot:
    """A study's robot at rest at an instant of its path, drives locked; computed once."""

    study: model.Study
    elastic: ElasticRobot
    time: float

    @cached_property
    def rigid(self) -> kinematics.RigidPoses:
        """The rigid robot there."""
        return RigidPath(self.study, np.array([self.time])).resting()

    @cached_property
    def locked_robot(self) -> LockedPoses:
        """Equilibrium; raises as `ElasticRobot.lock`."""
        return self.elastic.lock(self.rigid, self.time)

    @cached_property
    def modes(self) -> RobotModes:
        """Modes about it; raises as `single_pose_modes`."""
        return single_pose_modes(self.locked_robot)


@dataclass(frozen=True, kw_only=True)
class ExpectedVibration:
    """Residual vibration of the tool after the motion (T8.14)-(T8.18).

    `amplitude` [m]: all modes in phase; `frequency` [Hz] and `share` of the largest; `settling` [s] until the sum is
    below `band` [m], inf without damping; `left_out` [Hz]: the lowest mode that is not in it, because the motion is too
    long to be sampled for it; None where none is.
    """

    amplitude: float
    frequency: float
    share: float
    settling: float
    band: float
    left_out: float | None


def expected_vibration(rest: RestingRobot, band: float = BAND) -> ExpectedVibration | None:
    """Residual vibration after the motion, which ends at `rest`, down to a band [m]; None where it cannot vibrate."""
    study, end = rest.study, rest.time
    robot = study.robot
    if robot.platform_fixed:
        return None
    try:
        modes = rest.modes
    except FlexapodError:
        return None
    if modes.growth:
        return None
    wanted = modes.frequency[(modes.frequency > 0) & (modes.frequency <= HIGHEST) & (modes.damping_ratio < 1)]
    count = int(np.clip(np.ceil(PER_PERIOD * wanted.max(initial=0.0) * end), FEWEST, MOST))
    t = np.linspace(0.0, end, count + 1)
    path = kinematics.poses(robot, study.motion, t)
    found = residual_vibration(robot, modes, t, path, band, from_rest=study.initial.start != "moving")
    if not found.frequency.size:
        return None
    largest = first_largest(found.amplitude, EQUALS)
    return ExpectedVibration(
        amplitude=found.total,
        frequency=float(found.frequency[largest]),
        share=float(found.amplitude[largest] / found.total) if found.total > 0 else 0.0,
        settling=found.time_to_band(),
        band=band,
        left_out=min(set(wanted.tolist()) - set(found.frequency.tolist()), default=None),
    )
