"""Loads on a robot at rest: forces of its drives, where they act, and the wrench at the tool, Eq. (T7.20).

Forces that drives are given follow Eqs. (T15.13), (T23.13), (T23.55).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array, Index
from flexapod.kinematics.leg_geometry import COORDINATES, DRIVEN, HELD
from flexapod.model import Drive, ForceDrive, Load, Robot, ScrewDrive
from flexapod.solve.rigid_motion import leg_coordinates
from flexapod.solve.statics.ideal_robot import rigid_forces
from flexapod.solve.system import System


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


def feed_forward(at: kinematics.RigidPoses, t: Array, wrench: Array) -> Array:
    """Feed-forward forces of drives on the rigid path at instants (T,), (T, legs) [N]; zero for those that have none.

    A torque of a screw is what the rigid robot and the rotor need, Eq. (T15.13), or the motor's by its law,
    Eq. (T23.13).
    """
    drives = [leg.drive for leg in at.robot.legs]
    force = np.zeros((len(t), len(drives)))
    rigid_force = force
    replay = [is_turned(d) and getattr(d, "law", "") == "rigid" for d in drives]
    if any((isinstance(d, ForceDrive) and d.law == "rigid") for d in drives) or any(replay):
        rigid_force = rigid_forces(at, wrench).drive_force
    change = at.legs.accel if any(replay) else force
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
    """Test whether a drive is a torque on a screw."""
    return isinstance(drive, ScrewDrive) and drive.command == "torque"


BEFORE = -1e-12  # just before an instant [s]: a load that steps there has not come yet


@dataclass(frozen=True, kw_only=True)
class RestLoad:
    """Load at P poses: ``force`` (P, legs, ports) of force drives without feedback; ``wrench`` (6,), tool, world."""

    force: Array
    wrench: Array


def rest_commands(system: System, robot: Robot, q: Array, time: float = 0.0) -> Array:
    """Values (P, legs, ports) that hold a robot at configurations q (P, legs, n): of joints those at home.

    To them comes what the robot as built adds at a `time` [s], Eq. (T16.5).
    """
    command, found = q[..., system.ports].copy(), kinematics.robot_limbs(robot)
    for k, port in _ports(system):
        fixed = found.state[:, k] == HELD
        command[:, fixed, port] = found.home[fixed, k]
    if kinematics.built_parts(robot):
        whole = np.zeros((*q.shape[:2], len(COORDINATES)))
        there, at = leg_coordinates(system.kernel.shapes)
        whole[..., there] = q[..., at]
        still = np.zeros_like(whole)
        more = kinematics.added_by_all(robot, np.full(len(q), time), kinematics.Law(whole, still, still)).position
        for k, port in _ports(system):
            command[..., port] += more[..., k]
        for i, port in enumerate(push_ports(system, robot)):  # a rotor's travel follows the length
            if robot.legs[i].gives:
                command[:, i, system.ports == port] += more[:, i, COORDINATES.index("l"), None]
    return command


def drive_values(system: System, robot: Robot, values: Array) -> Array:
    """Values (..., legs) of the driven ports out of those of all, (..., legs, ports); 0 of a passive leg."""
    found = np.zeros(values.shape[:-1])
    state = kinematics.robot_limbs(robot).state
    for k, port in _ports(system):
        driven = state[:, k] == DRIVEN
        found[..., driven] = values[..., driven, port]
    return found


def _ports(system: System) -> Iterator[tuple[int, int]]:
    """Pairs of index and port of those `leg_geometry.COORDINATES` that are ports."""
    for k, at in zip(*leg_coordinates(system.kernel.shapes), strict=True):
        yield from ((k, int(port)) for port in np.flatnonzero(system.ports == at))


def rest_load(system: System, at: kinematics.RigidPoses, load: Load | None = None, time: float = 0.0) -> RestLoad:
    """Loads on a robot that rests at poses just before an instant.

    Every static quantity takes it from here. A force drive of law "rigid" pushes with what the rigid robot needs at the
    pose, at rest, under gravity and wrench (T7.20); one with a table with its value at the instant, whatever the pose;
    other drives with nothing but their springs and constraints. Just before: a load that steps at the instant has not
    come yet, as at the start of a simulation from its equilibrium.

    Parameters
    ----------
    system : System
    at : RigidPoses
        P rigid poses; their rates do not matter.
    load : Load, optional
        None: no wrench.
    time : float
        Of the wrench's law and of the drives' tables [s].
    """
    before = np.array([min(time + BEFORE, np.nextafter(time, -np.inf))])
    wrench = kinematics.wrench(Load() if load is None else load, before)
    robot, count = at.robot, len(at.poses)
    pushed = feed_forward(at.resting(), np.repeat(before, count), np.repeat(wrench, count, axis=0))
    force = np.zeros((count, system.legs, system.ports.size))
    for i, port in enumerate(force_ports(system, robot)):
        force[:, i, system.ports == port] = pushed[:, i, None]
    return RestLoad(force=force, wrench=wrench[0])
