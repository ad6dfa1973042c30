"""Poses of base and platform plate in a state of the robot, Eqs. (T24.1), (T24.5)."""

from __future__ import annotations

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array
from flexapod.kinematics.rotations import matrix
from flexapod.mechanics.leg.layout import FRAMES
from flexapod.model import Robot
from flexapod.solve.system import System


def shared_by_legs(system: System, q: Array, name: str) -> Array:
    """Displacement and angles (..., 6) of a frame, "g", "f" or "m", in coordinates (..., legs, n); zeros without it."""
    if not system.kernel.shapes.has(name):
        return np.zeros((*q.shape[:-2], 6))
    first = system.kernel.shapes.index(name)
    return q[..., 0, first : first + 6]


def floor(system: System, robot: Robot, q: Array) -> kinematics.Placed:
    """Pose of a base that is moved, without its mount."""
    at = np.zeros(3) if robot.base_motion is None else robot.base_motion.at
    return kinematics.placed(shared_by_legs(system, q, "g"), at)


def base_on_mount(system: System, robot: Robot, q: Array) -> kinematics.Placed:
    """Pose of the base plate on its mount, relative to the floor."""
    at = np.zeros(3) if robot.base_mount is None else robot.base_mount.at
    return kinematics.placed(shared_by_legs(system, q, "f"), at)


def platform_frame(robot: Robot, pose: Array, turn: Array | None = None) -> tuple[Array, Array]:
    """Origin (..., 3) and axes (..., 3, 3) of the platform frame of poses (..., 7), of attitudes `turn` if known."""
    R = matrix(pose[..., 3:]) if turn is None else turn
    return pose[..., :3] - R @ robot.com, R


def plate_frames(
    system: System, robot: Robot, q: Array, pose: Array, turn: Array | None = None
) -> list[tuple[str, Array, Array]]:
    """Platform frame, origin (..., 3) and axes (..., 3, 3), as ever more of the moving frames are taken away.

    By cause: seen from the floor, where it is below the mount of the platform, as seen from the base plate. `turn`:
    attitudes (..., 3, 3) of the payload, where they are known.
    """
    place, R = platform_frame(robot, pose, turn)
    if system.kernel.shapes.has("g"):
        place, R = floor(system, robot, q).seen(place, R)
    found = [("", place, R)]
    if robot.platform_mount is not None:
        below = kinematics.placed(shared_by_legs(system, q, "m"), robot.platform_mount.at)
        place, R = kinematics.Placed(place, R).carried(*below)
        found.append(("platform_mount", place, R))
    if robot.base_mount is not None:
        place, R = base_on_mount(system, robot, q).seen(place, R)
        found.append(("base_mount", place, R))
    return found


def rigid_pose(system: System, robot: Robot, q: Array, pose: Array, turn: Array | None = None) -> tuple[Array, Array]:
    """Centre of mass (..., 3) and attitude (..., 3, 3) of a payload on rigid frames at rest between the same joints."""
    turn = matrix(pose[..., 3:]) if turn is None else turn
    if not _moves(system):
        return pose[..., :3], turn
    _, place, R = plate_frames(system, robot, q, pose, turn)[-1]
    return place + R @ robot.com, R


def to_world(system: System, robot: Robot, q: Array, vectors: Array) -> Array:
    """Vectors (..., legs, 3) of the base plate in world axes."""
    if not _moves(system):
        return vectors
    turn = floor(system, robot, q).rotation @ base_on_mount(system, robot, q).rotation
    return np.asarray(vectors @ turn.swapaxes(-1, -2), dtype=np.float64)


def _moves(system: System) -> bool:
    shapes = system.kernel.shapes
    return any(shapes.has(name) for name in FRAMES)
