"""The closed-form mathematics of this package, applied to a `flexapod.model.Robot`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import lru_cache, wraps
from typing import TYPE_CHECKING, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import InputError
from flexapod.kinematics import forward, inverse, mechanism, motions, trajectory, workspace
from flexapod.kinematics.closures import ClosureMotion
from flexapod.kinematics.dynamics import LegBodies, PayloadBody
from flexapod.kinematics.laws import Law
from flexapod.kinematics.leg_geometry import Limbs, limbs
from flexapod.kinematics.mobility import Mobility, mobility
from flexapod.kinematics.trajectory import Poses

if TYPE_CHECKING:
    from flexapod.model import Motion, Robot


T = TypeVar("T")
LATEST = 4  # robots that are known without a comparison


def _latest_kept(compute: Callable[[Robot], T]) -> Callable[[Robot], T]:
    """Compute it once for each of the last 64 robots; the same robot again is not compared with its equals."""
    of_equals = cast("Callable[[Robot], T]", lru_cache(maxsize=64)(compute))
    latest: dict[int, tuple[Robot, T]] = {}  # a robot and its ideal one are asked for in turns

    def look_up(robot: Robot) -> T:
        known = latest.get(id(robot))
        if known is None or known[0] is not robot:
            if len(latest) >= LATEST:
                latest.clear()
            known = latest[id(robot)] = robot, of_equals(robot)
        return known[1]

    return wraps(compute)(look_up)


@_latest_kept
def _first_equal(robot: Robot) -> Robot:
    """The first one of robots that are equal."""
    return robot


def cache_per_robot(compute: Callable[[Robot], T]) -> Callable[[Robot], T]:
    """Compute it once for each of the last 64 robots.

    A robot is compared with its equals once for all that is computed of it, not for each.
    """
    of_first = _latest_kept(compute)
    return wraps(compute)(lambda robot: of_first(_first_equal(robot)))


@cache_per_robot
def home_pose(robot: Robot) -> Poses:
    """Home pose, at rest: one sample."""
    return Poses.at_rest(robot.home_position, robot.home_rotation)


@cache_per_robot
def robot_limbs(robot: Robot) -> Limbs:
    """Geometry of the legs of a robot as numbers, see `leg_geometry.limbs`."""
    return limbs(robot)


@cache_per_robot
def rigid_limbs(robot: Robot) -> Limbs:
    """Geometry of the legs on the rigid path as numbers, see `leg_geometry.limbs`."""
    return limbs(robot, rigid=True)


@cache_per_robot
def home_frames(robot: Robot) -> Array:
    """Home frames [x y z]_i of the legs, leg to world, shape (n, 3, 3), read-only, Eq. (T2.14)."""
    return rigid_limbs(robot).frames


@cache_per_robot
def leg_map(robot: Robot) -> inverse.LegMap:
    """Numbers by which poses become legs UPS."""
    return inverse.LegMap.from_joints(robot.base_joints, robot.platform_joints, home_frames(robot))


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
    legs, t = rigid_limbs(robot), trajectory.check_instants(t)
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


def poses_with_legs(robot: Robot, motion: Motion, t: Array) -> tuple[Poses, ClosureMotion]:
    """Poses of a motion at instants `t` (T,) [s] and the legs there by their closures; NaN where legs do not reach.

    Raises
    ------
    InputError
        The robot does not have a motion that is asked for, or the motion leads beyond all robots.
    """
    legs = rigid_limbs(robot)
    unknown = ~(commanded_axes(robot, motion) | legs.hub_held)
    if not legs.guides or not unknown.any():
        path = poses(robot, motion, t)
        return path, mechanism.moved_legs(legs, path, mechanism.legs_at(legs, path))
    law = trajectory.coordinates(motion, t)
    mechanism.refuse_far(legs, law, motion.pivot, t)
    moved = mechanism.follow_with_legs(legs, unknown, law, motion.pivot)
    return mechanism.poses_of(legs, moved, motion.pivot), moved


def commanded_axes(robot: Robot, motion: Motion) -> Mask:
    """Coordinates of the platform (6,) that a motion commands; the others follow, or stay.

    Raises
    ------
    InputError
        The robot does not have a motion that is asked for.
    """
    legs = rigid_limbs(robot)
    return motions.commanded_coordinates(legs, motion, _mobility(robot)) if legs.guides else ~legs.hub_held


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
    return trajectory.places(
        home_pose(robot), trajectory.coordinates(motion, trajectory.check_instants(t)), motion.pivot
    )


def poses_from_home(robot: Robot, values: Array, named: Mask | None = None, about: Array | None = None) -> Poses:
    """Poses at rest from surge, sway, heave [m] of a point, roll, pitch, yaw [rad] about it, from home, (P, 6).

    The point `about` (3,) is one of the platform frame, by default its origin.

    Where legs guide the platform the values of those that are `named` (6,), by default those that are not all zero,
    count, and the others follow; a pose that the legs cannot take is NaN.
    """
    legs, still = rigid_limbs(robot), np.zeros_like(values)
    pivot = np.zeros(3) if about is None else about
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


@cache_per_robot
def _mobility(robot: Robot) -> Mobility:
    return mobility(rigid_limbs(robot))


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
    return workspace.stroke_excess(t, length, stroke_limits(robot))


@cache_per_robot
def stroke_limits(robot: Robot) -> Array:
    """Least and largest lengths of the legs (n, 2) [m]."""
    return np.array([(leg.stroke.min, leg.stroke.max) if leg.stroke else (0.0, np.inf) for leg in robot.legs])


@cache_per_robot
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
    return workspace.piston_excess(t, length, *pistons(robot))


@cache_per_robot
def pistons(robot: Robot) -> tuple[Array, Array]:
    """Mouths of the cylinders and lengths of the pistons (n,) [m]; a strut leaves no cylinder."""
    mouth = np.array([leg.cylinder.mouth for leg in robot.legs])
    return mouth, np.array([leg.piston.length if leg.strut is None else np.inf for leg in robot.legs])
