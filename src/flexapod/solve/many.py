"""The robot at rest in many poses at once: states, residuals and matrices with the pose as first axis, Eq. (T7.1)."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from ctypes import c_double, c_long
from dataclasses import dataclass, fields, replace

import numpy as np

from flexapod import rigid
from flexapod.mechanics.layout import COMMAND_SIZE
from flexapod.model import Robot
from flexapod.rigid.rotations import quaternion, turned
from flexapod.solve.kernel import Kernel
from flexapod.solve.system import Index, State, System
from flexapod.typing import Array

__all__ = ["RestMatrices", "RestStates", "evaluate", "matrices_at_rest", "residual_at_rest", "rigid_rest"]

_Pointer = ctypes.POINTER(c_double)


@dataclass(frozen=True, kw_only=True)
class RestStates:
    """P resting states of a robot with n coordinates a leg; the parts of `system.State` that are not zero at rest.

    ``q`` (P, legs, n); ``pose`` (P, 7): CoM [m] and quaternion; ``lam`` (P, legs, rows): closure forces on the platform
    [N]; ``drive`` (P, legs, ports): forces that hold coordinates [N, N m].
    """

    q: Array
    pose: Array
    lam: Array
    drive: Array

    def __len__(self) -> int:
        return len(self.q)

    def __getitem__(self, chosen: Index | slice) -> RestStates:
        """Some of the states."""
        return RestStates(**{f.name: getattr(self, f.name)[chosen] for f in fields(self)})

    def with_(self, chosen: Index, part: RestStates) -> RestStates:
        """Return the states with some of them replaced."""
        new = {f.name: getattr(self, f.name).copy() for f in fields(self)}
        for name, values in new.items():
            values[chosen] = getattr(part, name)
        return RestStates(**new)

    def moved(self, dq: Array, step: Array) -> RestStates:
        """States displaced by dq (P, 6, n) and payload steps (P, 6): q + dq, x + dx, R exp(theta^), Eq. (T4.3)."""
        return replace(self, q=self.q + dq, pose=turned(self.pose, step))

    def state(self, k: int) -> State:
        """One of them as the state of a robot."""
        size = self.q[k].size + 6
        return State(
            q=self.q[k], pose=self.pose[k], v=np.zeros(size), v_dot=np.zeros(size), lam=self.lam[k], drive=self.drive[k]
        )

    @classmethod
    def of(cls, x: State) -> RestStates:
        """One state brought to rest."""
        return cls(q=x.q[None], pose=x.pose[None], lam=x.lam[None], drive=x.drive[None])


@dataclass(frozen=True, kw_only=True)
class RestMatrices:
    """Matrices of P resting states.

    ``M``, ``D``, ``K`` (P, 6, n, n) and ``J`` (P, 6, 3, n), tip Jacobian, of the legs; ``payload_M``, ``payload_K``
    (P, 6, 6) and ``P`` (P, 6, 3, 6), Jacobian of the joints' points, of the payload.
    """

    M: Array
    D: Array
    K: Array
    J: Array
    payload_M: Array
    payload_K: Array
    P: Array


def rigid_rest(system: System, robot: Robot, path: rigid.Poses) -> RestStates:
    """States of the undeformed robot at the poses of a path, without forces; see `system.rigid_state`."""
    legs, P = rigid.inverse_kinematics(robot, path), len(path)
    q = np.zeros((P, system.legs, system.n))
    q[:, :, :3] = np.stack([legs.alpha, legs.beta, legs.length], axis=-1)
    com = path.position + path.rotation @ robot.payload.com
    pose = np.concatenate([com, quaternion(path.rotation)], axis=1)
    lam, drive = np.zeros((P, system.legs, system.rows)), np.zeros((P, system.legs, system.ports.size))
    return RestStates(q=q, pose=pose, lam=lam, drive=drive)


def residual_at_rest(
    system: System, x: RestStates, l_cmd: Array, force: Array, wrench: Array
) -> tuple[Array, Array, Array]:
    """Balance of the legs (P, 6, n) and of the payload (P, 6) [N, N m], closures (P, 6, 3) [m], at rest.

    ``l_cmd``, ``force`` (P, 6): commanded lengths [m] and feed-forward drive forces [N]; ``wrench`` (6,) at the tool.
    """
    P, n = len(x), system.n
    legs, kernel = system.legs, system.kernel
    commands = np.zeros((P, legs, COMMAND_SIZE))
    commands[:, :, 0] = l_cmd
    still, shapes = np.zeros(n), [(n,), (3,), (2,), (1,)]
    arguments = [x.q, still, still, x.lam, commands, system.leg_p]
    r, tip, _, _ = evaluate(kernel, "leg_residual", legs * P, arguments, [n, n, n, 3, COMMAND_SIZE, None], shapes)
    r = r.reshape(P, legs, n)
    r[:, :, system.ports] -= x.drive
    r[:, :, kernel.shapes.l_index] -= force
    points, wrenches = evaluate(kernel, "joint_residual", legs * P, *_joints(system, x), [(3,), (6,)])
    net = wrenches.reshape(P, legs, 6).sum(axis=1)
    arguments = [x.pose, np.zeros(6), np.zeros(6), net, wrench, system.payload_p]
    payload, _ = evaluate(kernel, "payload_residual", P, arguments, [7, 6, 6, 6, 6, None], [(6,), (1,)])
    return r, payload, (tip - points).reshape(P, legs, 3)


def _joints(system: System, x: RestStates) -> tuple[list[Array], list[int | None]]:
    """Inputs of the joints' functions and their sizes, leg by leg of each state."""
    return [np.repeat(x.pose, system.legs, axis=0), x.lam, system.joint_p], [7, 3, None]


def matrices_at_rest(system: System, x: RestStates, wrench: Array) -> RestMatrices:
    """Matrices with geometric stiffness; see `System.matrices`."""
    P, n, legs, kernel = len(x), system.n, system.legs, system.kernel
    arguments, shapes = [x.q, x.lam, system.leg_p], [(n, n)] * 3 + [(3, n)]
    of_legs = evaluate(kernel, "leg_matrices", legs * P, arguments, [n, 3, None], shapes)
    M, D, K, J = (part.reshape(P, legs, *part.shape[1:]) for part in of_legs)
    points, turned_forces = (
        part.reshape(P, legs, *part.shape[1:])
        for part in evaluate(kernel, "joint_matrices", legs * P, *_joints(system, x), [(3, 6), (6, 6)])
    )
    arguments = [x.pose, wrench, system.payload_p]
    payload_M, payload_K = evaluate(kernel, "payload_matrices", P, arguments, [7, 6, None], [(6, 6), (6, 6)])
    payload_K = payload_K + turned_forces.sum(axis=1)
    return RestMatrices(M=M, D=D, K=K, J=J, payload_M=payload_M, payload_K=payload_K, P=points)


def evaluate(
    kernel: Kernel,
    name: str,
    count: int,
    inputs: Sequence[Array],
    sizes: Sequence[int | None],
    shapes: Sequence[tuple[int, ...]],
) -> list[Array]:
    """A kernel function for ``count`` items at once.

    Parameters
    ----------
    kernel : Kernel
    name : str
        One of `kernel.NAMES`.
    count : int
    inputs : sequence of ndarray
        Rows of each input one below the other; with fewer rows than items they repeat.
    sizes : sequence of int or None
        Length of a row; None: that of the last axis.
    shapes : sequence of tuple
        Of each output of one item.

    Returns
    -------
    list of ndarray, each shape (count, *shape)
    """
    rows = [
        np.ascontiguousarray(x, dtype=float).reshape(-1, size or x.shape[-1])
        for x, size in zip(inputs, sizes, strict=True)
    ]
    if kernel.library is None:
        return _one_by_one(kernel, name, count, rows, shapes)
    out = [np.zeros((count, *shape[::-1])) for shape in shapes]  # the kernels write column by column
    _call(kernel.library, name, count, rows, out)
    return [x.swapaxes(1, 2) if x.ndim == 3 else x for x in out]


def _one_by_one(
    kernel: Kernel, name: str, count: int, rows: list[Array], shapes: Sequence[tuple[int, ...]]
) -> list[Array]:
    function = getattr(kernel, name)
    found = [function(*(x[i % len(x)] for x in rows)) for i in range(count)]
    return [
        np.array([values[k] for values in found], dtype=float).reshape(count, *shape) for k, shape in enumerate(shapes)
    ]


def _call(library: ctypes.CDLL, name: str, count: int, rows: list[Array], out: list[Array]) -> None:
    getattr(library, name)(
        c_long(count),
        (_Pointer * len(rows))(*[x.ctypes.data_as(_Pointer) for x in rows]),
        (c_long * len(rows))(*[len(x) for x in rows]),
        (_Pointer * len(out))(*[x.ctypes.data_as(_Pointer) for x in out]),
    )
