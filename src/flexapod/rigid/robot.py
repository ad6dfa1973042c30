"""The closed-form mathematics of this package, applied to a `flexapod.model.Robot`."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, wraps
from typing import TYPE_CHECKING, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike

from flexapod.rigid import dynamics, forward, jacobian, kinematics, trajectory, workspace
from flexapod.rigid.dynamics import LegBodies, PayloadBody, RigidForces
from flexapod.rigid.kinematics import LegState
from flexapod.rigid.trajectory import Poses
from flexapod.typing import Array

if TYPE_CHECKING:
    from flexapod.model import Motion, Robot

__all__ = [
    "energies",
    "forward_kinematics",
    "home_frames",
    "home_pose",
    "inverse_dynamics",
    "inverse_kinematics",
    "leg_bodies",
    "leg_directions",
    "nearest_singularity",
    "payload_body",
    "poses",
    "postures",
    "pull_out",
    "reachable",
    "singularity",
    "strokes",
]


T = TypeVar("T")


def _once(compute: Callable[[Robot], T]) -> Callable[[Robot], T]:
    """Compute it once for each of the last 64 robots; the same robot again is not compared with its equals."""
    of_equals = cast("Callable[[Robot], T]", lru_cache(maxsize=64)(compute))
    latest: tuple[Robot, T] | None = None

    def recalled(robot: Robot) -> T:
        nonlocal latest
        known = latest
        if known is None or known[0] is not robot:
            known = latest = robot, of_equals(robot)
        return known[1]

    return wraps(compute)(recalled)


def home_pose(robot: Robot) -> Poses:
    """Home pose, at rest: one sample."""
    return Poses.at_rest([0.0, 0.0, robot.home_height], np.eye(3))


@_once
def home_frames(robot: Robot) -> Array:
    """Home frames [x y z]_i of the legs, leg to world, shape (6, 3, 3), read-only, Eq. (T2.14)."""
    tips = robot.platform_joints + np.array([0.0, 0.0, robot.home_height])
    frames = kinematics.leg_frames(robot.base_joints, tips, [leg.u_axis for leg in robot.legs])
    frames.flags.writeable = False
    return frames


def leg_directions(robot: Robot, path: Poses) -> tuple[Array, Array, Array]:
    """Lengths, alpha and beta of the legs, (T, 6) each, folded or not; see `kinematics.directions_of`."""
    return kinematics.directions_of(_leg_map(robot), path)


@_once
def _leg_map(robot: Robot) -> kinematics.LegMap:
    return kinematics.LegMap.of(robot.base_joints, robot.platform_joints, home_frames(robot))


def leg_bodies(robot: Robot) -> LegBodies:
    """Masses and inertias of the six legs as arrays."""
    cylinders, pistons = [leg.cylinder for leg in robot.legs], [leg.piston for leg in robot.legs]
    return LegBodies(
        cylinder_mass=np.array([c.mass for c in cylinders]),
        cylinder_com=np.array([c.com for c in cylinders]),
        cylinder_inertia=np.array([c.inertia for c in cylinders]),
        cylinder_axial=np.array([c.axial_inertia for c in cylinders]),
        piston_mass=np.array([p.rhoA * p.length for p in pistons]),
        piston_length=np.array([p.length for p in pistons]),
        piston_axial=np.array([p.axial_inertia for p in pistons]),
    )


def payload_body(robot: Robot) -> PayloadBody:
    """Mass, inertia, CoM and tool of the payload as arrays."""
    load = robot.payload
    return PayloadBody(mass=load.mass, inertia=load.inertia, com=load.com, tool=load.tool)


def poses(robot: Robot, motion: Motion, t: ArrayLike) -> Poses:
    """Commanded poses at instants `t` [s], shape (T,); see `trajectory.sample`."""
    return trajectory.sample(home_pose(robot), motion, t)


def inverse_kinematics(robot: Robot, path: Poses) -> LegState:
    """Leg lengths and universal-joint angles with two derivatives, arrays (T, 6); see `kinematics.leg_state`."""
    return kinematics.state_of(_leg_map(robot), path)


def inverse_dynamics(
    robot: Robot, path: Poses, wrench: ArrayLike | None = None, legs: LegState | None = None
) -> RigidForces:
    """Drive forces and joint reactions along a path; `wrench` (T, 6) or (6,) at the tool, world axes.

    `legs`: of the same poses, where they are known already.
    """
    return dynamics.inverse_dynamics(
        home_frames(robot),
        robot.platform_joints,
        leg_bodies(robot),
        payload_body(robot),
        robot.gravity,
        path,
        inverse_kinematics(robot, path) if legs is None else legs,
        None if wrench is None else np.asarray(wrench, dtype=float),
    )


def energies(robot: Robot, path: Poses) -> tuple[Array, Array]:
    """Kinetic and gravity potential energy [J] along a path, each shape (T,)."""
    legs = inverse_kinematics(robot, path)
    return dynamics.energies(
        home_frames(robot), robot.base_joints, leg_bodies(robot), payload_body(robot), robot.gravity, path, legs
    )


def singularity(robot: Robot, path: Poses) -> jacobian.SingularityPath:
    """Singular values, condition and determinant along a path; see `jacobian.along_path`."""
    return jacobian.along_path(robot.base_joints, robot.platform_joints, path)


def nearest_singularity(robot: Robot, path: Poses) -> jacobian.NearestSingularity:
    """The pose of a path that is nearest to a singularity; see `jacobian.nearest`."""
    return jacobian.nearest(robot.base_joints, robot.platform_joints, path)


def forward_kinematics(robot: Robot, lengths: ArrayLike, guess: Poses | None = None) -> Poses:
    """Poses along a path of leg lengths (T, 6) or (6,) [m]: Newton, the first from `guess` (default: home)."""
    start = home_pose(robot) if guess is None else guess
    return forward.newton_path(robot.base_joints, robot.platform_joints, lengths, start)


def postures(robot: Robot, lengths: ArrayLike) -> forward.Postures:
    """All poses that fit the six leg lengths (6,) [m]; see `forward.all_postures`."""
    return forward.all_postures(robot.base_joints, robot.platform_joints, lengths)


def strokes(robot: Robot, t: ArrayLike, length: Array) -> list[workspace.Excess]:
    """Legs that leave their stroke on a path of lengths (T, 6) at instants `t` (T,); empty if none does."""
    limits = [(leg.stroke.min, leg.stroke.max) if leg.stroke else (0.0, np.inf) for leg in robot.legs]
    return workspace.stroke_excess(t, length, np.array(limits))


def pull_out(robot: Robot, t: ArrayLike, length: Array) -> list[workspace.Excess]:
    """Pistons that vanish in their cylinder, leave it or pass the universal joint; see `workspace.piston_excess`."""
    mouth = np.array([leg.cylinder.mouth for leg in robot.legs])
    piston = np.array([leg.piston.length for leg in robot.legs])
    return workspace.piston_excess(t, length, mouth, piston)


def reachable(robot: Robot, path: Poses) -> Array:
    """Whether each of T poses keeps every leg within its stroke and its piston in its cylinder, bool (T,)."""
    length = kinematics.leg_lengths(robot.base_joints, robot.platform_joints, path.position, path.rotation)
    limits = [(leg.stroke.min, leg.stroke.max) if leg.stroke else (0.0, np.inf) for leg in robot.legs]
    mouth = np.array([leg.cylinder.mouth for leg in robot.legs])
    piston = np.array([leg.piston.length for leg in robot.legs])
    return workspace.reachable(length, np.array(limits), mouth, piston)
