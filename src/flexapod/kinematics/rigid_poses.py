"""The rigid robot at poses: coordinates of its legs, what the poses ask of them, Jacobians and forces."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexapod.common.arrays import Array, Mask
from flexapod.kinematics import dynamics, inverse, jacobian, mechanism, workspace
from flexapod.kinematics.closures import Closed, ClosureMotion
from flexapod.kinematics.dynamics import LoadSharing, RigidForces
from flexapod.kinematics.inverse import LegState
from flexapod.kinematics.leg_geometry import COORDINATES, DRIVEN
from flexapod.kinematics.mechanism import Reach
from flexapod.kinematics.mobility import Posture, constraint_wrenches
from flexapod.kinematics.mobility import drive_jacobian as rates_of_drives
from flexapod.kinematics.robot import (
    carriage_limits,
    home_frames,
    leg_bodies,
    leg_map,
    payload_body,
    pistons,
    poses,
    rigid_limbs,
    stroke_limits,
)
from flexapod.kinematics.trajectory import Poses

if TYPE_CHECKING:
    from flexapod.model import Motion, Robot


ALL = slice(None)


class RigidPoses:
    """A rigid robot at T poses; what its legs do there is computed when it is asked for, once.

    Parameters
    ----------
    robot : Robot
    poses : Poses
        Of the platform frame.
    legs : LegState, optional
        There, where they are known.
    moved : ClosureMotion, optional
        Coordinates of the legs there with two derivatives, where they are known.
    """

    moved: ClosureMotion | None = None

    def __init__(
        self, robot: Robot, poses: Poses, legs: LegState | None = None, moved: ClosureMotion | None = None
    ) -> None:
        self.robot = robot
        self.poses = poses
        if legs is not None:
            self.legs = legs
        self.moved = moved

    @cached_property
    def closed_legs(self) -> Closed:
        """Coordinates of the legs by their closures, NaN where they do not reach."""
        moved = self.moved
        if moved is not None:
            return Closed(q=moved.q, x=moved.platform.position, gap=np.zeros(moved.q.shape[:2]))
        return mechanism.legs_at(rigid_limbs(self.robot), self.poses)

    @cached_property
    def reach(self) -> Reach:
        """Demands of the poses on the legs, reachable or not; see `mechanism.Reach`."""
        legs = rigid_limbs(self.robot)
        if not legs.plain:
            return mechanism.reach(legs, self.closed_legs)
        length, _, beta = inverse.directions_of(leg_map(self.robot), self.poses)
        gap = np.where(length < inverse.NO_LENGTH, np.inf, 0.0)
        return Reach(length, np.zeros_like(length), {"universal joint": np.abs(beta)}, gap)

    @cached_property
    def legs(self) -> LegState:
        """Legs with two derivatives, arrays (T, n); see `inverse.leg_state`, of others than UPS `mechanism.leg_state`.

        Raises
        ------
        InputError
            The legs do not take a pose.
        """
        legs = rigid_limbs(self.robot)
        if legs.plain:
            return inverse.state_of(leg_map(self.robot), self.poses)
        return mechanism.leg_state(legs, self.poses, self.closed_legs, self.moved)

    @cached_property
    def axes(self) -> Array:
        """Unit vectors along the legs, from base to platform joint, (T, n, 3)."""
        limbs = rigid_limbs(self.robot)
        if limbs.plain:
            return self._vectors / self.legs.length[..., None]
        return mechanism.axes(limbs, mechanism.coordinates_of(self.legs))

    @cached_property
    def directions(self) -> Array:
        """The same where legs need not reach; NaN where they do not."""
        limbs = rigid_limbs(self.robot)
        if limbs.plain:
            return self._vectors / np.linalg.norm(self._vectors, axis=-1)[..., None]
        return mechanism.axes(limbs, self.closed_legs.q)

    @property
    def _vectors(self) -> Array:
        """Vectors from base to platform joints, (T, n, 3) [m]."""
        return self.poses.place(self.robot.platform_joints) - self.robot.base_joints

    def resting(self, which: slice | NDArray[np.intp] = ALL) -> RigidPoses:
        """The robot at rest at all of the poses, or at some."""
        return RigidPoses(self.robot, Poses.at_rest(self.poses.position[which], self.poses.rotation[which]))

    @cached_property
    def constraints(self) -> Array:
        """Constraints of the locked legs on the platform, (T, m, d) with m at least d, Eqs. (T2.23), (T14.19)."""
        robot, path, legs = self.robot, self.poses, rigid_limbs(self.robot)
        held = legs.hub_held
        if held.all():
            return np.ones((len(path), 1, 1))
        if legs.plain:
            found = jacobian.scaled_path(robot.base_joints, robot.platform_joints, path)
            if len(legs) == 6 and not held.any():
                return found
            found = found[:, legs.state[:, COORDINATES.index("l")] == DRIVEN][..., ~held]
        else:
            rows = constraint_wrenches(legs, self.closed_legs.q, path, legs.platform.mean(axis=0))
            found = jacobian.dimensionless_jacobian(rows, legs.L_c)[..., ~held]
        short = max(found.shape[2] - found.shape[1], 0)
        return np.concatenate([found, np.zeros((len(path), short, found.shape[2]))], axis=1)

    @cached_property
    def singularity(self) -> jacobian.SingularityPath:
        """Singular values, condition and determinant along the poses; see `jacobian.singularity_measures`."""
        return jacobian.singularity_measures(self.constraints)

    @cached_property
    def nearest(self) -> jacobian.NearestSingularity:
        """The pose that is nearest to a singularity; see `jacobian.most_singular_pose`."""
        return jacobian.most_singular_pose(self.constraints)

    @cached_property
    def determinants(self) -> Array:
        """Determinants of the constraints of six locked legs on the six motions of the platform, (T,)."""
        return np.asarray(np.linalg.det(self.constraints), dtype=np.float64)

    @property
    def drive_positions(self) -> Array:
        """Positions (T, m) of the driven legs as the study file counts them: lengths, ways [m], cranks [rad]."""
        return mechanism.drives_of(rigid_limbs(self.robot), self.closed_legs.q)

    def drive_jacobian(self, point: ArrayLike = (0.0, 0.0, 0.0)) -> Array:
        """Rates of the m driven coordinates for twists of a platform point, (T, m, 6); `mobility.drive_jacobian`."""
        robot, path, legs = self.robot, self.poses, rigid_limbs(self.robot)
        at = np.asarray(point, dtype=float)
        if legs.plain:
            rows = jacobian.length_jacobian(robot.base_joints, robot.platform_joints, path.position, path.rotation, at)
            return rows[:, legs.state[:, COORDINATES.index("l")] == DRIVEN]
        return rates_of_drives(legs, self.closed_legs.q, path, at)

    def refuse_folded(self) -> None:
        """Raise as `legs` of poses that legs reach, if one of their joints folds."""
        if not rigid_limbs(self.robot).plain or (self.reach.angles["universal joint"] > inverse.BETA_LIMIT).any():
            _ = self.legs

    def inverse_dynamics(self, wrench: ArrayLike | None = None, sharing: LoadSharing | None = None) -> RigidForces:
        """Drive forces and joint reactions of legs UPS; `wrench` (T, 6) or (6,) at the tool, world axes.

        ``sharing``: of legs that are not six driven ones.
        """
        robot = self.robot
        return dynamics.inverse_dynamics(
            home_frames(robot),
            robot.platform_joints,
            leg_bodies(robot),
            payload_body(robot),
            robot.gravity,
            self.poses,
            self.legs,
            None if wrench is None else np.asarray(wrench, dtype=float),
            sharing,
        )

    def energies(self) -> tuple[Array, Array]:
        """Kinetic and gravity potential energy [J] of legs UPS, each shape (T,)."""
        robot = self.robot
        return dynamics.energies(
            home_frames(robot),
            robot.base_joints,
            leg_bodies(robot),
            payload_body(robot),
            robot.gravity,
            self.poses,
            self.legs,
        )


def rigid_poses(robot: Robot, motion: Motion, t: ArrayLike) -> RigidPoses:
    """The rigid robot at instants `t` [s], shape (T,), of a motion; raises as `poses`."""
    return RigidPoses(robot, poses(robot, motion, t))


def posture(robot: Robot, pose: Poses) -> Posture:
    """Legs and platform at one pose.

    Raises
    ------
    InputError
        The legs do not reach it.
    """
    found = RigidPoses(robot, pose).closed_legs
    mechanism.refuse_lost(rigid_limbs(robot), found)
    return Posture(found.q, pose.position[0], pose.rotation[0])


def reach(robot: Robot, path: Poses) -> Reach:
    """Demands of T poses on the legs, reachable or not; see `mechanism.Reach`."""
    return RigidPoses(robot, path).reach


def reachable(robot: Robot, path: Poses) -> Mask:
    """Mask (T,) of poses that keep legs and carriages within their strokes and pistons in their cylinders."""
    found, ways = reach(robot, path), carriage_limits(robot)
    within = np.all((found.carriage >= ways[:, 0]) & (found.carriage <= ways[:, 1]), axis=1)
    return workspace.reachable(found.length, stroke_limits(robot), *pistons(robot)) & within & ~found.lost


def refuse_folded(robot: Robot, path: Poses, found: Reach) -> None:
    """Raise as `inverse_kinematics` of poses that legs reach, if one of their joints folds; `found`: `reach` there."""
    at = RigidPoses(robot, path)
    at.reach = found
    at.refuse_folded()


def leg_axes(robot: Robot, path: Poses, legs: LegState | None = None) -> Array:
    """Unit vectors along the legs, from base to platform joint, (T, n, 3); `legs` of the same poses, if known."""
    at = RigidPoses(robot, path, legs)
    return at.directions if legs is None else at.axes


def inverse_kinematics(robot: Robot, path: Poses) -> LegState:
    """Legs with two derivatives, arrays (T, n); see `inverse.leg_state`, of others than UPS `mechanism.leg_state`."""
    return RigidPoses(robot, path).legs


def drive_positions(robot: Robot, path: Poses) -> Array:
    """Positions (T, m) of the driven legs as the study file counts them: lengths, ways [m], angles of cranks [rad]."""
    return RigidPoses(robot, path).drive_positions


def inverse_dynamics(
    robot: Robot, path: Poses, wrench: ArrayLike | None = None, legs: LegState | None = None
) -> RigidForces:
    """Drive forces and joint reactions along a path; `wrench` (T, 6) or (6,) at the tool, world axes.

    `legs`: of the same poses, where they are known already.
    """
    return RigidPoses(robot, path, legs).inverse_dynamics(wrench)


def energies(robot: Robot, path: Poses) -> tuple[Array, Array]:
    """Kinetic and gravity potential energy [J] along a path, each shape (T,)."""
    return RigidPoses(robot, path).energies()


def drive_jacobian(robot: Robot, path: Poses, point: ArrayLike = (0.0, 0.0, 0.0)) -> Array:
    """Rates of the m driven coordinates for twists of a platform point, (T, m, 6); see `mobility.drive_jacobian`."""
    return RigidPoses(robot, path).drive_jacobian(point)


def singularity(robot: Robot, path: Poses) -> jacobian.SingularityPath:
    """Singular values, condition and determinant along a path; see `jacobian.singularity_measures`."""
    return RigidPoses(robot, path).singularity


def determinants(robot: Robot, path: Poses) -> Array:
    """Determinants of the constraints of six locked legs on the six motions of the platform, (T,)."""
    return RigidPoses(robot, path).determinants


def nearest_singularity(robot: Robot, path: Poses) -> jacobian.NearestSingularity:
    """The pose of a path that is nearest to a singularity; see `jacobian.most_singular_pose`."""
    return RigidPoses(robot, path).nearest
