"""States of the undeformed robot on its rigid path, many at once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array
from flexapod.kinematics.leg_geometry import COORDINATES, HELD, Limbs
from flexapod.kinematics.mechanism import leg_state
from flexapod.kinematics.robot import once
from flexapod.kinematics.rotations import cross, quaternion
from flexapod.kinematics.screws import screws
from flexapod.mechanics.leg.layout import Shapes
from flexapod.model import Robot
from flexapod.solve.batch import Rates, RestStates
from flexapod.solve.system import Index, State, System

GAMMA = slice(COORDINATES.index("gamma1"), None)


def leg_coordinates(shapes: Shapes) -> tuple[Index, Index]:
    """Which of `kinematics.limbs.COORDINATES` a leg of these shapes has, and where in q."""
    there = [k for k, name in enumerate(COORDINATES) if shapes.has(name)]
    return np.array(there), np.array([shapes.index(COORDINATES[k]) for k in there])


def rigid_motion(
    system: System, robot: Robot, path: kinematics.Poses, legs: kinematics.LegState | None = None
) -> tuple[RestStates, Rates]:
    """Configurations of the undeformed robot at the instants of a path, without forces, and their rates.

    `legs`: at these poses, of a robot that is not as drawn.
    """
    legs = kinematics.inverse_kinematics(robot, path) if legs is None else legs
    q, v, v_dot = _undeformed(system, robot, path, legs, 3)
    R, w, w_dot = path.rotation, path.omega, path.alpha
    arm, inverse = R @ robot.com, R.swapaxes(1, 2)
    turning = _cross(w, arm)
    velocity, acceleration = path.velocity + turning, path.acceleration + _cross(w_dot, arm) + _cross(w, turning)
    u, u_dot = (
        np.concatenate([linear, (inverse @ angular[..., None])[..., 0]], axis=1)
        for linear, angular in ((velocity, w), (acceleration, w_dot))
    )
    return _without_forces(system, robot, path, q), Rates(v=v, v_dot=v_dot, u=u, u_dot=u_dot)


def rigid_rest(system: System, robot: Robot, path: kinematics.Poses) -> RestStates:
    """States of the undeformed robot at the poses of a path, without forces."""
    q = _undeformed(system, robot, path, kinematics.inverse_kinematics(robot, path), 1)[0]
    return _without_forces(system, robot, path, q)


def rigid_rates(system: System, robot: Robot, path: kinematics.Poses) -> Array:
    """Rates of the undeformed robot in its flat coordinates at the instants of a path, (T, size)."""
    v = _undeformed(system, robot, path, kinematics.inverse_kinematics(robot, path), 2)[1]
    velocity = path.velocity + _cross(path.omega, path.rotation @ robot.com)
    turn = (path.rotation.swapaxes(1, 2) @ path.omega[..., None])[..., 0]
    return np.concatenate([v.reshape(len(path), -1), velocity, turn], axis=1)


def _cross(a: Array, b: Array) -> Array:
    """Cross products of rows (T, 3)."""
    return np.stack(cross(a.T, b.T), axis=-1)


def _without_forces(system: System, robot: Robot, path: kinematics.Poses, q: Array) -> RestStates:
    T, R = len(path), path.rotation
    return RestStates(
        q=q,
        pose=np.concatenate([path.position + R @ robot.com, quaternion(R)], axis=1),
        lam=np.zeros((T, system.legs, system.rows)),
        drive=np.zeros((T, system.legs, system.ports.size)),
    )


def rigid_state(system: System, robot: Robot, path: kinematics.Poses) -> State:
    """State of the undeformed robot on the commanded path (one sample), with its rates and accelerations; no forces."""
    return _with_rates(rigid_motion(system, robot, path))


def built_state(system: System, robot: Robot, path: kinematics.Poses) -> State:
    """State of the undeformed robot as built, its drives told to follow the rigid path (one sample), with rates.

    The platform's rates are those of the path; a start makes them fit.
    """
    at = kinematics.built_poses(robot, path)
    at = replace(path, position=at.position, rotation=at.rotation)
    legs = leg_state(kinematics.built_limbs(robot, kinematics.rigid_limbs(robot)), at)
    return _with_rates(rigid_motion(system, robot, at, legs))


def _with_rates(motion: tuple[RestStates, Rates]) -> State:
    states, rates = motion
    v, v_dot = (np.concatenate([x[0].ravel(), y[0]]) for x, y in ((rates.v, rates.u), (rates.v_dot, rates.u_dot)))
    return replace(states.state(0), v=v, v_dot=v_dot)


def _undeformed(system: System, robot: Robot, path: kinematics.Poses, found: kinematics.LegState, orders: int) -> Array:
    """Coordinates of the undeformed legs on a path of T poses, rates and accelerations, (orders, T, legs, n)."""
    legs, shapes = _as_built(robot), system.kernel.shapes
    x = np.zeros((orders, *found.length.shape, len(COORDINATES)))
    there, at = leg_coordinates(shapes)
    for k in range(len(COORDINATES)) if shapes.has("gamma1") else there:
        for order, values in zip(range(orders), found.coordinate(COORDINATES[k]), strict=False):
            x[order, ..., k] = values
    held = legs.state == HELD  # welds, which the rigid path releases, too
    x[:, :, held] = 0.0
    x[0] += np.where(held, legs.home, 0.0)
    if shapes.has("gamma1"):
        _turn_balls(legs, x, path)
    q = np.zeros((*x.shape[:3], system.n))
    q[..., at] = x[..., there]
    for element in shapes.elements:
        has = [element.of(leg) is not None for leg in robot.legs]
        for name, other in element.follows.items():
            q[..., shapes.index(name)] = np.where(has, q[..., shapes.index(other)], 0.0)
    return q


@once
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
