"""A robot as equations: state, residual and dense matrices, Eqs. (T4.7)-(T4.12)."""

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from flexapod import rigid
from flexapod.mechanics.layout import COMMAND_SIZE, LEG_PARAMETERS, columns
from flexapod.model import Robot, Simulation
from flexapod.rigid.rotations import quaternion, turned
from flexapod.solve.kernel import Kernel, kernel
from flexapod.solve.parameters import joint_parameters, leg_parameters, payload_parameters
from flexapod.solve.shapes import leg_shapes
from flexapod.typing import Array, Mask

__all__ = ["COLUMNS", "Flow", "Index", "Matrices", "State", "System", "rigid_state", "robot_system"]

Index = NDArray[np.intp]
COLUMNS = 4  # of a port in a table: value, rate, acceleration, force


@dataclass(frozen=True, kw_only=True)
class State:
    """State of a robot with n coordinates a leg, or of a leg alone.

    ``q``, (legs, n): leg coordinates; ``pose``, (7,): CoM [m] and quaternion (w x y z); ``v``, ``v_dot``, (size,):
    rates of the legs, then CoM velocity (world) and angular velocity (platform axes); ``lam``, (legs, rows): closure
    forces on the platform, world axes [N]; ``drive``, (legs, ports): forces that hold coordinates [N, N m], zero where
    nothing is held.
    """

    q: Array
    pose: Array
    v: Array
    v_dot: Array
    lam: Array
    drive: Array


@dataclass(frozen=True, kw_only=True)
class Flow(State):
    """A state and what the time integration remembers with it.

    ``a``, (size,): auxiliary acceleration; ``sums``, (3,): dissipated energy, work of drives, work of the wrench [J];
    ``powers``, (3,): their rates.
    """

    a: Array
    sums: Array = field(default_factory=lambda: np.zeros(3))
    powers: Array = field(default_factory=lambda: np.zeros(3))

    def copy(self) -> "Flow":
        """Independent copy."""
        return replace(self, **{name: getattr(self, name).copy() for name in self.__dataclass_fields__})


@dataclass(frozen=True, kw_only=True)
class Matrices:
    """Dense matrices at a state: M, D, K (size, size) and the closures' Jacobian G (legs * rows, size)."""

    M: Array
    D: Array
    K: Array
    G: Array


@dataclass(frozen=True, kw_only=True)
class System:
    """Kernel and parameters of one robot, or of one leg alone.

    ``leg_p``, (legs, any): parameters of the legs; ``joint_p``, (legs, 3 or 0): their joints on the platform, from the
    CoM; ``payload_p``: none (size 0) for a leg alone; ``held``, (legs, n): coordinates that follow their table;
    ``hub_held``, (6,): coordinates of the payload that stay what they are.
    """

    kernel: Kernel
    leg_p: Array
    joint_p: Array
    payload_p: Array
    held: Mask
    hub_held: Mask = field(default_factory=lambda: np.zeros(6, dtype=bool))

    @property
    def legs(self) -> int:
        """Number of legs."""
        return len(self.leg_p)

    @property
    def n(self) -> int:
        """Coordinates of one leg."""
        return self.kernel.shapes.size

    @property
    def rows(self) -> int:
        """Equations that close one leg."""
        return self.kernel.shapes.rows

    @property
    def hub(self) -> bool:
        """Whether the legs carry a payload."""
        return self.payload_p.size > 0

    @property
    def size(self) -> int:
        """Coordinates of the whole: legs * n, and six of the payload."""
        return self.legs * self.n + 6 * self.hub

    @cached_property
    def hub_free(self) -> Index:
        """Coordinates of the payload that nothing holds."""
        return np.flatnonzero(~self.hub_held[: 6 * self.hub])

    @cached_property
    def ports(self) -> Index:
        """Coordinates that follow a table in some leg, or are pushed by it: those with a drive's spring first."""
        shapes = self.kernel.shapes
        driven = [shapes.l_index, *([shapes.index("beta")] if shapes.planar else [])]
        return np.array([*driven, *(k for k in np.flatnonzero(self.held.any(axis=0)) if k not in driven)])

    @cached_property
    def fixed(self) -> Mask:
        """Mask (size,) of the coordinates that do not follow from the equations of motion."""
        return np.concatenate([self.held.ravel(), self.hub_held[: 6 * self.hub]])

    @cached_property
    def force_floor(self) -> float:
        """Rounding of the stiffest spring's force [N]: what a residual cannot fall below at lengths of a metre."""
        EA, Lp, drive = (self.leg_p[:, columns(LEG_PARAMETERS, name)] for name in ("EA", "Lp", "drive_stiffness"))
        stretch = EA / Lp * (self.kernel.shapes.axial.count > 0)
        return float(8 * np.finfo(float).eps * np.maximum(stretch, drive).max())

    def by_leg(self, vector: Array) -> Array:
        """Part of the legs of a flat vector, (legs, n)."""
        return vector[: self.legs * self.n].reshape(self.legs, self.n)

    def residual(self, x: State, table: Array, wrench: Array) -> tuple[Array, Array, Array]:
        """Balance of every coordinate (size,) [N, N m], closures (legs * rows,) [m], powers (3,) [W].

        ``table``, (legs, ports, 4): value, rate, acceleration and force of each port. What holds a coordinate of the
        payload is left in its row.
        """
        v, v_dot, force = self.by_leg(x.v), self.by_leg(x.v_dot), table[:, :, 3] + x.drive
        r, gaps, net, powers = np.zeros_like(v), np.zeros((self.legs, self.rows)), np.zeros(6), np.zeros(3)
        for i, (command, p) in enumerate(zip(spring_commands(table), self.leg_p, strict=True)):
            r[i], tip, power, _ = self.kernel.leg_residual(x.q[i], v[i], v_dot[i], x.lam[i], command, p)
            powers[:2] += power
            if self.hub:
                point, wrench_of_leg = self.kernel.joint_residual(x.pose, x.lam[i], self.joint_p[i])
                gaps[i], net = tip - point, net + wrench_of_leg
        r[:, self.ports] -= force
        powers[1] += (force * v[:, self.ports]).sum()
        if not self.hub:
            return r.ravel(), gaps.ravel(), powers
        u, u_dot = x.v[r.size :], x.v_dot[r.size :]
        rest, powers[2:] = self.kernel.payload_residual(x.pose, u, u_dot, net, wrench, self.payload_p)
        return np.concatenate([r.ravel(), rest]), gaps.ravel(), powers

    def matrices(self, x: State, wrench: Array) -> Matrices:
        """Matrices at rest with geometric stiffness, and the Jacobian of the closures."""
        n, k, rows = self.n, self.legs * self.n, self.rows
        M, D, K = (np.zeros((self.size, self.size)) for _ in range(3))
        G = np.zeros((self.legs * rows, self.size))
        for i in range(self.legs):
            at, closed = slice(i * n, (i + 1) * n), slice(i * rows, (i + 1) * rows)
            M[at, at], D[at, at], K[at, at], G[closed, at] = self.kernel.leg_matrices(x.q[i], x.lam[i], self.leg_p[i])
            if self.hub:
                P, H = self.kernel.joint_matrices(x.pose, x.lam[i], self.joint_p[i])
                G[closed, k:] = -P
                K[k:, k:] += H
        if self.hub:
            mass, stiffness = self.kernel.payload_matrices(x.pose, wrench, self.payload_p)
            M[k:, k:] += mass
            K[k:, k:] += stiffness
        return Matrices(M=M, D=D, K=K, G=G)

    def energies(self, x: State, table: Array) -> tuple[Array, Array]:
        """Energies (3,) [J], kinetic, of gravity and of strain; whole force of each port (legs, ports), Eq. (T8.8)."""
        v, force, energy = self.by_leg(x.v), table[:, :, 3] + x.drive, np.zeros(3)
        for i, (command, p) in enumerate(zip(spring_commands(table), self.leg_p, strict=True)):
            part, spring = self.kernel.leg_energies(x.q[i], v[i], command, p)
            energy += part
            force[i, : spring.size] += spring
        if self.hub:
            energy += self.kernel.payload_energies(x.pose, x.v[v.size :], self.payload_p)[0]
        return energy, force

    def moved(self, x: State, step: Array) -> State:
        """State displaced by a step in the flat coordinates: q + dq, x + dx, R exp(theta^)."""
        pose = turned(x.pose, step[self.legs * self.n :]) if self.hub else x.pose
        return replace(x, q=x.q + self.by_leg(step), pose=pose)


def spring_commands(table: Array) -> Array:
    """Value and rate that the drives' springs follow, (..., legs, 2 each), of a table (..., legs, ports, any)."""
    return table[..., : COMMAND_SIZE // 2, :2].reshape(*table.shape[:-2], COMMAND_SIZE)


def robot_system(robot: Robot, simulation: Simulation) -> System:
    """System of a robot in the fidelity, basis and number of shapes of ``simulation``."""
    functions = kernel(leg_shapes(robot, simulation), simulation.axial_shapes(robot.legs[0].axial_modes))
    held = np.zeros((len(robot.legs), functions.shapes.size), dtype=bool)
    held[:, functions.shapes.l_index] = [leg.drive.type == "prescribed" for leg in robot.legs]
    return System(
        kernel=functions,
        leg_p=leg_parameters(robot),
        joint_p=joint_parameters(robot),
        payload_p=payload_parameters(robot),
        held=held,
    )


def rigid_state(system: System, robot: Robot, path: rigid.Poses) -> State:
    """State of the undeformed robot on the commanded path (one sample), with its rates and accelerations; no forces."""
    legs = rigid.inverse_kinematics(robot, path)
    R, com, parts = path.rotation[0], robot.payload.com, []
    for angles, length in (("alpha", "length"), ("alpha_dot", "rate"), ("alpha_ddot", "accel")):
        part = np.zeros((system.legs, system.n))
        beta = angles.replace("alpha", "beta")
        part[:, :3] = np.stack([getattr(legs, name)[0] for name in (angles, beta, length)], axis=1)
        parts.append(part)
    q, v, v_dot = parts
    r, w, w_dot = R @ com, path.omega[0], path.alpha[0]
    u = np.concatenate([path.velocity[0] + np.cross(w, r), R.T @ w])
    u_dot = np.concatenate([path.acceleration[0] + np.cross(w_dot, r) + np.cross(w, np.cross(w, r)), R.T @ w_dot])
    return State(
        q=q,
        pose=np.concatenate([path.position[0] + r, quaternion(R)]),
        v=np.concatenate([v.ravel(), u]),
        v_dot=np.concatenate([v_dot.ravel(), u_dot]),
        lam=np.zeros((system.legs, system.rows)),
        drive=np.zeros((system.legs, system.ports.size)),
    )
