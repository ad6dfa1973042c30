"""What the robot is commanded at given instants: strokes with rate and acceleration, feed-forward forces, wrench."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from flexapod import rigid
from flexapod.model import ForceDrive, Load, Robot
from flexapod.typing import Array


@dataclass(frozen=True, kw_only=True)
class Commands:
    """Commands at T instants: ``length``, ``rate``, ``accel``, ``force``, ``wrench``, all (T, 6)."""

    time: Array
    length: Array
    rate: Array
    accel: Array
    force: Array
    wrench: Array
    law: Callable[[Array], "Commands"]

    def at(self, dt: float) -> "Commands":
        """Commands at the first instant plus ``dt``."""
        return self.law(self.time[:1] + dt)


def command_law(robot: Robot, load: Load, poses: Callable[[Array], rigid.Poses]) -> Callable[[Array], Commands]:
    """Return the commands as a function of instants (T,) [s]; ``poses`` is the rigid path."""

    def law(t: Array) -> Commands:
        path = poses(t)
        legs = rigid.inverse_kinematics(robot, path)
        wrench = rigid.wrench(load, t)
        return Commands(
            time=t,
            length=legs.length,
            rate=legs.rate,
            accel=legs.accel,
            force=feed_forward(robot, t, path, wrench),
            wrench=wrench,
            law=law,
        )

    return law


def feed_forward(robot: Robot, t: Array, path: rigid.Poses, wrench: Array) -> Array:
    """Feed-forward forces of force drives on the rigid path at instants (T,), (T, 6) [N]; zero for other drives."""
    force = np.zeros((len(t), 6))
    drives = [leg.drive for leg in robot.legs]
    rigid_force = force
    if any(isinstance(d, ForceDrive) and d.law == "rigid" for d in drives):
        rigid_force = rigid.inverse_dynamics(robot, path, wrench).actuator_force
    for i, drive in enumerate(drives):
        if not isinstance(drive, ForceDrive):
            continue
        if drive.time is None or drive.force is None:  # law "rigid"
            force[:, i] = rigid_force[:, i]
        else:
            force[:, i] = np.interp(t, drive.time, drive.force)
    return force
