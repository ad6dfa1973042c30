"""What the robot is commanded at given instants: strokes with rate and acceleration, feed-forward forces, wrench."""

from collections.abc import Callable

import numpy as np

from flexapod import rigid
from flexapod.model import ForceDrive, Load, Robot
from flexapod.rigid.limbs import COORDINATES, DRIVEN
from flexapod.solve.pieces import Groups, Pieces
from flexapod.solve.released import rigid_forces
from flexapod.solve.system import COLUMNS, System
from flexapod.typing import Array

__all__ = ["Law", "feed_forward", "robot_law"]

#: Of instants (T,): the table of the ports (T, legs, ports, 4), and the load (T, load_size), of a payload the wrench
#: at the tool in world axes.
Law = Callable[[Array], tuple[Array, Array]]


def robot_law(
    system: System, robot: Robot, load: Load, poses: Callable[[Array], rigid.Poses], knots: Array | None = None
) -> Law:
    """Return what a robot is commanded as a function of time; ``poses`` is the rigid path.

    Driven coordinates follow the path; what else is held stays where it is at home, of a flexure at zero. With the
    ``knots`` (n,) between which the path is smooth, legs without a closed form are computed at few instants: `pieces`.
    """
    chains, shapes = rigid.robot_limbs(robot), system.kernel.shapes
    names = {shapes.index(name): name for name in COORDINATES if shapes.has(name)}
    driven, home = np.zeros((2, system.legs, system.ports.size))
    for k, port in enumerate(system.ports):
        if port in names:
            place = COORDINATES.index(names[port])
            driven[:, k], home[:, k] = chains.state[:, place] == DRIVEN, chains.home[:, place]
    driven = driven.astype(bool)

    def commanded(t: Array) -> list[Array]:
        legs = rigid.inverse_kinematics(robot, poses(t))
        parts = np.zeros((3, len(t), system.legs, system.ports.size))
        parts[0] = home
        for k in np.flatnonzero(driven.any(axis=0)):
            which = slice(None) if driven[:, k].all() else driven[:, k]
            for part, values in zip(parts, legs.coordinate(names[system.ports[k]]), strict=True):
                part[:, which, k] = values[:, which]
        return list(parts)

    forces = any(isinstance(leg.drive, ForceDrive) for leg in robot.legs)
    coordinates: Groups = commanded
    if knots is not None and not (rigid.rigid_limbs(robot).plain or forces):
        coordinates = Pieces(commanded, knots)

    def law(t: Array) -> tuple[Array, Array]:
        wrench = rigid.wrench(load, t)
        table = np.zeros((len(t), system.legs, system.ports.size, COLUMNS))
        for column, part in enumerate(coordinates(t)):
            table[..., column] = part
        if forces:
            table[:, driven, 3] = feed_forward(robot, t, poses(t), wrench)[:, driven.any(axis=1)]
        return table, wrench

    return law


def feed_forward(robot: Robot, t: Array, path: rigid.Poses, wrench: Array) -> Array:
    """Feed-forward forces of force drives on the rigid path at instants (T,), (T, legs) [N]; zero for other drives."""
    drives = [leg.drive for leg in robot.legs]
    force = np.zeros((len(t), len(drives)))
    rigid_force = force
    if any(isinstance(d, ForceDrive) and d.law == "rigid" for d in drives):
        rigid_force = rigid_forces(robot, path, wrench).drive_force
    for i, drive in enumerate(drives):
        if not isinstance(drive, ForceDrive):
            continue
        if drive.value is not None:
            force[:, i] = drive.value
        elif drive.time is None or drive.force is None:  # law "rigid"
            force[:, i] = rigid_force[:, i]
        else:
            force[:, i] = np.interp(t, drive.time, drive.force)
    return force
