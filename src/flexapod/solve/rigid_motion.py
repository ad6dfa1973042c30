"""States of the undeformed robot on its rigid path, many at once."""

from __future__ import annotations

import numpy as np

from flexapod import rigid
from flexapod.mechanics.layout import Shapes
from flexapod.model import Robot
from flexapod.rigid.kinematics import LegState
from flexapod.rigid.limbs import COORDINATES
from flexapod.rigid.rotations import quaternion
from flexapod.solve.many import Rates, RestStates
from flexapod.solve.system import Index, System
from flexapod.typing import Array

__all__ = ["leg_coordinates", "rigid_motion", "rigid_rest"]


def leg_coordinates(shapes: Shapes) -> tuple[Index, Index]:
    """Which of `rigid.limbs.COORDINATES` a leg of these shapes has, and where in q."""
    there = [k for k, name in enumerate(COORDINATES) if shapes.has(name)]
    return np.array(there), np.array([shapes.index(COORDINATES[k]) for k in there])


def rigid_motion(system: System, robot: Robot, path: rigid.Poses) -> tuple[RestStates, Rates]:
    """Configurations of the undeformed robot at the instants of a path, without forces, and their rates."""
    legs, T = rigid.inverse_kinematics(robot, path), len(path)
    q, v, v_dot = (_in_q(system, legs, order) for order in range(3))
    R, w, w_dot = path.rotation, path.omega, path.alpha
    arm, inverse = R @ robot.payload.com, R.swapaxes(1, 2)
    turning = np.cross(w, arm)
    velocity, acceleration = path.velocity + turning, path.acceleration + np.cross(w_dot, arm) + np.cross(w, turning)
    states = RestStates(
        q=q,
        pose=np.concatenate([path.position + arm, quaternion(R)], axis=1),
        lam=np.zeros((T, system.legs, system.rows)),
        drive=np.zeros((T, system.legs, system.ports.size)),
    )
    u, u_dot = (
        np.concatenate([linear, (inverse @ angular[..., None])[..., 0]], axis=1)
        for linear, angular in ((velocity, w), (acceleration, w_dot))
    )
    return states, Rates(v=v, v_dot=v_dot, u=u, u_dot=u_dot)


def rigid_rest(system: System, robot: Robot, path: rigid.Poses) -> RestStates:
    """States of the undeformed robot at the poses of a path, without forces."""
    return rigid_motion(system, robot, path)[0]


def _in_q(system: System, legs: LegState, order: int) -> Array:
    """Coordinates (T, legs, n) of the undeformed legs, or their rates (1) or accelerations (2)."""
    suffix = ("", "_dot", "_ddot")[order]
    q = np.zeros((*legs.length.shape, system.n))
    for k, at in zip(*leg_coordinates(system.kernel.shapes), strict=True):
        name = COORDINATES[k]
        if name == "l":
            q[..., at] = (legs.length, legs.rate, legs.accel)[order]
        elif name.startswith("gamma"):
            q[..., at] = getattr(legs, "gamma" + suffix)[..., int(name[-1]) - 1]
        else:
            q[..., at] = getattr(legs, name + suffix)
    return q
