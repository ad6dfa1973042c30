"""Linear model of a robot as matrices A, B, C, D with names and units, Eqs. (T20.11)-(T20.23).

At many poses at once M, D, K, B, C are those on named motions, which are smooth from pose to pose, Eq. (T20.6).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import InputError
from flexapod.model import Robot
from flexapod.solve.linear.channels import PlantChannel
from flexapod.solve.linear.first_order import FirstOrder, first_order, with_mass
from flexapod.solve.linear.motions import coordinate_names, project_on_motions
from flexapod.solve.linear.outputs import PlantOutputs
from flexapod.solve.linear.plant import Plant
from flexapod.solve.linear.second_order import SecondOrder, second_order
from flexapod.solve.statics.stiffness import tool_motion


@dataclass(frozen=True, kw_only=True)
class States:
    """x' = A x + B u, y = C x + D u with their names, and what they come from."""

    A: Array
    B: Array
    C: Array
    D: Array
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    states: tuple[str, ...]
    units: Mapping[str, str]


@dataclass(frozen=True, kw_only=True)
class Descriptor:
    """A robot about rest in the flat coordinates of its equations, Eq. (T20.1).

    M q'' + D q' + K q + G^T lam = B u + held, G q = 0; places y = C q.

    Attributes
    ----------
    M, D, K : ndarray, shape (N, N)
        SI; friction and loops are in D and K.
    G : ndarray, shape (rows, N)
        Of the closures.
    B : ndarray, shape (N, m)
        Balance per unit input; of a command through springs and loops per unit command.
    B_rate : ndarray, shape (N, m)
        Per unit rate of such commands, else 0.
    C : ndarray, shape (p, N)
        Of those outputs that are places.
    coordinates, inputs, outputs : tuples of str
        Names; the payload's turns are about platform axes.
    held : ndarray of bool, shape (N,)
        Coordinates that follow commands or are held.
    """

    M: Array
    D: Array
    K: Array
    G: Array
    B: Array
    B_rate: Array
    C: Array
    coordinates: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    held: Mask


def to_first_order(second: SecondOrder) -> FirstOrder:
    """The first of the poses as a first-order system."""
    free, d = second.free, len(second.names)
    more = np.arange(free, d)
    own, rest, T = with_mass(second.U[0])
    T = np.concatenate([T, np.zeros((more.size, rest.size))])
    mass = np.concatenate([own, more]).astype(np.intp), rest, T
    loops = np.concatenate([second.sums, second.lags]).astype(np.intp)
    return first_order(second.M[0], second.D[0], second.K[0], second.F[0], mass=mass, loops=loops)


def states_of(
    plant: Plant,
    inputs: Sequence[PlantChannel],
    outputs: Sequence[PlantChannel],
    *,
    about: Array,
    tilt: bool = True,
) -> States:
    """The linear model at the one pose of a plant.

    ``about``, ``tilt``: as of `second_order`.
    """
    second = second_order(plant, inputs, tilt=tilt, about=about)
    first = to_first_order(second)
    seen = PlantOutputs(plant=plant, second=second, first=first, inputs=inputs)
    n, m = first.B.shape
    rows = np.array([seen.row(channel) for channel in outputs]).reshape(len(outputs), n + m)
    names = [second.names[k] for k in [*first.second, *first.first]]
    names += [f"{second.names[k]} rate" for k in first.second]
    A, B, C, D, names = _with_geophones(first.A, first.B, rows[:, :n], rows[:, n:], names, outputs)
    return States(
        A=A, B=B, C=C, D=D, inputs=tuple(c.name for c in inputs), outputs=tuple(c.name for c in outputs),
        states=tuple(names), units=units_of(plant.robot, inputs) | units_of(plant.robot, outputs),
    )  # fmt: skip


def _with_geophones(
    A: Array, B: Array, C: Array, D: Array, names: Sequence[str], outputs: Sequence[PlantChannel]
) -> tuple[Array, Array, Array, Array, list[str]]:
    """Proof masses of geophones behind the accelerations that move them, Eq. (T20.22)."""
    names = list(names)
    for i, channel in enumerate(outputs):
        if (sensor := channel.geophone) is None:
            continue
        n, omega = len(A), 2 * np.pi * sensor.f0
        more = np.zeros((2, n + 2))
        more[0, n + 1], more[1, n], more[1, n + 1], more[1, :n] = 1.0, -(omega**2), -2 * sensor.damping * omega, C[i]
        A = np.concatenate([np.pad(A, ((0, 0), (0, 2))), more])
        B = np.concatenate([B, np.zeros((1, B.shape[1])), D[i : i + 1]])
        C, D = np.pad(C, ((0, 0), (0, 2))), D.copy()
        C[i], D[i] = 0.0, 0.0
        C[i, n + 1] = sensor.sensitivity
        names += [f"{channel.name} proof mass", f"{channel.name} proof mass rate"]
    return A, B, C, D, names


def units_of(robot: Robot, channels: Sequence[PlantChannel]) -> dict[str, str]:
    """Units of channels by name."""
    return {channel.name: _unit(robot, channel) for channel in channels}


def _unit(robot: Robot, channel: PlantChannel) -> str:
    crank = channel.leg >= 0 and _turns(robot, channel.leg)
    match channel.group:
        case "wrench":
            return "N" if channel.axis < 3 else "N m"
        case "tool" | "tool-base":
            return "m" if channel.axis < 3 else "rad"
        case "floor":
            return "m/s^2" if channel.axis < 3 else "rad/s^2"
        case "drive" | "drive-force" | "force-sensor:drive":
            return "N m" if crank else "N"
        case "command":
            return "rad/s^2" if crank else "m/s^2"
        case "stroke" | "encoder":
            return "rad" if crank else "m"
        case "com" | "com-base":
            return "m"
        case "accelerometer":
            return "m/s^2"
        case "geophone":
            return "V" if channel.geophone is not None and channel.geophone.sensitivity != 1.0 else "m/s"
    return "N"


def _turns(robot: Robot, leg: int) -> bool:
    carriage = robot.legs[leg].carriage
    return carriage is not None and carriage.kind == "crank" and robot.legs[leg].driven == "carriage"


def descriptor_of(
    plant: Plant, inputs: Sequence[PlantChannel], outputs: Sequence[PlantChannel], about: Array
) -> Descriptor:
    """The equations in flat coordinates at the one pose of a plant; ``about``: as of `second_order`."""
    system = plant.system
    second = second_order(plant, inputs, about=about)
    M, D, K = (x[0] for x in project_on_motions(system, plant.m, np.eye(system.size)[None]))
    m = len(inputs)
    seen = PlantOutputs(plant=plant, second=second, first=to_first_order(second), inputs=inputs)
    places = [c for c in outputs if c.group in ("tool", "com", "tool-base", "com-base", "stroke", "encoder")]
    B, B_rate = second.forces[0].copy(), np.zeros((system.size, m))
    for k, channel in enumerate(inputs):
        if channel.group == "command" and not system.held[channel.leg, plant.port[channel.leg]]:
            at = second.names.index(channel.name)
            own = project_on_motions(system, plant.m, second.flat[:, :, at : at + 1])
            B[:, k] = -(second.on_place[0, :, at] - own[2][0, :, 0])
            B_rate[:, k] = -(second.on_rate[0, :, at] - own[1][0, :, 0])
    return Descriptor(
        M=M, D=D, K=K, G=seen.jacobian, B=B, B_rate=B_rate, C=seen.by_coordinates(places),
        coordinates=tuple(coordinate_names(system)[: system.size]), inputs=tuple(c.name for c in inputs),
        outputs=tuple(c.name for c in places), held=system.fixed_mask,
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class PoseMatrices:
    """M z'' + D z' + K z = B u, y = C z at P poses; arrays with the pose first, ``motions`` by name.

    Motions of loops have no inertia; behind the ``free`` ones stand those that inputs impose, as commands: z'' = u.
    """

    motions: tuple[str, ...]
    free: int
    M: Array
    D: Array
    K: Array
    B: Array
    C: Array


def grid_of(
    plant: Plant, inputs: Sequence[PlantChannel], outputs: Sequence[PlantChannel], *, about: Array
) -> PoseMatrices:
    """The equations at all equilibria of a plant.

    Raises
    ------
    InputError
        Outputs that are no places.
    """
    second = second_order(plant, inputs, about=about)
    C = np.stack([_row(plant, second, channel) for channel in outputs], axis=1)
    return PoseMatrices(motions=second.names, free=second.free, M=second.M, D=second.D, K=second.K, B=second.F, C=C)


def _row(plant: Plant, second: SecondOrder, channel: PlantChannel) -> Array:
    """An output by motions, (P, d)."""
    system, flat = plant.system, second.flat
    hub = flat[:, system.legs * system.n :]
    if channel.group == "tool":
        return np.asarray((tool_motion(plant.robot, plant.x.pose)[:, channel.axis, None] @ hub)[:, 0])
    if channel.group == "com":
        return np.asarray(hub[:, channel.axis])
    if channel.group == "stroke":
        shapes = system.kernel.shapes
        at = shapes.index("chi") if plant.robot.legs[channel.leg].driven == "carriage" else shapes.l_index
        return np.asarray(flat[:, channel.leg * system.n + at])
    raise InputError(
        "is no place: at many poses outputs are places by motions", key="outputs", value=channel.name,
        allowed="tool, com, stroke", next_step="Take one pose at a time for forces and sensors",
    )  # fmt: skip
