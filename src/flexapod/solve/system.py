"""A robot as equations: state, residual and dense matrices, Eqs. (T4.7)-(T4.12)."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from flexapod import rigid
from flexapod.mechanics.layout import COMMAND_SIZE
from flexapod.model import Robot, Simulation
from flexapod.rigid.rotations import quaternion, turned
from flexapod.solve.kernel import Kernel, kernel
from flexapod.solve.parameters import leg_parameters, payload_parameters
from flexapod.solve.shapes import leg_shapes
from flexapod.typing import Array, Mask

Index = NDArray[np.intp]


@dataclass(frozen=True, kw_only=True)
class State:
    """State of a robot with n coordinates a leg.

    ``q``, (6, n): leg coordinates; ``pose``, (7,): CoM [m] and quaternion (w x y z); ``v``, ``v_dot``, (6 n + 6,):
    rates of the legs, then CoM velocity (world) and angular velocity (platform axes); ``lam``, (6, 3): joint forces
    on the platform, world axes [N]; ``drive``, (6,): force of each prescribed drive [N].
    """

    q: Array
    pose: Array
    v: Array
    v_dot: Array
    lam: Array
    drive: Array


@dataclass(frozen=True, kw_only=True)
class Matrices:
    """Dense matrices of the whole robot at a state: M, D, K (N, N) and constraint Jacobian G (18 + strokes, N)."""

    M: Array
    D: Array
    K: Array
    G: Array


@dataclass(frozen=True, kw_only=True)
class RobotSystem:
    """Kernel and parameters of one robot; ``held`` marks the legs whose stroke is prescribed."""

    kernel: Kernel
    leg_p: Array
    payload_p: Array
    held: Mask

    @cached_property
    def n(self) -> int:
        """Coordinates of one leg."""
        return self.kernel.shapes.size

    @cached_property
    def size(self) -> int:
        """Coordinates of the whole robot, 6 n + 6."""
        return 6 * self.n + 6

    @cached_property
    def strokes(self) -> Index:
        """Positions of the prescribed l in the flat coordinates."""
        return np.flatnonzero(self.held) * self.n + self.kernel.shapes.l_index

    def residual(self, x: State, commands: Array, wrench: Array) -> tuple[Array, Array]:
        """Balance of every coordinate (N,) [N, N m] and closures (18,) [m]; command rows (6, 4), see `command`."""
        k = 6 * self.n
        rows, tips = [], []
        for i in range(6):
            part = slice(i * self.n, (i + 1) * self.n)
            r, tip, _ = self.kernel.leg_residual(x.q[i], x.v[part], x.v_dot[part], x.lam[i], commands[i], self.leg_p[i])
            rows.append(r)
            tips.append(tip)
        r, points, _ = self.kernel.payload_residual(x.pose, x.v[k:], x.v_dot[k:], x.lam, wrench, self.payload_p)
        return np.concatenate([*rows, r]), np.concatenate(tips) - points

    def command(self, x: State, l_cmd: Array, rate: Array, force: Array) -> Array:
        """Command rows (6, 4) of the kernels: l_cmd, its rate, feed-forward plus constraint force, no torque."""
        rows = np.zeros((6, COMMAND_SIZE))
        rows[:, 0], rows[:, 1], rows[:, 2] = l_cmd, rate, force + x.drive
        return rows

    def matrices(self, x: State, wrench: Array) -> Matrices:
        """Matrices at rest with geometric stiffness, and the constraint Jacobian of closures and prescribed strokes."""
        n, N = self.n, self.size
        M, D, K = np.zeros((N, N)), np.zeros((N, N)), np.zeros((N, N))
        G = np.zeros((18 + len(self.strokes), N))
        for i in range(6):
            at = slice(i * n, (i + 1) * n)
            M[at, at], D[at, at], K[at, at], G[3 * i : 3 * i + 3, at] = self.kernel.leg_matrices(
                x.q[i], x.lam[i], self.leg_p[i]
            )
        M[6 * n :, 6 * n :], K[6 * n :, 6 * n :], P = self.kernel.payload_matrices(
            x.pose, x.lam, wrench, self.payload_p
        )
        G[:18, 6 * n :] = -P
        G[18 + np.arange(len(self.strokes)), self.strokes] = 1.0
        return Matrices(M=M, D=D, K=K, G=G)

    def moved(self, x: State, step: Array) -> State:
        """State displaced by a step in the flat coordinates: q + dq, x + dx, R exp(theta^)."""
        k = 6 * self.n
        return replace(x, q=x.q + step[:k].reshape(6, self.n), pose=turned(x.pose, step[k:]))


def robot_system(robot: Robot, simulation: Simulation) -> RobotSystem:
    """System of a robot in the fidelity, basis and number of shapes of ``simulation``."""
    axial_modes = simulation.axial_shapes(robot.legs[0].axial_modes)
    return RobotSystem(
        kernel=kernel(leg_shapes(robot, simulation), axial_modes),
        leg_p=leg_parameters(robot),
        payload_p=payload_parameters(robot),
        held=np.array([leg.drive.type == "prescribed" for leg in robot.legs]),
    )


def rigid_state(system: RobotSystem, robot: Robot, path: rigid.Poses) -> State:
    """State of the undeformed robot on the commanded path (one sample), with its rates and accelerations; no forces."""
    legs = rigid.inverse_kinematics(robot, path)
    n, R, com = system.n, path.rotation[0], robot.payload.com
    q, v, v_dot = np.zeros((6, n)), np.zeros((6, n)), np.zeros((6, n))
    q[:, :3] = np.stack([legs.alpha[0], legs.beta[0], legs.length[0]], axis=1)
    v[:, :3] = np.stack([legs.alpha_dot[0], legs.beta_dot[0], legs.rate[0]], axis=1)
    v_dot[:, :3] = np.stack([legs.alpha_ddot[0], legs.beta_ddot[0], legs.accel[0]], axis=1)
    r, w, w_dot = R @ com, path.omega[0], path.alpha[0]
    u = np.concatenate([path.velocity[0] + np.cross(w, r), R.T @ w])
    u_dot = np.concatenate([path.acceleration[0] + np.cross(w_dot, r) + np.cross(w, np.cross(w, r)), R.T @ w_dot])
    return State(
        q=q,
        pose=np.concatenate([path.position[0] + r, quaternion(R)]),
        v=np.concatenate([v.ravel(), u]),
        v_dot=np.concatenate([v_dot.ravel(), u_dot]),
        lam=np.zeros((6, 3)),
        drive=np.zeros(6),
    )
