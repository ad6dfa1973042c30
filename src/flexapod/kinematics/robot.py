"""The closed-form mathematics of this package, applied to a `flexapod.model.Robot`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import lru_cache, wraps
from typing import TYPE_CHECKING, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import InputError
from flexapod.kinematics import dynamics, forward, inverse, jacobian, mechanism, motions, trajectory, workspace
from flexapod.kinematics.dynamics import LegBodies, PayloadBody, RigidForces
from flexapod.kinematics.inverse import LegState
from flexapod.kinematics.laws import Law
from flexapod.kinematics.leg_geometry import COORDINATES, DRIVEN, Limbs, limbs
from flexapod.kinematics.mechanism import Reach
from flexapod.kinematics.mobility import Mobility, Posture, holding, mobility
from flexapod.kinematics.mobility import drive_jacobian as rates_of_drives
from flexapod.kinematics.trajectory import Poses

if TYPE_CHECKING:
    from flexapod.model import Motion, Robot


T = TypeVar("T")


def once(compute: Callable[[Robot], T]) -> Callable[[Robot], T]:
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


@once
def home_pose(robot: Robot) -> Poses:
    """Home pose, at rest: one sample."""
    return Poses.at_rest(robot.home_position, robot.home_rotation)


@once
def robot_limbs(robot: Robot) -> Limbs:
    """The legs of a robot as numbers, see `limbs.limbs`."""
    return limbs(robot)


@once
def rigid_limbs(robot: Robot) -> Limbs:
    """The legs of the rigid path as numbers, see `limbs.limbs`."""
    return limbs(robot, rigid=True)


@once
def home_frames(robot: Robot) -> Array:
    """Home frames [x y z]_i of the legs, leg to world, shape (n, 3, 3), read-only, Eq. (T2.14)."""
    return rigid_limbs(robot).frames


def posture(robot: Robot, pose: Poses) -> Posture:
    """Legs and platform at one pose.

    Raises
    ------
    InputError
        The legs do not reach it.
    """
    legs = rigid_limbs(robot)
    found = mechanism.legs_at(legs, pose)
    mechanism.refuse_lost(legs, found)
    return Posture(found.q, pose.position[0], pose.rotation[0])


def reach(robot: Robot, path: Poses) -> Reach:
    """What T poses ask of the legs, whether they can take them or not; see `mechanism.Reach`."""
    legs = rigid_limbs(robot)
    if legs.plain:
        length, _, beta = inverse.directions_of(_leg_map(robot), path)
        gap = np.where(length < inverse.NO_LENGTH, np.inf, 0.0)
        return Reach(length, np.zeros_like(length), {"universal joint": np.abs(beta)}, gap)
    return mechanism.reach(legs, path)


def leg_axes(robot: Robot, path: Poses, legs: LegState | None = None) -> Array:
    """Unit vectors along the legs, from base to platform joint, (T, n, 3); `legs` of the same poses, if known."""
    if rigid_limbs(robot).plain:
        vectors = path.place(robot.platform_joints) - robot.base_joints
        return vectors / (np.linalg.norm(vectors, axis=-1) if legs is None else legs.length)[..., None]
    limbs = rigid_limbs(robot)
    return mechanism.axes(limbs, mechanism.legs_at(limbs, path).q if legs is None else mechanism.coordinates_of(legs))


@once
def _leg_map(robot: Robot) -> inverse.LegMap:
    return inverse.LegMap.of(robot.base_joints, robot.platform_joints, home_frames(robot))


def leg_bodies(robot: Robot) -> LegBodies:
    """Masses and inertias of the six legs as arrays; that of sections which turn is with the cylinder's."""
    cylinders, pistons = [leg.cylinder for leg in robot.legs], [leg.piston for leg in robot.legs]
    return LegBodies(
        cylinder_mass=np.array([c.mass for c in cylinders]),
        cylinder_com=np.array([c.com for c in cylinders]),
        cylinder_inertia=np.array(
            [c.inertia + p.rotary_inertia.mean() for c, p in zip(cylinders, pistons, strict=True)]
        ),
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
    """Poses at instants `t` [s], shape (T,): as commanded, and where legs guide the platform as they make it move.

    See `trajectory.sample`, `mechanism.follow`.

    Raises
    ------
    InputError
        The robot does not have a motion that is asked for, or cannot take a pose.
    """
    legs, t = rigid_limbs(robot), trajectory.instants(t)
    if legs.guides:
        return poses_of_law(robot, motion, trajectory.coordinates(motion, t), t)
    mechanism.refuse_far(legs, trajectory.coordinates(motion, t), motion.pivot, t)
    return trajectory.sample(home_pose(robot), motion, t)


def poses_of_law(robot: Robot, motion: Motion, law: Law, t: Array) -> Poses:
    """Poses at instants `t` (T,) [s] where another law (T, 6) takes the place of a motion's own.

    Raises
    ------
    InputError
        As `poses`.
    """
    legs = rigid_limbs(robot)
    mechanism.refuse_far(legs, law, motion.pivot, t)
    if legs.guides:
        return _following(robot, commanded_axes(robot, motion), law, motion.pivot, t)
    return trajectory.poses_from_coordinates(home_pose(robot), law, motion.pivot)


def commanded_axes(robot: Robot, motion: Motion) -> Mask:
    """Coordinates of the platform (6,) that a motion commands; the others follow, or stay.

    Raises
    ------
    InputError
        The robot does not have a motion that is asked for.
    """
    legs = rigid_limbs(robot)
    return motions.commanded(legs, motion, _mobility(robot)) if legs.guides else ~legs.hub_held


def first_looks(robot: Robot, motion: Motion, t: Array) -> Iterator[NDArray[np.intp]]:
    """Indices of few instants `t` (T,) at which to see first whether legs follow; see `mechanism.first_looks`.

    None for legs UPS, which are known in closed form.

    Raises
    ------
    InputError
        The motion leads beyond all robots.
    """
    legs = rigid_limbs(robot)
    if legs.plain:
        return iter(())
    law = trajectory.coordinates(motion, t)
    mechanism.refuse_far(legs, law, motion.pivot, t)
    return mechanism.first_looks(legs, law, motion.pivot)


def places(robot: Robot, motion: Motion, t: ArrayLike) -> tuple[Array, Array]:
    """Position (T, 3) and rotation (T, 3, 3) of `poses` alone."""
    if rigid_limbs(robot).guides:
        path = poses(robot, motion, t)
        return path.position, path.rotation
    return trajectory.places(home_pose(robot), trajectory.coordinates(motion, trajectory.instants(t)), motion.pivot)


def poses_from_home(robot: Robot, values: Array, named: Mask | None = None) -> Poses:
    """Poses at rest from surge, sway, heave [m], roll, pitch, yaw [rad] from home, (P, 6).

    Where legs guide the platform the values of those that are `named` (6,), by default those that are not all zero,
    count, and the others follow; a pose that the legs cannot take is NaN.
    """
    legs, still, pivot = rigid_limbs(robot), np.zeros_like(values), np.zeros(3)
    law = Law(values, still, still)
    if not legs.guides:
        return Poses.at_rest(*trajectory.places(home_pose(robot), law, pivot))
    moved = (values != 0).any(axis=0) if named is None else named
    return _following(robot, motions.independent_axes(legs, moved, pivot, found=_mobility(robot)), law, pivot)


def _following(robot: Robot, free: Mask, law: Law, pivot: Array, t: Array | None = None) -> Poses:
    legs = rigid_limbs(robot)
    if (free | legs.hub_held).all():
        return trajectory.poses_from_coordinates(home_pose(robot), law, pivot)
    return mechanism.follow(legs, ~(free | legs.hub_held), law, pivot, t)


@once
def _mobility(robot: Robot) -> Mobility:
    return mobility(rigid_limbs(robot))


def inverse_kinematics(robot: Robot, path: Poses) -> LegState:
    """Legs with two derivatives, arrays (T, n); see `inverse.leg_state`, of others than UPS `mechanism.leg_state`."""
    if rigid_limbs(robot).plain:
        return inverse.state_of(_leg_map(robot), path)
    return mechanism.leg_state(rigid_limbs(robot), path)


def refuse_folded(robot: Robot, path: Poses, found: Reach) -> None:
    """Raise as `inverse_kinematics` of poses that legs reach, if one of their joints folds."""
    if not rigid_limbs(robot).plain or (found.angles["universal joint"] > inverse.BETA_LIMIT).any():
        inverse_kinematics(robot, path)


def drive_positions(robot: Robot, path: Poses) -> Array:
    """Positions (T, m) of the driven legs as the study file counts them: lengths, ways [m], angles of cranks [rad]."""
    legs = rigid_limbs(robot)
    return mechanism.drives_of(legs, mechanism.legs_at(legs, path).q)


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


def drive_jacobian(robot: Robot, path: Poses, point: ArrayLike = (0.0, 0.0, 0.0)) -> Array:
    """Rates of the m driven coordinates for twists of a platform point, (T, m, 6); see `mobility.drive_jacobian`."""
    legs, at = rigid_limbs(robot), np.asarray(point, dtype=float)
    if legs.plain and (legs.state[:, COORDINATES.index("l")] == DRIVEN).all():
        return jacobian.length_jacobian(robot.base_joints, robot.platform_joints, path.position, path.rotation, at)
    return rates_of_drives(legs, mechanism.legs_at(legs, path).q, path, at)


def _scaled_jacobian(robot: Robot, path: Poses) -> Array:
    """What the locked legs hold of the platform, (T, m, d) with m at least d, Eqs. (T2.23), (T14.19)."""
    legs, held = rigid_limbs(robot), rigid_limbs(robot).hub_held
    if legs.plain and not held.any() and len(legs) == 6:
        return jacobian.scaled_path(robot.base_joints, robot.platform_joints, path)
    if held.all():
        return np.ones((len(path), 1, 1))
    rows = holding(legs, mechanism.legs_at(legs, path).q, path, legs.platform.mean(axis=0))
    found = jacobian.scaled(rows, legs.L_c)[..., ~held]
    short = max(found.shape[2] - found.shape[1], 0)
    return np.concatenate([found, np.zeros((len(path), short, found.shape[2]))], axis=1)


def singularity(robot: Robot, path: Poses) -> jacobian.SingularityPath:
    """Singular values, condition and determinant along a path; see `jacobian.along_path`."""
    return jacobian.along_path(_scaled_jacobian(robot, path))


def determinants(robot: Robot, path: Poses) -> Array:
    """Of what six locked legs hold of the six motions of their platform, (T,)."""
    return np.asarray(np.linalg.det(_scaled_jacobian(robot, path)), dtype=np.float64)


def nearest_singularity(robot: Robot, path: Poses) -> jacobian.NearestSingularity:
    """The pose of a path that is nearest to a singularity; see `jacobian.nearest`."""
    return jacobian.nearest(_scaled_jacobian(robot, path))


def forward_kinematics(robot: Robot, drives: ArrayLike, guess: Poses | None = None) -> Poses:
    """Poses at positions of the drives, (T, m) or (m,): Newton, from `guess` (default: home).

    Lengths [m], and of carriages what the study file calls their position [m, rad]. Of six legs UPS each pose starts
    from the one before.
    """
    legs = rigid_limbs(robot)
    if legs.plain and len(legs) == 6 and not legs.guides:
        start = home_pose(robot) if guess is None else guess
        return forward.newton_path(robot.base_joints, robot.platform_joints, drives, start)
    return mechanism.forward(legs, np.asarray(drives, dtype=float), guess)


def postures(robot: Robot, lengths: ArrayLike) -> forward.Postures:
    """All poses that fit the six leg lengths (6,) [m]; see `forward.all_postures`.

    Raises
    ------
    InputError
        The robot has other legs than six of the kind UPS.
    """
    legs = rigid_limbs(robot)
    if not legs.plain or len(legs) != 6 or legs.guides:
        raise InputError(
            "has postures that are not known all at once",
            key="robot.type",
            value=robot.type,
            allowed="six legs UPS: their equations are solved completely",
            next_step="Use forward_kinematics, which finds the pose next to a guess",
        )
    return forward.all_postures(robot.base_joints, robot.platform_joints, lengths)


def strokes(robot: Robot, t: ArrayLike, length: Array) -> list[workspace.Excess]:
    """Legs that leave their stroke on a path of lengths (T, 6) at instants `t` (T,); empty if none does."""
    return workspace.stroke_excess(t, length, _limits(robot))


@once
def _limits(robot: Robot) -> Array:
    """Least and largest lengths of the legs (n, 2) [m]."""
    return np.array([(leg.stroke.min, leg.stroke.max) if leg.stroke else (0.0, np.inf) for leg in robot.legs])


@once
def carriage_limits(robot: Robot) -> Array:
    """Least and largest place of the carriages (n, 2) [m, of a crank rad]; infinite without a limit."""
    travels = [leg.carriage.stroke if leg.carriage else None for leg in robot.legs]
    return np.array([(-np.inf, np.inf) if travel is None else (travel.min, travel.max) for travel in travels])


def carriages(robot: Robot, t: ArrayLike, place: Array) -> list[workspace.Excess]:
    """Carriages that leave their stroke on a path of places (T, n) [m, rad] at instants `t` (T,)."""
    turns = rigid_limbs(robot).carriage == "crank"
    return workspace.carriage_excess(t, place, carriage_limits(robot), turns=turns)


def pull_out(robot: Robot, t: ArrayLike, length: Array) -> list[workspace.Excess]:
    """Pistons that vanish in their cylinder, leave it or pass the universal joint; see `workspace.piston_excess`."""
    return workspace.piston_excess(t, length, *_pistons(robot))


def reachable(robot: Robot, path: Poses) -> Mask:
    """Whether each of T poses keeps legs and carriages within their strokes and pistons in their cylinders, (T,)."""
    found, ways = reach(robot, path), carriage_limits(robot)
    within = np.all((found.carriage >= ways[:, 0]) & (found.carriage <= ways[:, 1]), axis=1)
    return workspace.reachable(found.length, _limits(robot), *_pistons(robot)) & within & ~found.lost


@once
def _pistons(robot: Robot) -> tuple[Array, Array]:
    """Mouths of the cylinders and lengths of the pistons (n,) [m]; a strut leaves no cylinder."""
    mouth = np.array([leg.cylinder.mouth for leg in robot.legs])
    return mouth, np.array([leg.piston.length if leg.strut is None else np.inf for leg in robot.legs])
