"""A robot as equations: state, residual and dense matrices, Eqs. (T4.7)-(T4.12)."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from flexapod.common.arrays import Array, Index, Mask
from flexapod.kinematics.rotations import displace_pose
from flexapod.mechanics.leg.layout import LOAD_SIZE, columns, leg_parameters
from flexapod.solve.kernel import Kernel, evaluate

ENDS = ("base", "platform")
COLUMNS = 4  # of a port in a table: value, rate, acceleration, force


@dataclass(frozen=True, kw_only=True)
class State:
    """State of a robot with n coordinates a leg, or of a leg alone.

    ``q``, (legs, n): leg coordinates; ``pose``, (7,): CoM [m] and quaternion (w x y z); ``v``, ``v_dot``, (size,):
    rates of the legs, then CoM velocity (world) and angular velocity (platform axes); ``lam``, (legs, rows): closure
    forces on the platform, world axes [N]; ``drive``, (legs, ports): forces that hold coordinates [N, N m], zero where
    nothing is held; ``bristles``, (legs, 2 each): how far they are bent, and how fast what they are at slides.
    """

    q: Array
    pose: Array
    v: Array
    v_dot: Array
    lam: Array
    drive: Array
    bristles: Array = field(default_factory=lambda: np.zeros((0, 0)))


@dataclass(frozen=True, kw_only=True)
class Flow(State):
    """A state and what the time integration remembers with it.

    ``a``, (size,): auxiliary acceleration; ``sums``, (4,): dissipated energy, works of drives, of the wrench and
    on the base [J]; ``powers``, (4,): their rates; ``loop``, (any,): what a sampled controller remembers.
    """

    a: Array
    sums: Array = field(default_factory=lambda: np.zeros(4))
    powers: Array = field(default_factory=lambda: np.zeros(4))
    loop: Array = field(default_factory=lambda: np.zeros(0))

    def copy(self) -> "Flow":
        """Independent copy."""
        return Flow(**{name: getattr(self, name).copy() for name in self.__dataclass_fields__})


@dataclass(frozen=True, kw_only=True)
class Matrices:
    """Dense matrices at a state: M, D, K (size, size) and the closures' Jacobian G (legs * rows, size)."""

    M: Array
    D: Array
    K: Array
    G: Array


class Friction(NamedTuple):
    """Friction of the legs.

    ``r`` (legs, n): on their coordinates; ``state`` (legs, 2 bristles): bristles and rates of sliding; ``force``,
    ``rate`` (legs, bristles) of each; ``energies`` (legs, 2): power lost and stored [W], and what bristles store [J].
    """

    r: Array
    state: Array
    force: Array
    rate: Array
    energies: Array


@dataclass(frozen=True, kw_only=True)
class System:
    """Kernel and parameters of one robot, or of one leg alone.

    ``leg_p``, (legs, any): parameters of the legs; ``joint_p``, (legs, 3 or 0): their joints on the platform, from the
    CoM; ``payload_p``: none (size 0) for a leg alone; ``held``, (legs, n): coordinates that follow their table;
    ``hub_held``, (6,): coordinates of the payload that stay what they are; ``slack``, (legs, n): held coordinates that
    the closures determine anyway, see `redundant.independent`; ``substitutes``, (legs, n): which coordinate stands for
    each held pivot in statics, as `reduction.flat_columns` counts, -1 for none, see `substitutes.with_substitutes`.
    """

    kernel: Kernel
    leg_p: Array
    joint_p: Array
    payload_p: Array
    held: Mask
    hub_held: Mask = field(default_factory=lambda: np.zeros(6, dtype=bool))
    slack: Mask | None = None
    substitutes: Index = field(default_factory=lambda: np.zeros((0, 0), dtype=np.intp))

    @property
    def legs(self) -> int:
        """Number of legs."""
        return len(self.leg_p)

    @cached_property
    def n(self) -> int:
        """Coordinates of one leg."""
        return self.kernel.shapes.size

    @property
    def rows(self) -> int:
        """Equations that close one leg."""
        return self.kernel.shapes.rows

    @property
    def hub(self) -> bool:
        """True where the legs carry a payload."""
        return self.payload_p.size > 0

    @property
    def size(self) -> int:
        """Coordinates of the whole: legs * n, and six of the payload."""
        return self.legs * self.n + 6 * self.hub

    @property
    def load_size(self) -> int:
        """Numbers of a load: a wrench on the payload, or what `layout.LOAD_SIZE` counts on a tip without payload."""
        return 6 if self.hub else LOAD_SIZE

    @cached_property
    def floor(self) -> Mask:
        """Ports that move the base."""
        shapes = self.kernel.shapes
        return self.ports >= (shapes.index("g") if shapes.has("g") else self.n)

    @cached_property
    def shared_coordinates(self) -> Index:
        """Coordinates of a leg that are one coordinate of all legs, those that the payload's functions know first."""
        return np.array(self.kernel.shapes.shared_coordinates, dtype=np.intp)

    @cached_property
    def border(self) -> Index:
        """Coordinates onto which legs are eliminated, of the payload (0 to 5) and shared (6 on): the free ones."""
        return np.append(self.hub_free, 6 + np.arange(self.shared_coordinates.size)).astype(np.intp)

    @property
    def plate(self) -> Index:
        """Shared coordinates that the payload's functions read."""
        return self.shared_coordinates[: self.kernel.shapes.plate]

    @cached_property
    def tie(self) -> Array | None:
        """Flat coordinates by those that are not copies, (size, any); None where legs share nothing."""
        if not self.shared_coordinates.size:
            return None
        copies = (np.arange(1, self.legs)[:, None] * self.n + self.shared_coordinates).ravel()
        tie = np.eye(self.size)
        for i in range(1, self.legs):
            tie[i * self.n + self.shared_coordinates, self.shared_coordinates] = 1.0
        return np.delete(tie, copies, axis=1)

    @cached_property
    def independent(self) -> Array | None:
        """Columns of `tie` that are not in `fixed_mask`; None where legs share nothing."""
        return None if self.tie is None else self.tie[:, ~self.fixed_mask[self.tie.argmax(axis=0)]]

    @cached_property
    def kinds(self) -> list[tuple[Index, Mask, Index]]:
        """Legs that hold the same coordinates: which, what they hold, and what is neither held nor from closures."""
        stays = np.ones(self.n, dtype=bool)
        stays[[*self.kernel.shapes.pivots, *self.shared_coordinates]] = False
        kinds = [np.array(held, dtype=bool) for held in sorted(set(map(tuple, self.held.tolist())))]
        return [
            (np.flatnonzero((self.held == held).all(axis=1)), held, np.flatnonzero(stays & ~held)) for held in kinds
        ]

    @cached_property
    def has_self_stress(self) -> bool:
        """True where legs hold the payload against each other in ways in which none of them is compliant."""
        pivots = list(self.kernel.shapes.pivots)
        return bool(self.substitutes.size and (self.held[:, pivots] & (self.substitutes[:, pivots] < 0)).any())

    @cached_property
    def hub_free(self) -> Index:
        """Coordinates of the payload that nothing holds."""
        return np.flatnonzero(~self.hub_held[: 6 * self.hub])

    @cached_property
    def ports(self) -> Index:
        """Coordinates that follow a table in some leg, or are pushed by it: those with a drive's spring first."""
        shapes = self.kernel.shapes
        driven = [shapes.index(name) for name, _ in shapes.drives]
        if not self.hub:
            driven += [shapes.index(name) for name in ("alpha", "beta") if shapes.has(name)]
        if shapes.has("j"):
            driven.append(shapes.index("j"))
        return np.array([*driven, *(k for k in np.flatnonzero(self.held.any(axis=0)) if k not in driven)])

    @cached_property
    def fixed_mask(self) -> Mask:
        """Mask (size,) of the coordinates that do not follow from the equations of motion."""
        return np.concatenate([self.enforced_mask.ravel(), self.hub_held[: 6 * self.hub]])

    @cached_property
    def enforced_mask(self) -> Mask:
        """Mask (legs, n) of the coordinates that follow their table, whatever the closures say."""
        return self.held if self.slack is None else self.held & ~self.slack

    @cached_property
    def force_floor(self) -> float:
        """Rounding of the stiffest spring's force [N]: what a residual cannot fall below at lengths of a metre."""
        layout = leg_parameters(self.kernel.shapes)
        EA, Lp = (self.leg_p[:, columns(layout, name)] for name in ("EA", "Lp"))
        stiffest = [(EA / Lp).max() * (self.kernel.shapes.beam.axial.count > 0)]
        ends = (f"{x}_{y}" for x in ENDS for y in ("flexure", "soft"))
        springs = ("drive_stiffness", "carriage_stiffness", "series_stiffness", "rotor_stiffness", *ends)
        springs += ("guide_stiffness", "loop_stiffness")
        for name in springs:
            if name in dict(layout):
                stiffest.append(self.leg_p[:, columns(layout, name)].max())
        return float(8 * np.finfo(float).eps * max(stiffest))

    @cached_property
    def as_read_by_c(self) -> tuple[Array, ...]:
        """Arrays that the compiled loops read, row by row: held ports, held payload, parameters."""
        hub_held = self.hub_held if self.hub else np.ones(6)
        read = (self.enforced_mask[:, self.ports], hub_held, self.leg_p, self.joint_p, self.payload_p)
        return tuple(np.ascontiguousarray(x, dtype=float) for x in read)

    def by_leg(self, vector: Array) -> Array:
        """Part of the legs of a flat vector, (legs, n)."""
        return vector[: self.legs * self.n].reshape(self.legs, self.n)

    def residual(self, x: State, table: Array, wrench: Array, h: float = 0.0) -> tuple[Array, Array, Array]:
        """Balance of every coordinate (size,) [N, N m], closures (legs * rows,) [m], powers (4,) [W].

        ``table``, (legs, ports, 4): value, rate, acceleration and force of each port; ``wrench``, (load_size,). What
        holds a coordinate of the payload is left in its row. ``h``: time since its bristles were so.
        """
        v, v_dot, force = self.by_leg(x.v), self.by_leg(x.v_dot), table[:, :, 3] + x.drive
        inputs = [x.q, v, v_dot, x.lam, self.spring_commands(table), self.leg_p, *self._around(x, wrench)]
        shapes = self.kernel.shapes
        meeting = [(self.rows,), (6,)] if shapes.reads_pose else [(3,)]
        outputs = [(self.n,), *meeting, (2 + shapes.has_tip_load,), (shapes.commands // 2,)]
        r, gaps, *push, power, _ = evaluate(self.kernel, "leg_residual", self.legs, inputs, outputs)
        if self.rows == 3 and not shapes.reads_pose:
            joints = [x.pose, x.lam, self.joint_p]
            points, *push = evaluate(self.kernel, "joint_residual", self.legs, joints, [(3,), (6,)])
            gaps -= points
        gaps, powers = gaps[:, : self.rows], np.zeros(4)
        powers[: power.shape[1]] = power.sum(axis=0)
        if self.kernel.shapes.bristles:
            rubbed = self.friction(x, h)
            r, powers[0] = r + rubbed.r, powers[0] + rubbed.energies[:, 0].sum()
        r[:, self.ports] -= force
        work = force * v[:, self.ports]
        if shapes.has("j"):
            work[:, self.ports == shapes.index("j")] = 0.0
        powers[1], powers[3] = powers[1] + work[:, ~self.floor].sum(), work[:, self.floor].sum()
        if not self.hub:
            return r.ravel(), gaps.ravel(), powers
        u, u_dot = x.v[r.size :], x.v_dot[r.size :]
        net = push[0].sum(axis=0)
        plate = [y[0, self.plate] for y in (x.q, v, v_dot)] if shapes.plate else []
        rest, powers[2:3] = self.kernel.payload_residual(x.pose, u, u_dot, net, wrench, self.payload_p, *plate)
        r[0, self.plate] += rest[6:]
        return np.concatenate([r.ravel(), rest[:6]]), gaps.ravel(), powers

    def friction(self, x: State, h: float = 0.0) -> "Friction":
        """Friction of the legs a time ``h`` [s] after their bristles were as the state says."""
        count, b = self.legs, self.kernel.shapes.bristles
        outputs = [(self.n,), (2 * b,), (b,), (b,), (2,)]
        return Friction(*evaluate(self.kernel, "leg_friction", count, self._sliding(x, h), outputs))

    def friction_matrix(self, x: State, h: float) -> Array:
        """Derivative of the legs' friction by their rates, (legs, n, n)."""
        return evaluate(self.kernel, "leg_friction_matrix", self.legs, self._sliding(x, h), [(self.n, self.n)])[0]

    def _sliding(self, x: State, h: float) -> list[Array]:
        state = x.bristles if x.bristles.size else np.zeros((self.legs, 2 * self.kernel.shapes.bristles))
        return [x.q, self.by_leg(x.v), x.lam, state, np.array([h]), self.leg_p]

    def matrices(self, x: State, wrench: Array) -> Matrices:
        """Matrices at rest with geometric stiffness, and the Jacobian of the closures."""
        n, k, legs, rows = self.n, self.legs * self.n, self.legs, self.rows
        inputs = [x.q, x.lam, self.leg_p, *self._around(x, wrench)]
        outputs = [(n, n)] * 3 + [(rows, n)] + ([(rows, 6), (6, 6), (n, 6)] if self.kernel.shapes.reads_pose else [])
        found = evaluate(self.kernel, "leg_matrices", legs, inputs, outputs)
        M, D, K, G = (np.zeros((size, self.size)) for size in (self.size, self.size, self.size, legs * rows))
        for whole, parts in zip((M, D, K, G), found[:4], strict=True):
            for i, part in enumerate(parts):
                whole[i * len(part) : (i + 1) * len(part), i * n : (i + 1) * n] = part
        if self.kernel.shapes.has("j"):
            for i, parts in enumerate(zip(*self.loops(x)[:2], strict=True)):
                for whole, part in zip((D, K), parts, strict=True):
                    whole[i * n : (i + 1) * n, i * n : (i + 1) * n] += part
        if not self.hub:
            return Matrices(M=M, D=D, K=K, G=G)
        joints = [x.pose, x.lam, self.joint_p]
        of_joints = found[4:] or evaluate(self.kernel, "joint_matrices", legs, joints, [(3, 6), (6, 6)])
        P, H, *coupling = of_joints
        body = np.append(np.arange(k, k + 6), self.plate)
        mass, stiffness = self.kernel.payload_matrices(x.pose, wrench, self.payload_p, *_some(x.q[0, self.plate]))
        G[:, k:], K[k:, k:] = -P.reshape(-1, 6), H.sum(axis=0)
        M[np.ix_(body, body)] += mass
        for X in coupling:
            K[:k, k:] = X.reshape(-1, 6)
            K[k:, :k] = K[:k, k:].T
        K[np.ix_(body, body)] += stiffness
        return Matrices(M=M, D=D, K=K, G=G)

    def loops(self, x: State) -> list[Array]:
        """Terms of loops in D and K (legs, n, n), the measured place (legs, 1) and its slope (legs, n)."""
        n = self.n
        return evaluate(self.kernel, "leg_loop", self.legs, [x.q, self.leg_p], [(n, n), (n, n), (1,), (n,)])

    def energies(self, x: State, table: Array) -> tuple[Array, Array]:
        """Energies (3,) [J], kinetic, of gravity and of strain; whole force of each port (legs, ports), Eq. (T8.8)."""
        v, force, springs = self.by_leg(x.v), table[:, :, 3] + x.drive, self.kernel.shapes.commands // 2
        inputs = [x.q, v, self.spring_commands(table), self.leg_p]
        parts, spring = evaluate(self.kernel, "leg_energies", self.legs, inputs, [(3,), (springs,)])
        energy = parts.sum(axis=0)
        force[:, :springs] += spring
        if self.hub:
            plate = [x.q[0, self.plate], v[0, self.plate]] if self.plate.size else []
            energy = energy + self.kernel.payload_energies(x.pose, x.v[v.size :], self.payload_p, *plate)[0]
        return energy, force

    def spring_commands(self, table: Array) -> Array:
        """Value and rate that the drives' springs follow, (..., legs, 2 each), of a table (..., legs, ports, any)."""
        count = self.kernel.shapes.commands
        return table[..., : count // 2, :2].reshape(*table.shape[:-2], count)

    def _around(self, x: State, wrench: Array) -> list[Array]:
        """External arguments of a leg's functions: the payload's pose, or a load on a tip without payload."""
        shapes = self.kernel.shapes
        if shapes.reads_pose:
            return [x.pose]
        return [wrench] if shapes.has_tip_load else []

    def displace(self, x: State, step: Array) -> State:
        """State displaced by a step in the flat coordinates: q + dq, x + dx, R exp(theta^)."""
        pose = displace_pose(x.pose, step[self.legs * self.n :]) if self.hub else x.pose
        return replace(x, q=x.q + self.by_leg(step), pose=pose)


def _some(x: Array) -> list[Array]:
    return [x] if x.size else []
