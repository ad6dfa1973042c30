"""Detection of another assembly than the drives mean: beyond a singularity, or a platform joint half a turn off."""

from __future__ import annotations

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import ComputationError
from flexapod.kinematics.closures import false_roots
from flexapod.kinematics.rotations import matrix
from flexapod.kinematics.screws import screws
from flexapod.model import Robot
from flexapod.solve.batch import RestStates, matrices_at_rest
from flexapod.solve.frames import plate_frames
from flexapod.solve.rigid_motion import leg_coordinates
from flexapod.solve.statics.elimination import leg_bases
from flexapod.solve.system import System

FALLS_THROUGH = "no equilibrium: the robot sags through a singularity"


def platform_poses(robot: Robot, pose: Array) -> kinematics.Poses:
    """Poses of the platform in states (P, 7) of centre of mass and quaternion."""
    R = matrix(pose[:, 3:])
    return kinematics.Poses.at_rest(pose[:, :3] - R @ robot.com, R)


def assembly_changes(system: System, robot: Robot, start: RestStates, states: RestStates) -> Mask:
    """Mask of the P equilibria that are another assembly than their undeformed states ``start``, (P,)."""
    if not len(start):
        return np.zeros(0, dtype=bool)
    if kinematics.rigid_limbs(robot).plain and system.legs == system.hub_free.size == 6:
        both = platform_poses(robot, np.concatenate([start.pose, states.pose]))
        before, after = np.split(kinematics.determinants(robot, both), 2)
    else:
        before, after = (_determinant(system, robot, x) for x in (start, states))
    return (np.sign(before) != np.sign(after)) | false_root_legs(system, robot, states.q, states.pose).any(axis=1)


def false_root_legs(system: System, robot: Robot, q: Array, pose: Array) -> Mask:
    """Legs (P, legs) at the false root of (T13.12), in states of coordinates (P, legs, n) and payload poses (P, 7)."""
    legs = kinematics.robot_limbs(robot)
    if system.rows < 6:
        return np.zeros((len(q), len(legs)), dtype=bool)
    there, at = leg_coordinates(system.kernel.shapes)
    of_leg = np.tile(legs.home, (len(q), 1, 1))
    of_leg[..., there] = q[..., at]
    return false_roots(legs, screws(legs, of_leg), plate_frames(system, robot, q, pose)[-1][2])


def _determinant(system: System, robot: Robot, x: RestStates) -> Array:
    """Determinant of what the rigid robot holds by steps of the payload, (P,); 1 if overconstrained."""
    there, at = leg_coordinates(system.kernel.shapes)
    holds = np.zeros_like(system.held)
    holds[:, at] = kinematics.rigid_limbs(robot).given[:, there]
    rows = []
    for b in leg_bases(system, matrices_at_rest(system, x, np.zeros(6))):
        for i, leg in enumerate(b.legs):
            rows.append(b.Y[:, i, b.pivot[holds[leg, b.pivot]], : system.hub_free.size])
    found = np.concatenate(rows, axis=1)
    return np.linalg.det(found) if found.shape[1] == found.shape[2] else np.ones(len(x))


def refuse_false_root(system: System, robot: Robot, x: RestStates) -> None:
    """Raise ComputationError where a leg of one state is `false_root_legs`."""
    turned = np.argwhere(false_root_legs(system, robot, x.q, x.pose))
    if len(turned):
        raise ComputationError(
            f"leg {turned[0, 1] + 1} meets the platform half a turn off: legs and platform do not fit so",
            next_step="Check the axes of the leg's joints, or reduce the load.",
        )


def refuse_assembly_change(system: System, robot: Robot, start: RestStates, states: RestStates) -> None:
    """Raise ComputationError where the equilibrium of one state is `assembly_changes`."""
    refuse_false_root(system, robot, states)
    if assembly_changes(system, robot, start, states).any():
        raise ComputationError(FALLS_THROUGH, next_step="Choose a pose farther from the singularity.")
