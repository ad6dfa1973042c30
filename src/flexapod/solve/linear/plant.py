"""A robot about its equilibria with its loops as they are, drives held or released, Eqs. (T20.1)-(T20.3)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Literal, cast

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import ComputationError, InputError
from flexapod.mechanics.leg.layout import columns, leg_parameters
from flexapod.model import Drive, Encoder, ForceDrive, Load, PrescribedDrive, Robot, ScrewDrive, Simulation
from flexapod.solve.batch import RestMatrices, RestStates, matrices_at_rest
from flexapod.solve.friction import with_friction
from flexapod.solve.linear.beside import pushes
from flexapod.solve.linear.gravity import gravity_forces
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.rigid_motion import rigid_rest
from flexapod.solve.robot_system import robot_system, smooth
from flexapod.solve.statics.drive_forces import push_ports
from flexapod.solve.statics.equilibrium import FARTHEST
from flexapod.solve.statics.locked_robot import LockedPoses
from flexapod.solve.statics.reduction import Motions, independent
from flexapod.solve.statics.substitutes import with_substitutes
from flexapod.solve.system import Index, System

__all__ = ["Drives", "Plant", "plant_at", "plant_at_rest"]

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

    def pushed(self, leg: int) -> int:
        """Coordinate on which a force of a drive acts; of a motor that lags, and is released, what it is asked for."""
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


def plant_at(robot: Robot, simulation: Simulation, path: kinematics.Poses, load: Load, drives: Drives) -> Plant:
    """A robot about its equilibria at P poses.

    Raises
    ------
    InputError
        A pure force drive, where `drives` are as given.
    ComputationError
        A pose so far from home that the motions chosen there say nothing of it.
    """
    if drives == "force":
        robot = robot.replace(legs=tuple(leg.replace(drive=_holding(leg.drive)) for leg in robot.legs))
    locked = locked_poses(robot, simulation, path, load)
    shapes = locked.system.kernel.shapes
    plant = plant_at_rest(locked)
    if drives == "force" or shapes.has("w") or shapes.has("j"):
        plant = _in_motion(locked, drives)
    if (more := pushes(plant.system, plant.x.q)) is not None:
        m = replace(plant.m, D=plant.m.D + more[0], K=plant.m.K + more[1])
        plant = replace(plant, m=m, motions=independent(plant.system, m))
    if len(plant.x) and plant.motions.most.max() > FARTHEST:
        raise ComputationError(
            "too far from home: the shape or step that stands there for what a joint or drive holds moves by "
            f"{plant.motions.most.max():.3g} here where another coordinate moves by 1 (at most {FARTHEST:g})",
            next_step="Give the robot a home nearer to the pose.",
        )
    return plant


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
        locked=locked, drives=drives, system=system, x=x, m=m, motions=independent(system, m),
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
    """The equations in motion, with what stands for held pivots."""
    simulation, known = simulation.replace(play="static"), smooth(robot)
    system = robot_system(known, simulation, per_loss)
    if drives == "force":
        system = _released(system, robot_system(_at_rotors(known), simulation, per_loss).held, robot)
    return with_substitutes(system, rigid_rest(system, robot, kinematics.home_pose(robot)))


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
