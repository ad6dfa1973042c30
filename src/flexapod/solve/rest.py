"""What acts on a robot at rest: forces of its drives and the wrench at the tool, Eq. (T7.20)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod import rigid
from flexapod.model import Load, Robot
from flexapod.solve.tables import feed_forward
from flexapod.typing import Array

__all__ = ["RestLoad", "rest_load"]

BEFORE = -1e-12  # just before an instant [s]: a load that steps there has not come yet


@dataclass(frozen=True, kw_only=True)
class RestLoad:
    """Of P poses: ``force`` (P, 6) of each force drive without its feedback [N]; ``wrench`` (6,), tool, world axes."""

    force: Array
    wrench: Array


def rest_load(robot: Robot, path: rigid.Poses, load: Load | None = None, time: float = 0.0) -> RestLoad:
    """What acts on a robot that rests at poses just before an instant.

    Every static quantity takes it from here. A force drive of law "rigid" pushes with what the rigid robot needs at the
    pose, at rest, under gravity and wrench (T7.20); one with a table with its value at the instant, whatever the pose;
    other drives with nothing but their springs and constraints. Just before: a load that steps at the instant has not
    come yet, as at the start of a simulation from its equilibrium.

    Parameters
    ----------
    robot : Robot
    path : Poses
        P rigid poses; their rates do not matter.
    load : Load, optional
        None: no wrench.
    time : float
        Of the wrench's law and of the drives' tables [s].
    """
    before = np.array([min(time + BEFORE, np.nextafter(time, -np.inf))])
    wrench = rigid.wrench(Load() if load is None else load, before)
    still, count = rigid.Poses.at_rest(path.position, path.rotation), len(path)
    force = feed_forward(robot, np.repeat(before, count), still, np.repeat(wrench, count, axis=0))
    return RestLoad(force=force, wrench=wrench[0])
