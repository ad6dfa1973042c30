"""What acts on a robot at rest: forces of its drives and the wrench at the tool, Eq. (T7.20)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array
from flexapod.kinematics.leg_geometry import COORDINATES, DRIVEN, HELD
from flexapod.model import Load, Robot
from flexapod.solve.rigid_motion import leg_coordinates
from flexapod.solve.statics.drive_forces import feed_forward, force_ports, push_ports
from flexapod.solve.system import System

__all__ = ["RestLoad", "at_drives", "rest_commands", "rest_load"]

BEFORE = -1e-12  # just before an instant [s]: a load that steps there has not come yet


@dataclass(frozen=True, kw_only=True)
class RestLoad:
    """Of P poses: ``force`` (P, legs, ports) of force drives without their feedback; ``wrench`` (6,), tool, world."""

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


def at_drives(system: System, robot: Robot, values: Array) -> Array:
    """Values (..., legs) of the driven ports out of those of all, (..., legs, ports); 0 of a passive leg."""
    found = np.zeros(values.shape[:-1])
    state = kinematics.robot_limbs(robot).state
    for k, port in _ports(system):
        driven = state[:, k] == DRIVEN
        found[..., driven] = values[..., driven, port]
    return found


def _ports(system: System) -> Iterator[tuple[int, int]]:
    """Which of `kinematics.limbs.COORDINATES` are ports, and which ones."""
    for k, at in zip(*leg_coordinates(system.kernel.shapes), strict=True):
        yield from ((k, int(port)) for port in np.flatnonzero(system.ports == at))


def rest_load(
    system: System, robot: Robot, path: kinematics.Poses, load: Load | None = None, time: float = 0.0
) -> RestLoad:
    """What acts on a robot that rests at poses just before an instant.

    Every static quantity takes it from here. A force drive of law "rigid" pushes with what the rigid robot needs at the
    pose, at rest, under gravity and wrench (T7.20); one with a table with its value at the instant, whatever the pose;
    other drives with nothing but their springs and constraints. Just before: a load that steps at the instant has not
    come yet, as at the start of a simulation from its equilibrium.

    Parameters
    ----------
    system : System
    robot : Robot
    path : Poses
        P rigid poses; their rates do not matter.
    load : Load, optional
        None: no wrench.
    time : float
        Of the wrench's law and of the drives' tables [s].
    """
    before = np.array([min(time + BEFORE, np.nextafter(time, -np.inf))])
    wrench = kinematics.wrench(Load() if load is None else load, before)
    still, count = kinematics.Poses.at_rest(path.position, path.rotation), len(path)
    pushed = feed_forward(robot, np.repeat(before, count), still, np.repeat(wrench, count, axis=0))
    force = np.zeros((count, system.legs, system.ports.size))
    for i, at in enumerate(force_ports(system, robot)):
        force[:, i, system.ports == at] = pushed[:, i, None]
    return RestLoad(force=force, wrench=wrench[0])
