"""Inverse dynamics of the rigid robot by MuJoCo: trees without closures, and the multipliers that close them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexapod.errors import ComputationError
from flexapod.model import Robot
from flexapod.proof.engines.engine import MUJOCO
from flexapod.proof.engines.mujoco_model import mjcf
from flexapod.rigid import Poses
from flexapod.typing import Array

if TYPE_CHECKING:
    from types import ModuleType
    from typing import Any

__all__ = ["MujocoForces", "inverse_dynamics"]

CLOSED = 1e-13  # m; a few units in the last place of a metre
MOST_ITERATIONS = 30


@dataclass(frozen=True, kw_only=True)
class MujocoForces:
    """Motion and forces along T poses, as MuJoCo finds them; world axes.

    Attributes
    ----------
    leg_length, leg_angle : ndarray, shape (T, 6) and (T, 6, 2)
        Joint to joint [m]; alpha and beta of the universal joints [rad].
    actuator_force : ndarray, shape (T, 6)
        Of the drive on the piston along the leg [N].
    joint_force : ndarray, shape (T, 6, 3)
        Of the legs on the platform [N].
    """

    leg_length: Array
    leg_angle: Array
    actuator_force: Array
    joint_force: Array


def inverse_dynamics(robot: Robot, path: Poses, wrench: Array | None = None) -> MujocoForces:
    """Drive and joint forces that move the rigid robot along a path, computed by MuJoCo.

    `mj_inverse` gives the force that each coordinate of the open chains needs. Two of the three equations of a leg have
    no drive (the universal joint), six are those of the payload: eighteen equations for the eighteen joint forces. The
    third equation of each leg then gives its drive force. The legs' coordinates and rates are found by closing the
    chains with MuJoCo's own Jacobians; of ours only the payload's motion is used.

    Parameters
    ----------
    robot : Robot
    path : Poses
        T poses of the platform frame, with rates and accelerations.
    wrench : ndarray, shape (T, 6) or (6,), optional
        External force and moment at the tool, world axes [N], [N m].

    Returns
    -------
    MujocoForces

    Raises
    ------
    ComputationError
        MuJoCo is not installed, or the chains do not close at a pose.
    """
    chains = _Chains(robot)
    loads = np.broadcast_to(np.zeros(6) if wrench is None else np.asarray(wrench, dtype=float), (len(path), 6))
    rows = [chains.forces(path, t, loads[t]) for t in range(len(path))]
    length, angle, force, joint = (np.array(part) for part in zip(*rows, strict=True))
    return MujocoForces(leg_length=length, leg_angle=angle, actuator_force=force, joint_force=joint)


def _mujoco() -> ModuleType:
    if not MUJOCO.found():
        raise ComputationError("MuJoCo is not installed", next_step=f"Install it: {MUJOCO.install}")
    import mujoco

    return mujoco


class _Chains:
    """Open chains in MuJoCo; coordinates alpha, beta, length of legs 1 to 6, then the payload's."""

    def __init__(self, robot: Robot) -> None:
        self.robot, self.mujoco = robot, _mujoco()
        self.model: Any = self.mujoco.MjModel.from_xml_string(mjcf(robot))
        self.data: Any = self.mujoco.MjData(self.model)
        self.pistons = [self.model.body(f"piston_{i}").id for i in range(1, 7)]
        self.payload = self.model.body("payload").id
        self.legs = np.column_stack([np.zeros((6, 2)), robot.home_lengths]).ravel()

    def forces(self, path: Poses, t: int, load: Array) -> tuple[Array, Array, Array, Array]:
        """Lengths (6,), angles (6, 2), drive forces (6,) and joint forces (6, 3) at pose t."""
        self._move(path, t)
        data, G = self.data, self._closures()
        self.mujoco.mj_inverse(self.model, data)
        needed = data.qfrc_inverse - self._jacobian(self.payload, self._world(self.robot.payload.tool)).T @ load
        loose = np.delete(np.arange(24), np.arange(2, 18, 3))  # no drive: universal joints, payload
        joint = np.linalg.solve(G.T[loose], -needed[loose])
        drive = needed + G.T @ joint
        legs = self.legs.reshape(6, 3)
        return legs[:, 2].copy(), legs[:, :2].copy(), drive[2:18:3], joint.reshape(6, 3)

    def _move(self, path: Poses, t: int) -> None:
        """Set positions, rates and accelerations: the payload's as given, the legs' so that they follow."""
        data, R = self.data, path.rotation[t]
        data.qpos[18:21] = path.position[t]
        self.mujoco.mju_mat2Quat(data.qpos[21:25], np.ascontiguousarray(R).ravel())
        self._close(t)
        rates = np.concatenate([path.velocity[t], R.T @ path.omega[t]])  # turns of a free joint: in its own axes
        pushes = np.concatenate([path.acceleration[t], R.T @ path.alpha[t]])
        G = self._closures()
        data.qvel[18:] = rates
        data.qvel[:18] = np.linalg.solve(G[:, :18], -G[:, 18:] @ rates)
        self.mujoco.mj_fwdVelocity(self.model, data)
        bend = self._closures(rate=True) @ data.qvel
        data.qacc[18:] = pushes
        data.qacc[:18] = np.linalg.solve(G[:, :18], -G[:, 18:] @ pushes - bend)

    def _close(self, t: int) -> None:
        """Newton on the legs' coordinates until their tips meet the payload's joints, from the pose before."""
        gap = np.full(18, np.inf)
        for _ in range(MOST_ITERATIONS):
            self.data.qpos[:18] = self.legs
            self.mujoco.mj_kinematics(self.model, self.data)
            self.mujoco.mj_comPos(self.model, self.data)
            gap = (self.data.xpos[self.pistons] - self._world(self.robot.platform_joints)).ravel()
            if np.abs(gap).max() < CLOSED:
                return
            self.legs = self.legs - np.linalg.solve(self._closures()[:, :18], gap)
        raise ComputationError(
            f"MuJoCo's chains do not close at pose {t + 1}: a gap of {np.abs(gap).max():.2g} m is left",
            next_step="Give poses nearer to one another.",
        )

    def _world(self, points: Array) -> Array:
        """Points of the payload, (..., 3), in world axes."""
        turn = self.data.xmat[self.payload].reshape(3, 3)
        return self.data.xpos[self.payload] + points @ turn.T

    def _closures(self, *, rate: bool = False) -> Array:
        """Jacobian (18, 24) of tips less joints of the payload, or its rate."""
        joints = self._world(self.robot.platform_joints)
        rows = [
            self._jacobian(body, self.data.xpos[body], rate)[:3] - self._jacobian(self.payload, joint, rate)[:3]
            for body, joint in zip(self.pistons, joints, strict=True)
        ]
        return np.concatenate(rows)

    def _jacobian(self, body: int, point: Array, rate: bool = False) -> Array:
        """Velocity of a point and turn of its body, (6, 24), or its rate."""
        place, turn = np.zeros((3, 24)), np.zeros((3, 24))
        of = self.mujoco.mj_jacDot if rate else self.mujoco.mj_jac
        of(self.model, self.data, place, turn, point, body)
        return np.concatenate([place, turn])
