"""States of the undeformed robot on its rigid path, many at once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array, Index
from flexapod.kinematics.leg_geometry import COORDINATES, HELD, Limbs
from flexapod.kinematics.mechanism import leg_state, legs_at
from flexapod.kinematics.robot import cache_per_robot
from flexapod.kinematics.rotations import cross, quaternion
from flexapod.kinematics.screws import screws
from flexapod.mechanics.leg.layout import Shapes
from flexapod.model import Robot
from flexapod.solve.batch import Rates, RestStates
from flexapod.solve.system import State, System

GAMMA = slice(COORDINATES.index("gamma1"), None)


def leg_coordinates(shapes: Shapes) -> tuple[Index, Index]:
    """Indices of the `leg_geometry.COORDINATES` that a leg of these shapes has, and their positions in q."""
    there = [k for k, name in enumerate(COORDINATES) if shapes.has(name)]
    return np.array(there), np.array([shapes.index(COORDINATES[k]) for k in there])


def rigid_motion(system: System, at: kinematics.RigidPoses) -> tuple[RestStates, Rates]:
    """Configurations of the undeformed robot at the instants of a path, without forces, and their rates."""
    q, v, v_dot = _undeformed(system, at, 3)
    robot, path = at.robot, at.poses
    R, w, w_dot = path.rotation, path.omega, path.alpha
    arm, inverse = R @ robot.com, R.swapaxes(1, 2)
    turning = _cross(w, arm)
    velocity, acceleration = path.velocity + turning, path.acceleration + _cross(w_dot, arm) + _cross(w, turning)
    u, u_dot = (
        np.concatenate([linear, (inverse @ angular[..., None])[..., 0]], axis=1)
        for linear, angular in ((velocity, w), (acceleration, w_dot))
    )
    return _without_forces(system, at, q), Rates(v=v, v_dot=v_dot, u=u, u_dot=u_dot)


def rigid_rest(system: System, at: kinematics.RigidPoses) -> RestStates:
    """States of the undeformed robot at poses, without forces."""
    return _without_forces(system, at, _undeformed(system, at, 1)[0])


def rigid_rates(system: System, at: kinematics.RigidPoses) -> Array:
    """Rates of the undeformed robot in its flat coordinates at the instants of a path, (T, size)."""
    v, path = _undeformed(system, at, 2)[1], at.poses
    velocity = path.velocity + _cross(path.omega, path.rotation @ at.robot.com)
    turn = (path.rotation.swapaxes(1, 2) @ path.omega[..., None])[..., 0]
    return np.concatenate([v.reshape(len(path), -1), velocity, turn], axis=1)


def _cross(a: Array, b: Array) -> Array:
    """Cross products of rows (T, 3)."""
    return np.stack(cross(a.T, b.T), axis=-1)


def _without_forces(system: System, at: kinematics.RigidPoses, q: Array) -> RestStates:
    T, R = len(at.poses), at.poses.rotation
    return RestStates(
        q=q,
        pose=np.concatenate([at.poses.position + R @ at.robot.com, quaternion(R)], axis=1),
        lam=np.zeros((T, system.legs, system.rows)),
        drive=np.zeros((T, system.legs, system.ports.size)),
    )


def rigid_state(system: System, at: kinematics.RigidPoses) -> State:
    """State of the undeformed robot on the commanded path (one sample), with its rates and accelerations; no forces."""
    return _with_rates(rigid_motion(system, at))


def built_state(system: System, at: kinematics.RigidPoses) -> State:
    """State of the undeformed robot as built, its drives commanded along the rigid path (one sample), with rates.

    The platform's rates are those of the path; a start makes them fit.
    """
    robot, found = at.robot, kinematics.built_poses(at.robot, at.poses)
    path = replace(at.poses, position=found.position, rotation=found.rotation)
    built = kinematics.built_limbs(robot, kinematics.rigid_limbs(robot))
    legs = leg_state(built, path, legs_at(built, path))
    return _with_rates(rigid_motion(system, kinematics.RigidPoses(robot, path, legs)))


def _with_rates(motion: tuple[RestStates, Rates]) -> State:
    states, rates = motion
    v, v_dot = (np.concatenate([x[0].ravel(), y[0]]) for x, y in ((rates.v, rates.u), (rates.v_dot, rates.u_dot)))
    return replace(states.state(0), v=v, v_dot=v_dot)


def _undeformed(system: System, at: kinematics.RigidPoses, orders: int) -> Array:
    """Coordinates of the undeformed legs at T poses, rates and accelerations, (orders, T, legs, n)."""
    robot, path, found = at.robot, at.poses, at.legs
    legs, shapes = _as_built(robot), system.kernel.shapes
    x = np.zeros((orders, *found.length.shape, len(COORDINATES)))
    there, places = leg_coordinates(shapes)
    for k in range(len(COORDINATES)) if shapes.has("gamma1") else there:
        for order, values in zip(range(orders), found.coordinate(COORDINATES[k]), strict=False):
            x[order, ..., k] = values
    held = legs.state == HELD  # welds, which the rigid path releases, too
    x[:, :, held] = 0.0
    x[0] += np.where(held, legs.home, 0.0)
    if shapes.has("gamma1"):
        _turn_balls(legs, x, path)
    q = np.zeros((*x.shape[:3], system.n))
    q[..., places] = x[..., there]
    for element in shapes.elements:
        has = [element.of(leg) is not None for leg in robot.legs]
        for name, other in element.follows.items():
            q[..., shapes.index(name)] = np.where(has, q[..., shapes.index(other)], 0.0)
    return q


@cache_per_robot
def _as_built(robot: Robot) -> Limbs:
    return kinematics.built_limbs(robot, kinematics.robot_limbs(robot))


def _turn_balls(legs: Limbs, x: Array, path: kinematics.Poses) -> None:
    """Angles of ideal balls beside joints of other kinds: what turns the end of the leg into the platform."""
    balls = np.flatnonzero(~legs.pose_closure)
    left = screws(legs, x[0]).frame.swapaxes(-1, -2) @ path.rotation[:, None] @ legs.platform_frames
    angles = np.stack(
        [
            np.arctan2(-left[..., 1, 2], left[..., 2, 2]),
            np.arcsin(np.clip(left[..., 0, 2], -1.0, 1.0)),
            np.arctan2(-left[..., 0, 1], left[..., 0, 0]),
        ],
        axis=-1,
    )
    x[0][:, balls, GAMMA] = angles[:, balls]
    chain = screws(legs, x[0])
    turns = chain.columns[:, :, 3:]
    for order, whole in ((1, path.omega), (2, path.alpha))[: len(x) - 1]:
        rest = whole[:, None, :, None] - turns @ x[order][..., None]
        if order == 2:
            rest = rest - chain.bias(x[1])[..., 3:, None]
        x[order][:, balls, GAMMA] = np.linalg.solve(turns[:, balls][..., GAMMA], rest[:, balls])[..., 0]
