"""Where the drives of a robot act, and the forces that they are given, Eqs. (T15.13), (T23.13), (T23.55)."""

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array
from flexapod.kinematics.leg_geometry import COORDINATES, DRIVEN
from flexapod.model import Drive, ForceDrive, Robot, ScrewDrive
from flexapod.solve.statics.ideal_robot import rigid_forces
from flexapod.solve.system import Index, System

__all__ = ["feed_forward", "force_ports", "is_turned", "push_ports"]


def push_ports(system: System, robot: Robot) -> Index:
    """Coordinate on which the drive of each leg acts, (legs,): its rotor, where it has one; -1 of passive legs."""
    state, shapes = kinematics.robot_limbs(robot).state, system.kernel.shapes
    found = np.full(system.legs, -1)
    for name in ("l", "chi"):
        if shapes.has(name):
            found[state[:, COORDINATES.index(name)] == DRIVEN] = shapes.index(name)
    if shapes.has("r"):
        found[[leg.gives for leg in robot.legs]] = shapes.index("r")
    return found


def force_ports(system: System, robot: Robot) -> Index:
    """Coordinates on which given forces of the drives act, (legs,): where motors lag, what they ask for.

    At rest, about a loop that is closed elsewhere than at the rotor, the stroke, Eq. (T23.55).
    """
    found, shapes = push_ports(system, robot), system.kernel.shapes
    if shapes.has("j"):
        r, j = (system.held[:, shapes.index(name)] for name in ("r", "j"))
        found[~j] = shapes.index("j")
        found[[bool(leg.closed_about) and bool(still) for leg, still in zip(robot.legs, r, strict=True)]] = (
            shapes.l_index
        )
    return found


def feed_forward(robot: Robot, t: Array, path: kinematics.Poses, wrench: Array) -> Array:
    """Feed-forward forces of drives on the rigid path at instants (T,), (T, legs) [N]; zero for those that have none.

    A torque of a screw is what the rigid robot and the rotor need, Eq. (T15.13), or the motor's by its law,
    Eq. (T23.13).
    """
    drives = [leg.drive for leg in robot.legs]
    force = np.zeros((len(t), len(drives)))
    rigid_force = force
    replay = [is_turned(d) and getattr(d, "law", "") == "rigid" for d in drives]
    if any((isinstance(d, ForceDrive) and d.law == "rigid") for d in drives) or any(replay):
        rigid_force = rigid_forces(robot, path, wrench).drive_force
    change = kinematics.inverse_kinematics(robot, path).accel if any(replay) else force
    for i, drive in enumerate(drives):
        if isinstance(drive, ScrewDrive) and is_turned(drive):
            force[:, i] = rigid_force[:, i] + drive.inertia / drive.per_turn**2 * change[:, i]
            given = (
                drive.value if drive.time is None or drive.torque is None else np.interp(t, drive.time, drive.torque)
            )
            if given is not None:
                force[:, i] = given * drive.rotor.ratio / drive.per_turn
        if not isinstance(drive, ForceDrive):
            continue
        if drive.value is not None:
            force[:, i] = drive.value
        elif drive.time is None or drive.force is None:  # law "rigid"
            force[:, i] = rigid_force[:, i]
        else:
            force[:, i] = np.interp(t, drive.time, drive.force)
    return force


def is_turned(drive: Drive) -> bool:
    """Whether a drive is a torque on a screw."""
    return isinstance(drive, ScrewDrive) and drive.command == "torque"
