"""Inverse dynamics of the rigid robot by MuJoCo, from its model as MJCF, the text format of MuJoCo.

Legs and payload are open chains, cut at the platform's joints; multipliers close them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.kinematics import COORDINATES, DRIVEN, Poses, rigid_limbs
from flexapod.kinematics.rotations import quaternion
from flexapod.mechanics.elements.registry import refuse_tables
from flexapod.model import Robot
from flexapod.output.exchange.mjcf_trees import LEAST, leg_body, numbers, payload_inertia
from flexapod.verification.engines.engine import MUJOCO

if TYPE_CHECKING:
    from types import ModuleType
    from typing import Any


def mjcf(robot: Robot) -> str:
    """The robot as text for MuJoCo: legs that nothing holds at their ends, and a payload that nothing holds.

    Bodies and joints are those of `exchange.mjcf_trees`; the `payload` is a free body in the platform frame.

    Parameters
    ----------
    robot : Robot

    Returns
    -------
    str
        MJCF in SI; coordinates of leg after leg, then the free joint's seven.

    References
    ----------
    E. Todorov, T. Erez, Y. Tassa, "MuJoCo: a physics engine for model-based control", IROS (2012) 5026-5033.
    """
    refuse_tables(robot.legs, "MuJoCo")
    limbs = kinematics.rigid_limbs(robot)
    pose = f'pos="{numbers(robot.home_position)}" quat="{numbers(quaternion(robot.home_rotation))}"'
    payload = f'<body name="payload" {pose}>\n<freejoint name="payload"/>\n{payload_inertia(robot)}\n</body>'
    return "\n".join([
        f'<mujoco model="{robot.type}">',
        f'<compiler angle="radian" autolimits="false" boundmass="{LEAST}" boundinertia="{LEAST}"/>',
        f'<option gravity="{numbers(robot.gravity)}"><flag contact="disable"/></option>',
        "<worldbody>",
        *(leg_body(robot, limbs, i).text for i in range(robot.count)),
        payload,
        "</worldbody>",
        "</mujoco>",
    ])  # fmt: skip


CLOSED = 1e-13  # m; a few units in the last place of a metre
GIVEN = 1e-10  # m; gap that poses of a guided platform may leave, which are themselves computed
MOST_ITERATIONS = 30
BETA, LENGTH = COORDINATES.index("beta"), COORDINATES.index("l")


@dataclass(frozen=True, kw_only=True)
class MujocoForces:
    """Motion and forces along T poses, as MuJoCo finds them; world axes.

    Attributes
    ----------
    leg_length, leg_angle : ndarray, shape (T, legs) and (T, legs, 2)
        Joint to joint [m]; alpha and beta of the base joints [rad].
    actuator_force : ndarray, shape (T, legs)
        Of the drive on piston or carriage [N], of a crank [N m]; 0 in a passive leg.
    joint_force : ndarray, shape (T, legs, 3)
        Of the legs on the platform [N].
    """

    leg_length: Array
    leg_angle: Array
    actuator_force: Array
    joint_force: Array


def inverse_dynamics(
    robot: Robot, path: Poses, wrench: Array | None = None, *, text: str | None = None
) -> MujocoForces:
    """Drive and joint forces that move the rigid robot along a path, computed by MuJoCo.

    `mj_inverse` gives the force that each coordinate of the open chains needs. Those without a drive, and those of the
    payload, are as many equations as legs and payload exert forces and moments on each other; the others then give the
    drive forces. The legs' coordinates and rates are found by closing the chains with MuJoCo's own Jacobians; of ours
    only the payload's motion is used.

    Parameters
    ----------
    robot : Robot
    path : Poses
        T poses of the platform frame, with rates and accelerations.
    wrench : ndarray, shape (T, 6) or (6,), optional
        External force and moment at the tool, world axes [N], [N m].
    text : str, optional
        The rigid robot as MJCF with the same bodies and joints, in place of ours; what closes its loops is left out.

    Returns
    -------
    MujocoForces

    Raises
    ------
    ComputationError
        MuJoCo is not installed, or the chains do not close at a pose.
    """
    chains = _Chains(robot, mjcf(robot) if text is None else text)
    loads = np.broadcast_to(np.zeros(6) if wrench is None else np.asarray(wrench, dtype=float), (len(path), 6))
    rows = [chains.forces(path, t, loads[t]) for t in range(len(path))]
    length, angle, force, joint = (np.array(part) for part in zip(*rows, strict=True))
    return MujocoForces(leg_length=length, leg_angle=angle, actuator_force=force, joint_force=joint)


def mujoco_module() -> ModuleType:
    """MuJoCo; ComputationError where it is not installed."""
    if not MUJOCO.is_available():
        raise ComputationError("MuJoCo is not installed", next_step=f"Install it: {MUJOCO.install}")
    import mujoco

    return mujoco


class _Chains:
    """Open chains in MuJoCo: coordinates of leg after leg, then the payload's six."""

    def __init__(self, robot: Robot, text: str) -> None:
        self.robot, self.mujoco, self.limbs = robot, mujoco_module(), rigid_limbs(robot)
        self.model: Any = self.mujoco.MjModel.from_xml_string(text)
        self.model.opt.disableflags |= self.mujoco.mjtDisableBit.mjDSBL_EQUALITY
        self.data: Any = self.mujoco.MjData(self.model)
        pose = self.limbs.pose_closure
        ends = [f"{'tip' if posed else 'piston'}_{i}" for i, posed in enumerate(pose, start=1)]
        self.ends, self.payload = [self.model.body(name).id for name in ends], self.model.body("payload").id
        #: Rows of a leg's closure among its six, of all legs.
        self.rows = np.concatenate([6 * i + np.arange(6 if posed else 3) for i, posed in enumerate(pose)])
        moves, home = self.limbs.unknown, self.limbs.home.copy()
        home[:, BETA] = 0.0  # it counts from home
        self.legs, self.place = home[moves], np.full(moves.shape, -1)
        self.place[moves] = range(moves.sum())
        self.driven = self.limbs.state[moves] == DRIVEN
        self.loose = np.append(~self.driven, ~self.limbs.hub_held)

    def forces(self, path: Poses, t: int, load: Array) -> tuple[Array, Array, Array, Array]:
        """Lengths (legs,), angles (legs, 2), drive forces (legs,) and joint forces (legs, 3) at pose t."""
        self._move(path, t)
        data, G, count = self.data, self._closures(), len(self.legs)
        self.mujoco.mj_inverse(self.model, data)
        needed = data.qfrc_inverse - self._jacobian(self.payload, self._world(self.robot.payload.tool)).T @ load
        joint = np.linalg.lstsq(G.T[self.loose], -needed[self.loose])[0]
        force = np.where(self.driven, (needed + G.T @ joint)[:count], 0.0)
        each, home = np.zeros(6 * len(self.limbs)), self.limbs.home
        each[self.rows] = joint
        moving = np.where(self.place < 0, home, self.legs[self.place])
        moving[:, BETA] += np.where(self.place[:, BETA] < 0, 0.0, home[:, BETA])
        drive = np.where(self.place < 0, 0.0, force[self.place]).sum(axis=1)
        return moving[:, LENGTH], moving[:, BETA - 1 : BETA + 1], drive, each.reshape(-1, 6)[:, :3]

    def _move(self, path: Poses, t: int) -> None:
        """Set positions, rates and accelerations: the payload's as given, the legs' so that they follow."""
        data, R, n = self.data, path.rotation[t], len(self.legs)
        data.qpos[n : n + 3] = path.position[t]
        self.mujoco.mju_mat2Quat(data.qpos[n + 3 :], np.ascontiguousarray(R).ravel())
        self._close(t)
        rates = np.concatenate([path.velocity[t], R.T @ path.omega[t]])  # turns of a free joint: in its own axes
        pushes = np.concatenate([path.acceleration[t], R.T @ path.alpha[t]])
        G = self._closures()
        data.qvel[n:] = rates
        data.qvel[:n] = np.linalg.lstsq(G[:, :n], -G[:, n:] @ rates)[0]
        self.mujoco.mj_fwdVelocity(self.model, data)
        bend = self._closures(rate=True) @ data.qvel
        data.qacc[n:] = pushes
        data.qacc[:n] = np.linalg.lstsq(G[:, :n], -G[:, n:] @ pushes - bend)[0]

    def _close(self, t: int) -> None:
        """Newton on the legs' coordinates until their tips meet the payload's joints, from the pose before."""
        gap, n = np.full(len(self.rows), np.inf), len(self.legs)
        for _ in range(MOST_ITERATIONS):
            self.data.qpos[:n] = self.legs
            self.mujoco.mj_kinematics(self.model, self.data)
            self.mujoco.mj_comPos(self.model, self.data)
            gap = self._gaps()
            if not np.isfinite(gap).all():
                break
            step = np.linalg.lstsq(self._closures()[:, :n], gap)[0]
            if np.abs(step).max() < CLOSED and np.abs(gap).max() < GIVEN:
                return
            self.legs = self.legs - step
        raise ComputationError(
            f"MuJoCo's chains do not close at pose {t + 1}: a gap of {np.abs(gap).max():.2g} m is left",
            next_step="Give poses nearer to one another.",
        )

    def _gaps(self) -> Array:
        """Tips less joints of the payload, and half the sine of the turns between their frames, world axes."""
        places = self.data.xpos[self.ends] - self._world(self.robot.platform_joints)
        goal = self.data.xmat[self.payload].reshape(3, 3) @ self.limbs.platform_frames
        turns = np.cross(goal, self.data.xmat[self.ends].reshape(-1, 3, 3), axis=-2).sum(axis=-1) / 2
        return np.concatenate([places, turns], axis=1).ravel()[self.rows]

    def _world(self, points: Array) -> Array:
        """Points of the payload, (..., 3), in world axes."""
        turn = self.data.xmat[self.payload].reshape(3, 3)
        return self.data.xpos[self.payload] + points @ turn.T

    def _closures(self, *, rate: bool = False) -> Array:
        """Jacobian (rows, coordinates) of the ends of the legs less those of the payload, or its rate."""
        joints = self._world(self.robot.platform_joints)
        rows = [
            self._jacobian(body, self.data.xpos[body], rate) - self._jacobian(self.payload, joint, rate)
            for body, joint in zip(self.ends, joints, strict=True)
        ]
        return np.concatenate(rows)[self.rows]

    def _jacobian(self, body: int, point: Array, rate: bool = False) -> Array:
        """Velocity of a point and turn of its body, (6, coordinates), or its rate."""
        place, turn = np.zeros((3, self.model.nv)), np.zeros((3, self.model.nv))
        of = self.mujoco.mj_jacDot if rate else self.mujoco.mj_jac
        of(self.model, self.data, place, turn, point, body)
        return np.concatenate([place, turn])
