"""Equations of a robot about rest on named motions: M, D, K, and forces by inputs, Eqs. (T20.4)-(T20.10)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from flexapod.common.arrays import Array, Index
from flexapod.common.errors import InputError
from flexapod.kinematics.rotations import matrix
from flexapod.solve.batch import residual
from flexapod.solve.linear.channels import PlantChannel
from flexapod.solve.linear.motions import coordinate_names, held_motions, project_on_motions
from flexapod.solve.linear.plant import Plant, tilt_stiffness, turning_forces
from flexapod.solve.modal.modes import mass_on_motions, no_mass
from flexapod.solve.statics.stiffness import tool_motion


@dataclass(frozen=True, kw_only=True)
class SecondOrder:
    """M z'' + D z' + K z = F u at P poses, on d motions: free ones, then those that inputs impose.

    ``names`` (d,); ``free``: how many of them are free; ``M``, ``D``, ``K`` (P, d, d), ``F`` (P, d, m); ``flat``
    (P, size, d): flat coordinates by motions; ``on_rate``, ``on_place``, ``on_acceleration`` (P, size, d) and
    ``forces`` (P, size, m): balance of all coordinates by them and by inputs; ``U`` (P, rows, free): factor of the
    mass; ``sums``, ``lags``: motions that are states of loops; ``about`` (3,): point about which the floor turns.
    """

    names: tuple[str, ...]
    free: int
    M: Array
    D: Array
    K: Array
    F: Array
    flat: Array
    on_acceleration: Array
    on_rate: Array
    on_place: Array
    forces: Array
    U: Array
    sums: Index
    lags: Index
    about: Array


def second_order(plant: Plant, inputs: Sequence[PlantChannel], *, about: Array, tilt: bool = True) -> SecondOrder:
    """The equations on motions.

    Parameters
    ----------
    plant : Plant
    inputs : sequence of PlantChannel
    about : ndarray, shape (3,)
        Point about which the floor turns, world axes.
    tilt : bool
        Whether gravity and the load turn in the axes of a floor that turns.

    Raises
    ------
    InputError
        Nothing can move, or an input that moves nothing.
    ComputationError
        Masses that no body can have.
    """
    system, motions = plant.system, plant.motions
    P, d = len(plant.x), motions.columns.size
    commands = [c for c in inputs if c.group == "command"]
    stands = plant.robot.gravity.any() or plant.locked.acts.wrench.any()  # what turns in axes of the floor
    turns = [c for c in inputs if c.group == "floor" and c.axis >= 3] if tilt and stands else []
    extra = len(commands) + len(turns)
    if not d and not extra:
        raise InputError(
            f"leaves nothing that could move with the drives {'locked' if plant.drives == 'given' else 'released'}",
            key="simulation.fidelity", value=plant.locked.simulation.fidelity,
            next_step='drives = "force" releases them' if plant.drives == "given" else "Choose one that gives way",
        )  # fmt: skip
    flat = np.zeros((P, system.size, d + extra))
    flat[:, :, :d] = motions.flat(system, np.broadcast_to(np.eye(d), (P, d, d)))
    _held(plant, commands, flat[:, :, d : d + len(commands)])
    A, R, Q = project_on_motions(system, plant.m, flat)
    Q[:, :, d : d + len(commands)] += (by := _springs(plant, commands))[0]
    R[:, :, d : d + len(commands)] += by[1]
    if turns:
        Q[:, :, d + len(commands) :] += tilt_stiffness(plant)[:, :, [c.axis - 3 for c in turns]]
    _refuse_held(plant, inputs)
    forces = input_forces(plant, inputs, about)
    own, sums, lags = _named(plant)
    # a lag's impulse enters by its rate alone, the force; a sum's equation is integrated once, Eq. (T20.7)
    Q[:, :, lags], R[:, :, lags], A[:, :, lags] = R[:, :, lags], A[:, :, lags], 0.0
    z = flat[:, :, :d].swapaxes(1, 2)
    M, D, K = np.zeros((3, P, d + extra, d + extra))
    M[:, :d], D[:, :d], K[:, :d] = z @ A, z @ R, z @ Q
    K[:, sums], D[:, sums], M[:, sums] = D[:, sums], M[:, sums], 0.0
    F = np.concatenate([z @ forces, np.zeros((P, extra, len(inputs)))], axis=1)
    for k, channel in enumerate([*commands, *turns]):
        i = list(inputs).index(channel)
        F[:, :d, i] -= M[:, :d, d + k]
        M[:, :d, d + k], M[:, d + k, d + k], F[:, d + k, i] = 0.0, 1.0, 1.0
    return SecondOrder(
        names=(*own, *(c.name for c in [*commands, *turns])), free=d, M=M, D=D, K=K, F=F, flat=flat, on_acceleration=A,
        on_rate=R, on_place=Q, forces=forces, U=_mass(plant, [*sums, *lags]), sums=np.array(sums, dtype=np.intp),
        lags=np.array(lags, dtype=np.intp), about=about,
    )  # fmt: skip


def _named(plant: Plant) -> tuple[list[str], list[int], list[int]]:
    """Names of the free motions, and which of them are sums and lags of loops."""
    system, names = plant.system, coordinate_names(plant.system)
    own, shapes, found = [names[k] for k in plant.motions.columns], system.kernel.shapes, {"w": [], "j": []}
    for name, words in (("w", "summed error"), ("j", "motor force")):
        for k, at in enumerate(plant.motions.columns.tolist()):
            if shapes.has(name) and at < system.legs * system.n and at % system.n == shapes.index(name):
                found[name].append(k)
                own[k] = f"{own[k].rpartition(' ')[0]} {words}"
    return own, found["w"], found["j"]


def _mass(plant: Plant, loops: Sequence[int]) -> Array:
    """Factor (P, rows, d) of the mass on the free motions, without the coordinates of loops."""
    U, positive = mass_on_motions(plant.system, plant.motions, plant.m)
    if not positive.all():
        raise no_mass(plant.system, plant.x.q[int((~positive).argmax())])
    U[:, :, loops] = 0.0
    return U


def _held(plant: Plant, commands: Sequence[PlantChannel], found: Array) -> None:
    """Put into motions (P, size, c) those by commands of drives that hold what is commanded, Eq. (T20.5)."""
    system = plant.system
    stroke = system.kernel.shapes.l_index
    for k, channel in enumerate(commands):
        i, at = channel.leg, int(plant.port[channel.leg])
        if not system.held[i, at]:
            continue
        follow = {at} | ({stroke} if plant.robot.legs[i].gives and system.held[i, stroke] else set())
        found[:, :, k] = held_motions(system, plant.m, [(i, x) for x in sorted(follow)]).sum(axis=2)


def _springs(plant: Plant, commands: Sequence[PlantChannel]) -> tuple[Array, Array]:
    """Terms of unit commands, and of their unit rates, in all balances by springs and loops, two (P, size, c)."""
    system, x, wrench = plant.system, plant.x, plant.locked.acts.wrench
    none = np.zeros((len(x), system.legs, system.ports.size))
    found = np.zeros((2, len(x), system.size, len(commands)))
    soft = [(k, c) for k, c in enumerate(commands) if not system.held[c.leg, plant.port[c.leg]]]
    if not soft:
        return found[0], found[1]
    before = residual(system, x, none, none, wrench)
    for k, channel in soft:
        one = none.copy()
        one[:, channel.leg, np.flatnonzero(system.ports == plant.port[channel.leg])] = 1.0
        for order, told in enumerate(((one, none), (none, one))):
            after = residual(system, x, *told, wrench)
            found[order, :, : system.legs * system.n, k] = (after[0] - before[0]).reshape(len(x), -1)
    for k, channel in soft:
        if not found[:, :, :, k].any():
            raise InputError(
                f"moves nothing: the drive of leg {channel.leg + 1} is a force that follows no command", key="inputs",
                value=channel.name, allowed='"drive", its force', next_step='Ask for inputs "drive"',
            )  # fmt: skip
    return found[0], found[1]


def point_motion(plant: Plant, at: Array) -> Array:
    """Displacements (P, 3, 6) of a point of the payload, from its CoM in its axes, by the payload's steps."""
    R = matrix(plant.x.pose[:, 3:])
    cross = np.cross(np.eye(3), at)  # rows e_i x at
    found = np.zeros((len(R), 3, 6))
    found[:, :, :3], found[:, :, 3:] = np.eye(3), R @ cross.T
    return found


def input_forces(plant: Plant, inputs: Sequence[PlantChannel], about: Array) -> Array:
    """Forces (P, size, m) on all coordinates per unit input, Eqs. (T18.3)-(T18.5), (T20.8)-(T20.9)."""
    system = plant.system
    P, hub = len(plant.x), slice(system.legs * system.n, system.size)
    found, tool = np.zeros((P, system.size, len(inputs))), tool_motion(plant.robot, plant.x.pose)
    turning = turning_forces(plant, about) if any(c.group == "floor" and c.axis >= 3 for c in inputs) else None
    for k, channel in enumerate(inputs):
        match channel.group:
            case "wrench":
                found[:, hub, k] = tool[:, channel.axis]
            case "force" if channel.at is not None:
                found[:, hub, k] = point_motion(plant, channel.at)[:, channel.axis]
            case "drive":
                found[:, channel.leg * system.n + plant.force_coordinate(channel.leg), k] = 1.0
            case "floor" if channel.axis < 3:
                found[:, :, k] = plant.by_gravity[:, :, channel.axis]
            case "floor" if turning is not None:
                found[:, :, k] = turning[:, :, channel.axis - 3]
    return found


def _refuse_held(plant: Plant, inputs: Sequence[PlantChannel]) -> None:
    drives = [c for c in inputs if c.group == "drive"]
    if drives and all(plant.system.held[c.leg, plant.port[c.leg]] for c in drives):
        raise InputError(
            "moves nothing: the drives hold their positions, whatever pushes them", key="inputs", value="drive",
            allowed='drives that give way; or drives = "force", which releases them',
        )  # fmt: skip
