"""A robot in many states at once: residuals and matrices with the pose as first axis, Eqs. (T4.7)-(T4.8), (T7.1)."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from flexapod.common.arrays import Array, Index
from flexapod.kinematics.rotations import displace_pose
from flexapod.solve.kernel import evaluate
from flexapod.solve.system import State, System


@dataclass(frozen=True, kw_only=True)
class RestStates:
    """P resting states of a robot; the parts of `system.State` that are not zero at rest.

    ``q`` (P, legs, n); ``pose`` (P, 7): CoM [m] and quaternion; ``lam`` (P, legs, rows): what the closures take;
    ``drive`` (P, legs, ports): force of each held coordinate [N] or [N m].
    """

    q: Array
    pose: Array
    lam: Array
    drive: Array

    def __len__(self) -> int:
        return len(self.q)

    def __getitem__(self, chosen: Index | slice) -> RestStates:
        """Select some of the states."""
        return RestStates(**{f.name: getattr(self, f.name)[chosen] for f in fields(self)})

    def replace_states(self, chosen: Index, part: RestStates) -> RestStates:
        """Return the states with some of them replaced."""
        new = {f.name: getattr(self, f.name).copy() for f in fields(self)}
        for name, values in new.items():
            values[chosen] = getattr(part, name)
        return RestStates(**new)

    def displace(self, dq: Array, step: Array) -> RestStates:
        """States displaced by dq (P, legs, n) and payload steps (P, 6): q + dq, x + dx, R exp(theta^), Eq. (T4.3)."""
        return replace(self, q=self.q + dq, pose=displace_pose(self.pose, step) if step.size else self.pose)

    def state(self, k: int) -> State:
        """One of them as the state of a robot."""
        size = self.q[k].size + (6 if self.pose.size else 0)
        return State(
            q=self.q[k], pose=self.pose[k], v=np.zeros(size), v_dot=np.zeros(size), lam=self.lam[k], drive=self.drive[k]
        )

    @classmethod
    def from_state(cls, x: State) -> RestStates:
        """One state brought to rest."""
        return cls(q=x.q[None], pose=x.pose[None], lam=x.lam[None], drive=x.drive[None])


@dataclass(frozen=True, kw_only=True)
class RestMatrices:
    """Matrices of P resting states.

    ``M``, ``D``, ``K`` (P, legs, n, n) and ``J`` (P, legs, rows, n) of the legs; ``payload_M``, ``payload_K``
    (P, 6, 6) of the payload, with what turning the joint forces adds, followed by the coordinates that legs share;
    ``P`` (P, legs, rows, 6): what moves with the payload of each closure; ``X`` (P, legs, n, 6): second derivatives of
    closures that know the payload's pose, None of others.
    """

    M: Array
    D: Array
    K: Array
    J: Array
    payload_M: Array
    payload_K: Array
    P: Array
    X: Array | None

    def __getitem__(self, chosen: Index) -> RestMatrices:
        """Select some of the states."""
        parts = {f.name: getattr(self, f.name)[chosen] for f in fields(self) if f.name != "X"}
        return RestMatrices(**parts, X=None if self.X is None else self.X[chosen])


def residual_at_rest(
    system: System, x: RestStates, command: Array, force: Array, wrench: Array
) -> tuple[Array, Array, Array]:
    """Balance of the legs (P, legs, n) and of the payload (P, 6) [N, N m], closures (P, legs, rows) [m], at rest.

    ``command``, ``force`` (P, legs, ports): what springs of the drives are to reach, and feed-forward forces;
    ``wrench`` (6,) at the tool.
    """
    r, payload, g = residual(system, x, command, np.zeros(command.shape), wrench)
    r[..., system.ports] -= force + x.drive
    return r, payload, g


@dataclass(frozen=True, kw_only=True)
class Rates:
    """Motion of P states: ``v``, ``v_dot`` (P, legs, n) of the legs, ``u``, ``u_dot`` (P, 6) of the payload."""

    v: Array
    v_dot: Array
    u: Array
    u_dot: Array

    def __getitem__(self, chosen: Index | slice) -> Rates:
        """Select some of the states."""
        return Rates(**{f.name: getattr(self, f.name)[chosen] for f in fields(self)})


def residual(
    system: System, x: RestStates, command: Array, rate: Array, wrench: Array, rates: Rates | None = None
) -> tuple[Array, Array, Array]:
    """Balance of legs and payload without the forces of drives and of what is held, and closures; at rest or not.

    ``command``, ``rate`` (P, legs, ports): what springs of the drives follow; ``wrench`` (6,) or (P, 6).
    """
    P, legs, shapes = len(x), system.legs, system.kernel.shapes
    pose = x.pose.repeat(legs, axis=0)
    at = rates or Rates(v=np.zeros(system.n), v_dot=np.zeros(system.n), u=np.zeros(6), u_dot=np.zeros(6))
    count = shapes.commands
    springs = np.empty((*command.shape[:-1], count))
    springs[..., ::2], springs[..., 1::2] = command[..., : count // 2], rate[..., : count // 2]
    around = _around(system, pose, wrench)
    arguments, drive = [x.q, at.v, at.v_dot, x.lam, springs, system.leg_p, *around], (count // 2,)
    net = np.zeros((legs * P, 6))
    if shapes.reads_pose:
        outputs = [(system.n,), (system.rows,), (6,), (2,), drive]
        r, g, net, *_ = evaluate(system.kernel, "leg_residual", legs * P, arguments, outputs)
    else:
        r, g, *_ = evaluate(
            system.kernel,
            "leg_residual",
            legs * P,
            arguments,
            [(system.n,), (3,), (2 + shapes.has_tip_load,), drive],
        )
    if shapes.rows and not shapes.reads_pose:
        points, net = evaluate(system.kernel, "joint_residual", legs * P, [pose, x.lam, system.joint_p], [(3,), (6,)])
        g = g - points
    payload = np.zeros((P, 0))
    if system.hub:
        arguments = [x.pose, at.u, at.u_dot, net.reshape(P, legs, 6).sum(axis=1), wrench, system.payload_p]
        arguments += [_of_plate(system, y) for y in (x.q, at.v, at.v_dot)] if shapes.plate else []
        payload, _ = evaluate(system.kernel, "payload_residual", P, arguments, [(6 + shapes.plate,), (1,)])
    r = r.reshape(P, legs, system.n)
    if shapes.plate:
        r[:, 0, system.plate] += payload[:, 6:]
        payload = payload[:, :6]
    return r, payload, g[:, : system.rows].reshape(P, legs, system.rows)


def _of_plate(system: System, values: Array) -> Array:
    """Values of the plate below the payload (P or 1, 6), out of those of legs (P or 1, legs, n)."""
    return values[:, 0, system.plate] if values.ndim == 3 else values[None, system.plate]


def _around(system: System, pose: Array, wrench: Array) -> list[Array]:
    """External arguments of each leg's functions: the payload's pose, or a load on a tip without payload."""
    shapes = system.kernel.shapes
    if shapes.has_tip_load:
        return [np.repeat(np.atleast_2d(wrench), system.legs, axis=0)]
    return [pose] if shapes.reads_pose else []


def port_forces(system: System, x: RestStates, command: Array, force: Array) -> Array:
    """Whole force of each port at rest, (P, legs, ports): what holds it, feed-forward and spring of the drive."""
    springs = system.spring_commands(np.stack([command, np.zeros_like(command)], axis=-1))
    arguments, width = [x.q, np.zeros(system.n), springs, system.leg_p], springs.shape[-1] // 2
    _, drive = evaluate(system.kernel, "leg_energies", len(x) * system.legs, arguments, [(3,), (width,)])
    found = force + x.drive
    found[..., :width] += drive.reshape(len(x), system.legs, width)
    return found


def matrices_at_rest(system: System, x: RestStates, wrench: Array) -> RestMatrices:
    """Matrices with geometric stiffness; see `System.matrices`."""
    P, legs, n, rows = len(x), system.legs, system.n, system.rows
    pose = x.pose.repeat(legs, axis=0)
    arguments, outputs = [x.q, x.lam, system.leg_p, *_around(system, pose, wrench)], [(n, n)] * 3 + [(rows, n)]
    moving, H, X = np.zeros((legs * P, rows, 0)), np.zeros((legs * P, 0, 0)), None
    if system.kernel.shapes.reads_pose:
        outputs += [(rows, 6), (6, 6), (n, 6)]
        M, D, K, J, moving, H, X = evaluate(system.kernel, "leg_matrices", legs * P, arguments, outputs)
        X = X.reshape(P, legs, n, 6)
    else:
        M, D, K, J = evaluate(system.kernel, "leg_matrices", legs * P, arguments, outputs)
    if system.kernel.shapes.rows and not system.kernel.shapes.reads_pose:
        joints = [pose, x.lam, system.joint_p]
        moving, H = evaluate(system.kernel, "joint_matrices", legs * P, joints, [(3, 6), (6, 6)])
    hub, plate = 6 if system.hub else 0, system.kernel.shapes.plate
    border = hub + system.shared_coordinates.size
    payload_M, payload_K = np.zeros((P, border, border)), np.zeros((P, border, border))
    if system.hub:
        arguments = [x.pose, wrench, system.payload_p, *([_of_plate(system, x.q)] if plate else [])]
        found = evaluate(system.kernel, "payload_matrices", P, arguments, [(6 + plate, 6 + plate)] * 2)
        payload_M[:, : 6 + plate, : 6 + plate], payload_K[:, : 6 + plate, : 6 + plate] = found
        payload_K[:, :6, :6] += H.reshape(P, legs, 6, 6).sum(axis=1)
    M, D, K, J = (part.reshape(P, legs, *part.shape[1:]) for part in (M, D, K, J))
    return RestMatrices(
        M=M, D=D, K=K, J=J, payload_M=payload_M, payload_K=payload_K, P=moving.reshape(P, legs, rows, hub), X=X,
    )  # fmt: skip


def tips(system: System, q: Array) -> Array:
    """Tips of legs that carry no payload, in the world, of coordinates (P, legs, n): (P, legs, 3) [m]."""
    n, none = np.zeros(system.n), np.zeros(0)
    outside = [np.zeros(system.load_size)] if system.kernel.shapes.has_tip_load else []
    springs = np.zeros(system.kernel.shapes.commands)
    count, outputs = q.shape[0] * system.legs, [(system.n,), (3,), (2 + system.kernel.shapes.has_tip_load,)]
    inputs = [q, n, n, none, springs, system.leg_p, *outside]
    found = evaluate(system.kernel, "leg_residual", count, inputs, [*outputs, (springs.size // 2,)])
    return found[1].reshape(*q.shape[:-1], 3)
