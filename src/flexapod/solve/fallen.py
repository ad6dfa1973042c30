"""Equilibria on the other side of a singularity than the rigid pose: another assembly, which the drives do not mean."""

from __future__ import annotations

import numpy as np

from flexapod import rigid
from flexapod.errors import ComputationError
from flexapod.model import Robot
from flexapod.rigid.limbs import DRIVEN, HELD
from flexapod.rigid.rotations import matrix
from flexapod.solve.elimination import leg_bases
from flexapod.solve.many import RestStates, matrices_at_rest
from flexapod.solve.rigid_motion import leg_coordinates
from flexapod.solve.system import System
from flexapod.typing import Array, Mask

__all__ = ["FALLS_THROUGH", "fallen", "platform_poses", "refuse_fallen"]

FALLS_THROUGH = "no equilibrium: the robot sags through a singularity"


def platform_poses(robot: Robot, pose: Array) -> rigid.Poses:
    """Poses of the platform in states (P, 7) of centre of mass and quaternion."""
    R = matrix(pose[:, 3:])
    return rigid.Poses.at_rest(pose[:, :3] - R @ robot.com, R)


def fallen(system: System, robot: Robot, start: RestStates, states: RestStates) -> Mask:
    """Which of P equilibria lie on the other side of a singularity than their undeformed states ``start``, (P,)."""
    if not len(start):
        return np.zeros(0, dtype=bool)
    if rigid.rigid_limbs(robot).plain and system.legs == system.hub_free.size == 6:
        before, after = (rigid.singularity(robot, platform_poses(robot, x.pose)).determinant for x in (start, states))
    else:
        before, after = (_determinant(system, robot, x) for x in (start, states))
    return np.sign(before) != np.sign(after)


def _determinant(system: System, robot: Robot, x: RestStates) -> Array:
    """Of the rates of what the rigid robot holds by steps of the payload, (P,); 1 where it is held in excess."""
    there, at = leg_coordinates(system.kernel.shapes)
    holds = np.zeros_like(system.held)
    holds[:, at] = np.isin(rigid.rigid_limbs(robot).state[:, there], (HELD, DRIVEN))
    rows = []
    for b in leg_bases(system, matrices_at_rest(system, x, np.zeros(6))):
        for i, leg in enumerate(b.legs):
            rows.append(b.Y[:, i, b.pivot[holds[leg, b.pivot]]])
    found = np.concatenate(rows, axis=1)
    return np.linalg.det(found) if found.shape[1] == found.shape[2] else np.ones(len(x))


def refuse_fallen(system: System, robot: Robot, start: RestStates, states: RestStates) -> None:
    """Raise ComputationError where the equilibrium of one state is `fallen`."""
    if fallen(system, robot, start, states).any():
        raise ComputationError(FALLS_THROUGH, next_step="Choose a pose farther from the singularity.")
