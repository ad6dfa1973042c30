"""Robots with locked drives at poses: static equilibria, and what is computed about them, Eqs. (T7.1), (T7.20)."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import cast

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array, Index, Mask
from flexapod.common.errors import ComputationError, InputError
from flexapod.kinematics.leg_geometry import DRIVEN, FREE
from flexapod.mechanics.elements.springs import springs_along
from flexapod.model import Load, Robot, Simulation
from flexapod.solve.batch import RestMatrices, RestStates, matrices_at_rest
from flexapod.solve.friction import with_friction
from flexapod.solve.rigid_motion import rigid_rest
from flexapod.solve.robot_system import robot_system, rotor_loop_system, without_ripple
from flexapod.solve.statics.assembly_mode import refuse_assembly_change
from flexapod.solve.statics.equilibrium import FOUND, TOO_FAR, Equilibria, Equilibrium, equilibria
from flexapod.solve.statics.ideal_robot import with_substitutes
from flexapod.solve.statics.reduction import Motions, independent_motions
from flexapod.solve.statics.static_loads import RestLoad, rest_commands, rest_load
from flexapod.solve.system import System


@dataclass(frozen=True, kw_only=True)
class LockedPoses:
    """A robot with drives locked at the ``command`` (P, legs, ports) of P ``rigid`` poses.

    Its undeformed states ``start``, what ``acts`` on it, equilibria, and matrices ``m`` and independent ``motions`` of
    those found, ``at``; ``per_loss`` [s]: as of `robot_system`.
    """

    robot: Robot
    rigid: kinematics.RigidPoses
    system: System
    simulation: Simulation
    per_loss: float
    start: RestStates
    command: Array
    acts: RestLoad
    equilibria: Equilibria
    at: Index
    m: RestMatrices
    motions: Motions

    @property
    def path(self) -> kinematics.Poses:
        """Poses of the platform frame, before it sags."""
        return self.rigid.poses

    @cached_property
    def vibration_model(self) -> "LockedPoses":
        """Poses for vibration about them: a rotor at rest by integral action vibrates on its loop's spring."""
        if self.system.kernel.shapes.has("j"):
            system = rotor_loop_system(
                without_ripple(self.robot), self.simulation.replace(play="static"), self.per_loss
            )
            system = replace(system, substitutes=self.system.substitutes)
            at, stuck = self.equilibria.states[self.at], self.simulation.friction == "stuck"
            m = with_friction(system, at, matrices_at_rest(system, at, self.acts.wrench), stuck=stuck)
            return replace(self, system=system, m=m, motions=independent_motions(system, m))
        if not self.system.kernel.shapes.has("w"):
            return self
        held, shapes = self.system.held.copy(), self.system.kernel.shapes
        rests = [leg.screw is not None and leg.screw.rests and not leg.screw.holds for leg in self.robot.legs]
        held[rests, shapes.index("r")] = False
        system = replace(self.system, held=held)
        return replace(self, system=system, motions=independent_motions(system, self.m))

    def one(self, k: int) -> "LockedPoses":
        """Single pose, the k-th of those whose equilibrium was found."""
        at, found = self.at[k : k + 1], self.equilibria
        here = np.array([k])
        alone = Equilibria(
            states=found.states[at],
            code=found.code[at],
            m=found.m[here],
            motions=found.motions[here],
            most=found.most[at],
        )
        return replace(
            self,
            rigid=kinematics.RigidPoses(self.robot, self.path.part(slice(at[0], at[0] + 1))),
            start=self.start[at],
            command=self.command[at],
            acts=replace(self.acts, force=self.acts.force[at]),
            equilibria=alone,
            at=np.zeros(1, dtype=np.intp),
            m=self.m[here],
            motions=self.motions[here],
        )


def refuse_pure_force(robot: Robot, what: str) -> None:
    """Raise InputError if drives that are a force without feedback stiffness leave the platform something to do."""
    pure = [leg.drive.pushes for leg in robot.legs]
    if not any(pure) or _held_by_others(robot, np.array(pure)):
        return
    for i, loose in enumerate(pure, start=1):
        if loose:
            raise InputError(
                f"{what} of leg {i} has no meaning: a pure force drive holds no position, so the stroke is free",
                key="leg.drive",
                value=robot.legs[i - 1].drive.type,
                allowed='"prescribed", "servo", or a force drive with feedback stiffness; a screw with a loop',
                next_step='A simulation can start with [initial] start = "moving"',
            )


def refuse_taut(robot: Robot, simulation: Simulation) -> None:
    """Raise InputError if a leg bends between two fixed points and cannot stretch: it would have to get longer."""
    if not robot.platform_fixed or not simulation.lateral_shapes:
        return
    for i, leg in enumerate(robot.legs, start=1):
        held = leg.drive.holds and leg.driven in ("stroke", "carriage") if leg.driven else leg.strut is not None
        gives = leg.gives or springs_along(leg) or leg.base_joint.flexes or leg.platform_joint.flexes
        if held and not gives and not simulation.axial_shapes(leg.axial_modes):
            raise InputError(
                f"leg {i} is held at both ends and cannot stretch: it could not bend either, but for getting longer",
                key="leg.axial_modes",
                value=leg.axial_modes,
                allowed="1 to 4; or a drive that gives way (servo)",
            )


def _held_by_others(robot: Robot, pure: Mask) -> bool:
    """Test whether the drives that hold a position leave the platform no motion at home."""
    legs = kinematics.rigid_limbs(robot)
    loose = pure[:, None] & (legs.state == DRIVEN)
    others = replace(legs, state=np.where(loose, FREE, legs.state).astype(legs.state.dtype))
    return kinematics.mobility(others).locked_platform.shape[1] == 0


def lock(
    robot: Robot,
    simulation: Simulation,
    at: kinematics.RigidPoses,
    load: Load | None = None,
    time: float = 0.0,
    *,
    per_loss: float,
) -> LockedPoses:
    """Static equilibria with the drives locked at the lengths of each of P rigid poses.

    The drives' forces and the wrench of ``load`` are those of `static_loads.rest_load` at ``time`` [s]; ``per_loss``:
    as of `robot_system`.

    Raises
    ------
    InputError
        A pure force drive.
    """
    refuse_pure_force(robot, "a static equilibrium")
    refuse_taut(robot, simulation)
    robot, system = _at_rest(robot, simulation, per_loss)
    start, acts = rigid_rest(system, at), rest_load(system, at, load, time)
    command = rest_commands(system, robot, start.q, time)
    found = equilibria(system, start, command, acts.force, acts.wrench)
    there = np.flatnonzero(found.code == FOUND)
    return LockedPoses(
        robot=robot,
        rigid=at,
        system=system,
        simulation=simulation,
        per_loss=per_loss,
        start=start,
        command=command,
        acts=acts,
        equilibria=found,
        at=there,
        m=with_friction(system, found.states[there], found.m, stuck=simulation.friction == "stuck"),
        motions=found.motions,
    )


def _model(robot: Robot, simulation: Simulation, per_loss: float) -> tuple[Robot, System]:
    """Robot without a motion of its base, and its equations at rest with substitutes of held pivots."""
    robot = robot if robot.base_motion is None else robot.replace(base_motion=None)  # poses are those of a base at rest
    system = robot_system(without_ripple(robot), simulation.replace(play="static"), per_loss, at_rest=True)
    home = kinematics.RigidPoses(robot, kinematics.home_pose(robot))
    return robot, with_substitutes(system, rigid_rest(system, home))


_at_rest = cast("Callable[[Robot, Simulation, float], tuple[Robot, System]]", lru_cache(maxsize=64)(_model))


def single_equilibrium(locked: LockedPoses) -> Equilibrium:
    """Equilibrium of a single pose; ComputationError if there is none."""
    found = locked.equilibria.one(0)
    if not found.found:
        far = locked.equilibria.code[0] == TOO_FAR
        singular = "Check the pose for a singularity and the load of the legs."
        raise ComputationError(found.reason, next_step="Give the robot a home nearer to the pose." if far else singular)
    refuse_assembly_change(locked.system, locked.robot, locked.start, locked.equilibria.states)
    return found
