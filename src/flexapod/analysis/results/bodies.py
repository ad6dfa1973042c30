"""Legs as bodies: the angles of their joints and the room between them, along a path and in results."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from flexapod import kinematics
from flexapod.analysis.results.lazy_arrays import ArraySource
from flexapod.analysis.results.legs import base_points
from flexapod.common.arrays import Array
from flexapod.kinematics.robot import cache_per_robot, rigid_limbs
from flexapod.model import Robot
from flexapod.solve.frames import rigid_pose, to_world
from flexapod.solve.result_rows import DrawnLegs

if TYPE_CHECKING:
    from flexapod.analysis.results.time_history import Record
    from flexapod.solve.batch import RestStates
    from flexapod.solve.kernel import Kernel
    from flexapod.solve.system import System

Pairs = list[tuple[int, int]]
CYLINDER = 1.6  # radius of a cylinder over that of its piston, where it is not known


def joint_angle_limits(robot: Robot) -> Array:
    """Largest angles that base and platform joint of the legs allow, (n, 2) [rad]; inf without a limit."""
    ends = ((leg.base_joint.max_angle, leg.platform_joint.max_angle) for leg in robot.legs)
    return np.array([[np.inf if angle is None else angle for angle in pair] for pair in ends])


def joint_angles(robot: Robot, axes: Array, rotation: Array) -> Array:
    """Turns since home of legs along `axes` (T, n, 3), platform `rotation` (T, 3, 3): (T, n, 2) [rad]."""
    return kinematics.turned_by(axes, rotation, robot.home_vectors / robot.home_lengths[:, None], robot.home_rotation)


def clearance(robot: Robot, tips: Array, axes: Array, length: Array) -> kinematics.Nearest | None:
    """The two legs nearest to each other, their tips (T, n, 3), axes (T, n, 3) and lengths (T, n) given.

    None where there are no `pairs_of_legs`.
    """
    pairs = pairs_of_legs(robot)
    return _nearest(robot, pairs, tips, axes, length) if pairs else None


def _nearest(robot: Robot, pairs: Pairs, tips: Array, axes: Array, length: Array) -> kinematics.Nearest:
    feet = tips - length[..., None] * axes
    return kinematics.nearest_legs(feet, tips, _mouths(robot), _radii(robot), np.array(pairs))


def _mouths(robot: Robot) -> Array:
    return np.array([leg.cylinder.mouth for leg in robot.legs])


@cache_per_robot
def pairs_of_legs(robot: Robot) -> Pairs:
    """Pairs of legs that do not meet at a joint, numbers from 0; none in a plane, where legs lie in layers.

    Legs meet where the centres of their joints are nearer to each other than the radius of the thinner one.
    """
    if robot.plane:
        return []
    radii, ends = _radii(robot), np.stack([robot.home_bases, robot.platform_joints], axis=1)
    pairs = combinations(range(robot.count), 2)
    return [
        (i, k) for i, k in pairs if (np.linalg.norm(ends[i] - ends[k], axis=1) > np.minimum(radii[i], radii[k])).all()
    ]


def _radii(robot: Robot) -> Array:
    """Radii of cylinders and pistons, (n, 2) [m]; a strut is a piston."""
    pistons = np.array([0.5 * leg.piston.width for leg in robot.legs])
    given = [leg.cylinder.diameter for leg in robot.legs]
    around = np.where([leg.strut is None for leg in robot.legs], CYLINDER, 1.0) * pistons
    cylinders = [size if wide is None else 0.5 * wide for wide, size in zip(given, around, strict=True)]
    return np.stack([cylinders, pistons], axis=1)


@dataclass(frozen=True, kw_only=True)
class Drawn:
    """Robot at T instants as it is drawn, in the axes of the base.

    ``place`` (T, 3), ``rotation`` (T, 3, 3): of the payload's centre of mass; ``base`` (T or 1, n, 3): base joints.
    """

    place: Array
    rotation: Array
    base: Array

    def tips(self, robot: Robot) -> Array:
        """Platform joints, (T, n, 3)."""
        return self.place[:, None] + (robot.platform_joints - robot.com) @ self.rotation.swapaxes(1, 2)

    def axes(self, robot: Robot) -> Array:
        """Unit vectors from base to platform joint, (T, n, 3)."""
        vectors = self.tips(robot) - self.base
        return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def drawn_turns(robot: Robot, kernel: Kernel, at: Drawn) -> Array:
    """Turns of joints since home, (T, n, 2) [rad], by compiled loops where the equations are compiled."""
    if kernel.library is None:
        return joint_angles(robot, at.axes(robot), at.rotation)
    return DrawnLegs(kernel, robot, at.place, at.rotation, at.base).turns()


def drawn_clearance(robot: Robot, kernel: Kernel, at: Drawn, length: Array) -> kinematics.Nearest:
    """The two legs of `pairs_of_legs` nearest to each other, by compiled loops where the equations are compiled."""
    pairs = pairs_of_legs(robot)
    if kernel.library is None:
        return _nearest(robot, pairs, at.tips(robot), at.axes(robot), length)
    legs = DrawnLegs(kernel, robot, at.place, at.rotation, at.base)
    return legs.nearest(np.array(pairs), _mouths(robot), _radii(robot), length)


def body_results(
    robot: Robot, kernel: Kernel, drawn: Callable[[], Drawn], length: Callable[[], Array]
) -> dict[str, ArraySource]:
    """Turns of joints and least distance of legs over time, computed on request; `length` of the legs, (T, n)."""
    largest = joint_angle_limits(robot)
    turn_angles = cache(lambda: drawn_turns(robot, kernel, drawn()))
    nearest = cache(lambda: drawn_clearance(robot, kernel, drawn(), length()))
    found: dict[str, ArraySource] = {"joint_turn": turn_angles}
    if np.isfinite(largest).any():
        found["joint_margin"] = lambda: largest - turn_angles()
    if pairs_of_legs(robot):
        found |= {"leg_clearance": lambda: nearest().gap, "nearest_legs": lambda: nearest().legs + 1}
    return found


def flexible_axes(robot: Robot, system: System, record: Record | RestStates) -> Array:
    """Unit vectors from base to platform joint, world axes, (T, legs, 3)."""
    return to_world(system, robot, record.q, draw(robot, system, record).axes(robot))


def draw(robot: Robot, system: System, record: Record | RestStates) -> Drawn:
    """The robot as it is drawn at the instants of a record."""
    place, R = rigid_pose(system, robot, record.q, record.pose, getattr(record, "attitude", None))
    shapes = system.kernel.shapes
    base = base_points(rigid_limbs(robot), record.q[..., shapes.index("chi")] if shapes.has("chi") else None)
    return Drawn(place=place, rotation=R, base=base if base.ndim == 3 else base[None])
