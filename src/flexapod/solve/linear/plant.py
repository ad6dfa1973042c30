"""Robot about its equilibria with its loops as they are, drives held or released, on a base that may move.

Plants are of Eqs. (T20.1)-(T20.3); functions of a leg that the linear model alone needs are made on demand,
Eqs. (T20.3), (T20.9), (T20.26). A base that turns adds Eqs. (T20.8)-(T20.10), (T20.27) to a robot seen from it;
one that is accelerated changes gravity by as much, Eq. (T18.4).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Literal, cast

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array, Index, Mask
from flexapod.common.errors import ComputationError, InputError
from flexapod.kinematics.rotations import matrix
from flexapod.mechanics.elements.element import Physics
from flexapod.mechanics.elements.motor_loop import MotorLoop
from flexapod.mechanics.leg.layout import LEG_PARAMETERS, PAYLOAD_PARAMETERS, Shapes, columns, leg_parameters
from flexapod.mechanics.symbolic.compiler import CompiledFunction, compiled_library, compiler
from flexapod.model import Drive, Encoder, ForceDrive, PrescribedDrive, Robot, ScrewDrive, Simulation
from flexapod.model.study.mount import BaseMotion
from flexapod.solve.batch import RestMatrices, RestStates, matrices_at_rest, residual
from flexapod.solve.friction import with_friction
from flexapod.solve.kernel import Function, fingerprint
from flexapod.solve.linear.motions import flat_forces
from flexapod.solve.modal.elastic_robot import ElasticRobot
from flexapod.solve.rigid_motion import rigid_rest
from flexapod.solve.robot_system import robot_system, without_ripple
from flexapod.solve.statics.equilibrium import FARTHEST
from flexapod.solve.statics.ideal_robot import with_substitutes
from flexapod.solve.statics.locked_robot import LockedPoses
from flexapod.solve.statics.reduction import Motions, independent_motions
from flexapod.solve.statics.static_loads import push_ports
from flexapod.solve.statics.stiffness import tool_motion
from flexapod.solve.system import System


def gravity_forces(system: System, x: RestStates, command: Array, wrench: Array) -> Array:
    """Forces (P, size, 3) on all coordinates per unit acceleration of the base along x, y, z, Eq. (T18.4).

    In axes that move with the base it is gravity changed by the acceleration; residuals are linear in gravity.
    """

    def forces(gravity: Array) -> Array:
        legs, payload, _ = residual(_in_gravity(system, gravity), x, command, np.zeros_like(command), wrench)
        return np.concatenate([legs.reshape(len(x), system.legs * system.n), payload], axis=1)

    none = forces(np.zeros(3))
    return np.stack([forces(axis) - none for axis in np.eye(3)], axis=2)


def _in_gravity(system: System, gravity: Array) -> System:
    leg_p, payload_p = system.leg_p.copy(), system.payload_p.copy()
    leg_p[:, columns(LEG_PARAMETERS, "gravity")] = gravity
    payload_p[columns(PAYLOAD_PARAMETERS, "gravity")] = gravity
    return replace(system, leg_p=leg_p, payload_p=payload_p)


def nonpotential_matrices(system: System, q: Array) -> tuple[Array, Array] | None:
    """D and K (P, legs, n, n) of nonpotential forces at coordinates (P, legs, n); None of robots without."""
    shapes, legs = system.kernel.shapes, q.reshape(-1, system.n)
    if shapes.holds(MotorLoop):
        D, K, *_ = _each(system.kernel.leg_loop, legs, system, [(system.n, system.n)] * 2 + [(1,), (system.n,)])
    elif any(_pushes(slot.kind) for slot in shapes.elements):
        D, K = _each(_function(shapes, "leg_pushes"), legs, system, [(system.n, system.n)] * 2)
    else:
        return None
    return D.reshape(*q.shape, system.n), K.reshape(*q.shape, system.n)


def base_leg_masses(system: System, q: Array) -> Array:
    """Masses (P, legs, 6, n) between coordinates (P, legs, n) and a base that is moved; a system that has one."""
    found = _each(_function(system.kernel.shapes, "leg_carried"), q.reshape(-1, system.n), system, [(6, system.n)])[0]
    return found.reshape(*q.shape[:-1], 6, system.n)


def leg_lines(system: System, q: Array) -> tuple[Array, Array]:
    """Lines (P, legs, 3) from base joints to tips at coordinates (P, legs, n), and derivatives by these (..., 3, n)."""
    function, n = _function(system.kernel.shapes, "leg_line"), system.n
    line, J = _each(function, q.reshape(-1, n), system, [(3,), (3, n)])
    return line.reshape(*q.shape[:-1], 3), J.reshape(*q.shape[:-1], 3, n)


def _pushes(kind: type[Physics]) -> bool:
    own = (kind.nonpotential_force.__func__, kind.loop_force.__func__)  # type: ignore[attr-defined]
    return own != (Physics.nonpotential_force.__func__, Physics.loop_force.__func__)  # type: ignore[attr-defined]


def _each(function: Function | None, q: Array, system: System, shapes: Sequence[tuple[int, ...]]) -> list[Array]:
    p = np.tile(system.leg_p, (len(q) // system.legs, 1))
    if isinstance(function, CompiledFunction):
        return [x.swapaxes(1, 2) if x.ndim == 3 else x for x in function.each(len(q), [q, p], shapes)]
    found = [function(*row) for row in zip(q, p, strict=True)]  # type: ignore[misc]
    return [np.array([one[k] for one in found]).reshape(len(q), *shape) for k, shape in enumerate(shapes)]


@lru_cache(maxsize=32)
def _function(shapes: Shapes, name: str) -> Function:
    """One of `assembly`, compiled where there is a compiler."""
    from flexapod.mechanics.leg import kernel_functions

    if command := compiler():
        library, signatures = compiled_library(
            [name, *fingerprint(shapes)], lambda: [getattr(kernel_functions, name)(shapes)], command
        )
        return CompiledFunction(library, name, signatures[name])
    from flexapod.mechanics.symbolic.functions import Interpreted

    return Interpreted(getattr(kernel_functions, name)(shapes))


Drives = Literal["given", "force"]
#: Of a drive's spring and loop: what is not there where its force is given.
OF_LOOPS = ("loop_stiffness", "loop_damping", "rotor_integral")


@dataclass(frozen=True, kw_only=True)
class Plant:
    """A robot about the equilibria found in ``locked``, P of them.

    ``system``: its equations, drives released where ``drives`` is "force"; ``x``: states; ``m``: matrices with what
    friction and loops add; ``motions``: independent motions, the same ones at all poses; ``port`` (legs,): coordinate
    on which each drive acts, -1 of passive legs; ``as_at_rest``: whether the equations are those of statics.
    """

    locked: LockedPoses
    drives: Drives
    system: System
    x: RestStates
    m: RestMatrices
    motions: Motions
    port: Index
    as_at_rest: bool

    @property
    def robot(self) -> Robot:
        """The robot, pure force drives holding their places, on a base at rest."""
        return self.locked.robot

    def force_coordinate(self, leg: int) -> int:
        """Coordinate on which a force of a drive acts; of a lagging, released motor the one of its requested force."""
        shapes, at = self.system.kernel.shapes, int(self.port[leg])
        lags = self.drives == "force" and shapes.has("j") and not self.system.held[leg, shapes.index("j")]
        return shapes.index("j") if lags else at

    @property
    def command(self) -> Array:
        """Commands of all ports, (P, legs, ports); where statics know of none, what is there."""
        found, told = self.x.q[..., self.system.ports], self.locked.command[self.locked.at]
        for k, port in enumerate(self.locked.system.ports):
            found[..., self.system.ports == port] = told[..., k, None]
        return found

    @cached_property
    def by_gravity(self) -> Array:
        """Forces (P, size, 3) on all coordinates per unit acceleration of the base, Eq. (T18.4)."""
        return gravity_forces(self.system, self.x, self.command, self.locked.acts.wrench)


def plant_at(elastic: ElasticRobot, at: kinematics.RigidPoses, drives: Drives) -> Plant:
    """A robot about its equilibria at P poses.

    Raises
    ------
    InputError
        A pure force drive, where `drives` are as given.
    ComputationError
        A pose so far from home that the motions chosen there say nothing of it.
    """
    if drives == "force":
        legs = tuple(leg.replace(drive=_holding(leg.drive)) for leg in elastic.robot.legs)
        elastic = ElasticRobot(elastic.robot.replace(legs=legs), elastic.simulation, elastic.load)
    locked = _locked(elastic, at)
    shapes = locked.system.kernel.shapes
    plant = plant_at_rest(locked)
    if drives == "force" or shapes.has("w") or shapes.has("j"):
        plant = _in_motion(locked, drives)
    if (more := nonpotential_matrices(plant.system, plant.x.q)) is not None:
        m = replace(plant.m, D=plant.m.D + more[0], K=plant.m.K + more[1])
        plant = replace(plant, m=m, motions=independent_motions(plant.system, m))
    if len(plant.x) and plant.motions.most.max() > FARTHEST:
        raise ComputationError(
            "too far from home: the shape or step that stands there for what a joint or drive holds moves by "
            f"{plant.motions.most.max():.3g} here where another coordinate moves by 1 (at most {FARTHEST:g})",
            next_step="Give the robot a home nearer to the pose.",
        )
    return plant


def _locked(elastic: ElasticRobot, at: kinematics.RigidPoses) -> LockedPoses:
    try:
        return elastic.lock(at)
    except InputError as error:
        if error.key != "leg.drive" or "pure force" not in error.what:
            raise
        raise InputError(
            error.what, key=error.key, value=error.value, allowed=error.allowed,
            next_step='linearize(..., drives="force") releases the drives where they are',
        ) from None  # fmt: skip


def plant_at_rest(locked: LockedPoses) -> Plant:
    """The plant about equilibria with the equations of statics: drives as they are given."""
    return Plant(
        locked=locked, drives="given", system=locked.system, x=locked.equilibria.states[locked.at], m=locked.m,
        motions=locked.motions, port=push_ports(locked.system, locked.robot), as_at_rest=True,
    )  # fmt: skip


def _in_motion(locked: LockedPoses, drives: Drives) -> Plant:
    """The plant with the equations of motion: loops as they are, or drives released."""
    robot, simulation = locked.robot, locked.simulation
    system, x = _moving(robot, simulation, locked.per_loss, drives), locked.equilibria.states[locked.at]
    x = replace(x, drive=np.zeros((len(x), system.legs, system.ports.size)))  # forces of statics: none is asked for
    m = with_friction(system, x, matrices_at_rest(system, x, locked.acts.wrench), stuck=simulation.friction == "stuck")
    return Plant(
        locked=locked, drives=drives, system=system, x=x, m=m, motions=independent_motions(system, m),
        port=push_ports(system, robot), as_at_rest=False,
    )  # fmt: skip


def _holding(drive: Drive) -> Drive:
    """A drive that holds its place where this one is a force that keeps none; any other as it is."""
    if not drive.pushes:
        return drive
    if isinstance(drive, ForceDrive):
        return PrescribedDrive(friction=drive.friction)
    none = dict.fromkeys(("value", "file", "time", "torque", "loop"))
    return cast("ScrewDrive", drive).replace(command="position", law="rigid", encoder=Encoder(), **none)


def _model(robot: Robot, simulation: Simulation, per_loss: float, drives: Drives) -> System:
    """Equations in motion, with substitutes of held pivots."""
    simulation, known = simulation.replace(play="static"), without_ripple(robot)
    system = robot_system(known, simulation, per_loss)
    if drives == "force":
        system = _released(system, robot_system(_at_rotors(known), simulation, per_loss).held, robot)
    return with_substitutes(system, rigid_rest(system, kinematics.RigidPoses(robot, kinematics.home_pose(robot))))


_moving = cast("Callable[[Robot, Simulation, float, Drives], System]", lru_cache(maxsize=64)(_model))


def _at_rotors(robot: Robot) -> Robot:
    """The robot whose drives hold rotors, and nothing behind them."""
    legs = tuple(
        leg.replace(drive=leg.drive.replace(encoder=Encoder())) if leg.screw is not None and leg.screw.holds else leg
        for leg in robot.legs
    )
    return robot.replace(legs=legs)


def _released(system: System, held: Mask, robot: Robot) -> System:
    """The system whose drives are forces: nothing holds their ports, neither springs nor loops, Eq. (T20.2)."""
    shapes, leg_p, held = system.kernel.shapes, system.leg_p.copy(), held.copy()
    layout = leg_parameters(shapes)
    springs = {shapes.index(name): drive for name, drive in shapes.drives}
    driven = push_ports(system, robot)
    if (driven < 0).all():
        raise InputError("has no drives: all its legs are passive", key="drives", value="force", allowed='"given"')
    for i, at in enumerate(driven):
        if at < 0:
            continue
        held[i, at] = False
        for name in (f"{springs[int(at)]}_stiffness", f"{springs[int(at)]}_damping", *OF_LOOPS):
            if name in dict(layout):
                leg_p[i, columns(layout, name)] = 0.0
        if shapes.has("w"):
            held[i, shapes.index("w")] = True
    return replace(system, held=held, leg_p=leg_p)


def turning_forces(plant: Plant, about: Array) -> Array:
    """Forces (P, size, 3) per unit angular acceleration of the base about a point (3,), Eq. (T20.9)."""
    system, x = plant.system, plant.x
    found, first = np.zeros((len(x), system.size, 3)), system.legs * system.n
    found[:, :first] = -carried_masses(plant, about)[0][:, :, 3:].swapaxes(2, 3).reshape(len(x), -1, 3)
    rigid, arm = np.zeros((len(x), system.size, 3)), x.pose[:, :3] - about
    rigid[:, first : first + 3] = np.cross(np.eye(3)[None], arm[:, None]).swapaxes(1, 2)
    rigid[:, first + 3 :] = matrix(x.pose[:, 3:]).swapaxes(1, 2)
    none = np.zeros((len(x), system.legs, system.n, system.n))
    return found - flat_forces(system, none, plant.m.payload_M, rigid)


def carried_masses(plant: Plant, about: Array) -> tuple[Array, Array]:
    """Masses of each leg between a base that moves and its coordinates (P, legs, 6, n), and of the base's motions.

    The latter (P, legs, 6, 6). The base is displaced and turned about a point (3,).
    """
    system, x = plant.system, plant.x
    moved = _on_moved_base(plant.robot, plant.locked.simulation, plant.locked.per_loss, about, plant.as_at_rest)
    own, there = ([(n, k) for n, size in s.kernel.shapes.layout for k in range(size)] for s in (system, moved))
    place = {pair: i for i, pair in enumerate(there)}
    at, base = [place[pair] for pair in own], [place["g", k] for k in range(6)]
    q = np.zeros((len(x), system.legs, moved.n))
    q[..., at] = x.q
    M = base_leg_masses(moved, q)
    return M[..., at], M[..., base]


def tilt_stiffness(plant: Plant) -> Array:
    """Forces (P, size, 3) against unit small turns of the base: weights, load turn in its axes, (T20.10), (T20.27)."""
    found = -plant.by_gravity @ _turning(plant.robot.gravity)
    wrench, first = plant.locked.acts.wrench, plant.system.legs * plant.system.n
    turned = np.concatenate([_turning(wrench[:3]), _turning(wrench[3:])])
    if turned.any():
        found[:, first:] += tool_motion(plant.robot, plant.x.pose).swapaxes(1, 2) @ turned
    return found


def _turning(vector: Array) -> Array:
    """Change (3, 3) of a vector by unit small turns about the axes: columns e x vector."""
    return np.asarray(np.cross(np.eye(3), vector).T)


def _on_moved_base(robot: Robot, simulation: Simulation, per_loss: float, about: Array, at_rest: bool) -> System:
    still = BaseMotion(time=np.array([0.0, 1.0]), values=np.zeros((2, 6)), at=about)
    robot = without_ripple(robot.replace(base_motion=still))
    return robot_system(robot, simulation.replace(play="static"), per_loss, at_rest=at_rest)
