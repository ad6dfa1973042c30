"""Stiffness at the tool and the legs' shares in it, Eqs. (T7.6)-(T7.8)."""

from dataclasses import dataclass

import numpy as np

from flexapod import rigid
from flexapod.errors import InputError
from flexapod.model import Robot, Simulation
from flexapod.solve.equilibrium import saddle_solve
from flexapod.solve.modes import locked_equilibrium
from flexapod.solve.rotation import matrix
from flexapod.typing import Array


@dataclass(frozen=True, kw_only=True)
class Stiffness:
    """Stiffness at the tool in world axes, [N/m, N, N m/rad].

    ``total`` (6, 6) is the sum of ``legs`` (6, 6, 6), the share of each leg, and ``load`` (6, 6), what turning
    the joint forces adds.
    """

    total: Array
    legs: Array
    load: Array


def robot_stiffness(
    robot: Robot, simulation: Simulation, path: rigid.Poses | None = None, wrench: Array | None = None
) -> Stiffness:
    """Stiffness against a wrench at the tool, drives locked, about the static equilibrium at a pose (default: home).

    Raises
    ------
    InputError
        Rigid legs on prescribed strokes (no compliance), or a pure force drive.
    ComputationError
        No equilibrium at this pose.
    """
    path = rigid.home_pose(robot) if path is None else path
    system, found = locked_equilibrium(robot, simulation, path, wrench)
    if system.kernel.shapes.axial.count == 0 and system.held.any():
        raise InputError(
            "makes the robot infinitely stiff",
            key="simulation.fidelity",
            value=simulation.fidelity,
            allowed='"lumped", or a bending fidelity with at least one axial shape',
        )
    m, n, k = system.matrices(found.state, np.zeros(6) if wrench is None else wrench), system.n, 6 * system.n
    P = -m.G[:18, k:]
    legs = np.zeros((6, 6, 6))
    strokes = np.flatnonzero(system.held)
    for i in range(6):
        at, rows = slice(i * n, (i + 1) * n), slice(3 * i, 3 * i + 3)
        held = 18 + np.flatnonzero(strokes == i)
        G = np.vstack([m.G[rows, at], m.G[held, at]])
        for j in range(6):  # (T7.6)  joint forces that a unit step of the payload meets
            given = np.concatenate([P[rows, j], np.zeros(len(held))])
            _, multipliers = saddle_solve(m.K[at, at], G, np.zeros(n), given)
            legs[i, :, j] = -P[rows].T @ multipliers[:3]
    tool = _tool_motion(robot, found.state.pose)
    back = np.linalg.inv(tool)
    at_tool = np.array([back.T @ part @ back for part in (*legs, m.K[k:, k:])])  # (T7.8)
    return Stiffness(total=at_tool.sum(axis=0), legs=at_tool[:6], load=at_tool[6])


def _tool_motion(robot: Robot, pose: Array) -> Array:
    """Tool displacement and rotation (world) per payload step (dx, theta), Eq. (T7.7)."""
    R, r = matrix(pose[3:]), robot.payload.tool - robot.payload.com
    cross = np.array([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]])
    return np.block([[np.eye(3), -R @ cross], [np.zeros((3, 3)), R]])
