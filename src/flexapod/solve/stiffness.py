"""Stiffness at the tool and the legs' shares in it, Eqs. (T7.6)-(T7.8)."""

from dataclasses import dataclass

import numpy as np

from flexapod import rigid
from flexapod.bases.eigen import finite
from flexapod.errors import InputError
from flexapod.model import Load, Robot, Simulation
from flexapod.rigid.rotations import matrix
from flexapod.solve.elimination import leg_bases, solve_each
from flexapod.solve.equilibrium import Equilibrium
from flexapod.solve.modes import LockedPoses, locked_poses, the_equilibrium
from flexapod.solve.system import System
from flexapod.typing import Array


@dataclass(frozen=True, kw_only=True)
class Stiffness:
    """Stiffness at the tool in world axes, [N/m, N, N m/rad], at one pose or, with a first axis more, at several.

    ``total`` (6, 6) is the sum of ``legs`` (6, 6, 6), the share of each leg, and ``load`` (6, 6), what turning
    the joint forces adds.
    """

    total: Array
    legs: Array
    load: Array


@dataclass(frozen=True, kw_only=True)
class PoseStiffness(Stiffness):
    """Stiffness at one pose, and the equilibrium that it is about."""

    equilibrium: Equilibrium
    system: System


def robot_stiffness(
    robot: Robot, simulation: Simulation, path: rigid.Poses | None = None, load: Load | None = None
) -> PoseStiffness:
    """Stiffness against a wrench at the tool, drives locked, about the static equilibrium at a pose (default: home).

    Loads as of `modes.locked_poses`.

    Raises
    ------
    InputError
        Rigid legs on prescribed strokes (no compliance), or a pure force drive.
    ComputationError
        No equilibrium at this pose.
    """
    locked = locked_poses(robot, simulation, rigid.home_pose(robot) if path is None else path, load)
    rest, found = the_equilibrium(locked), stiffness_of(robot, locked)
    return PoseStiffness(
        total=found.total[0], legs=found.legs[0], load=found.load[0], equilibrium=rest, system=locked.system
    )


def stiffness_of(robot: Robot, locked: LockedPoses) -> Stiffness:
    """Stiffness at every equilibrium that was found.

    Raises
    ------
    InputError
        Legs on prescribed strokes that cannot stretch: no compliance.
    """
    system, m = locked.system, locked.m
    if system.kernel.shapes.axial.count == 0 and system.held[:, system.kernel.shapes.l_index].any():
        raise InputError(
            "makes the robot infinitely stiff",
            key="simulation.fidelity",
            value=locked.simulation.fidelity,
            allowed='"lumped", or a bending fidelity with at least one axial shape',
        )
    legs = np.zeros((len(locked.at), 6, 6, 6))
    for b in leg_bases(system, m):  # (T7.6)  joint forces that a unit step of the payload meets, legs eliminated
        K, Nt, Yt = m.K[:, b.legs], b.N.swapaxes(-1, -2), b.Y.swapaxes(-1, -2)
        C = Nt @ K @ b.Y
        legs[:, b.legs] = Yt @ K @ b.Y - C.swapaxes(-1, -2) @ solve_each(Nt @ K @ b.N, C)
    back = np.linalg.inv(tool_motion(robot, locked.equilibria.states[locked.at].pose))[:, None]
    parts = np.concatenate([legs, m.payload_K[:, None]], axis=1)
    at_tool = back.swapaxes(-1, -2) @ parts @ back  # (T7.8)
    return Stiffness(total=at_tool.sum(axis=1), legs=at_tool[:, :6], load=at_tool[:, 6])


def compliance(total: Array) -> Array:
    """Inverses of stiffness matrices (p, 6, 6), symmetric.

    Raises
    ------
    ComputationError
        A matrix is singular, or a number in it is not finite.
    """
    found = solve_each(total, np.broadcast_to(np.eye(6), total.shape))
    finite(total, found)
    return 0.5 * (found + found.swapaxes(-1, -2))


def tool_motion(robot: Robot, pose: Array) -> Array:
    """Tool displacement and rotation (world) per payload step (dx, theta), (P, 6, 6), at poses (P, 7), Eq. (T7.7)."""
    R, r = matrix(pose[:, 3:]), robot.payload.tool - robot.payload.com
    cross = np.array([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]])
    motion = np.zeros((len(pose), 6, 6))
    motion[:, :3, :3], motion[:, :3, 3:], motion[:, 3:, 3:] = np.eye(3), -R @ cross, R
    return motion
