"""Poses of the loaded robot on a commanded path, and use of its drives' limits, Eqs. (T22.1)-(T22.2), (T22.17).

The robot is at rest at each pose, or with the inertia of its path.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexapod import kinematics
from flexapod.analysis.checks.screws import motor_torque
from flexapod.analysis.results.poses import BATCH, pose_coordinates
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import ComputationError, InputError
from flexapod.common.units import quantity
from flexapod.kinematics import COORDINATES, DRIVEN, Law, Poses, RigidPoses
from flexapod.kinematics.rotations import blocks, difference, quaternion
from flexapod.model import AXES, ConstantWrench, Robot, Study
from flexapod.solve.batch import Rates, RestStates, residual
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.rigid_motion import rigid_motion
from flexapod.solve.statics.assembly_mode import platform_poses
from flexapod.solve.statics.block_arrow import arrow_solve
from flexapod.solve.statics.locked_robot import LockedPoses
from flexapod.solve.system import System

WORST = 1e8  # condition of what the tool does by what is commanded
STEP = 1e-6  # m, rad: of differences, exact to its square


@dataclass(frozen=True)
class LoadedPath:
    """A robot on paths that take the place of a study's motion, loaded and, with `inertia`, accelerated.

    `study`: with what counts of its errors of geometry and heat.
    """

    study: Study
    inertia: bool = False

    @cached_property
    def axes(self) -> Mask:
        """Coordinates that are commanded, (6,)."""
        return kinematics.commanded_axes(self.study.robot, self.study.motion)

    def target_law(self, t: Array) -> Law:
        """Coordinates of the motion (T, 6)."""
        return kinematics.coordinates(self.study.motion, t)

    def rigid_poses(self, law: Law, t: Array) -> Poses:
        """Poses of the rigid robot with these coordinates."""
        return kinematics.poses_of_law(self.study.robot, self.study.motion, law, t)

    def loaded_poses(self, law: Law, t: Array) -> Poses:
        """Poses of the platform frame of the loaded robot that is commanded these coordinates (T, 6), at rest.

        Raises
        ------
        ComputationError
            There is no equilibrium at an instant.
        """
        path, at = self.rigid_poses(law, t), []
        for part in blocks(len(t), BATCH if is_permanent(self.study) else 1):  # what changes with time, each by itself
            at.append(self._at(path.part(part), t[part]))
        return platform_poses(self.study.robot, np.concatenate(at))

    def tool_coordinates(self, path: Poses) -> Array:
        """Coordinates (T, 6) in which a miss is measured: about the pivot, where not all are commanded at the tool."""
        robot = self.study.robot
        return pose_coordinates(robot, path, self.study.motion.pivot if self.axes.all() else robot.tool)

    def command_gain(self, law: Law, t: Array) -> Array:
        """Jacobian of the rigid robot's `tool_coordinates` by the commanded ones, (T, m, m), Eq. (T22.1)."""
        asked = np.flatnonzero(self.axes)
        if asked.size == 6:
            return np.broadcast_to(np.eye(6), (len(t), 6, 6))
        columns = []
        for k in asked:
            shifted = [self._shifted(law, t, int(k), way)[:, asked] for way in (STEP, -STEP)]
            columns.append((shifted[0] - shifted[1]) / (2 * STEP))
        found = np.stack(columns, axis=-1)
        if not (np.linalg.cond(found) < WORST).all():
            raise InputError(
                "does not say where the tool is: what is commanded does not move it that way",
                file=self.study.path,
                key="motion.independent",
                value=[axis for axis, asked in zip(AXES, self.axes, strict=True) if asked],
                allowed="axes along and about which the tool moves",
            )
        return found

    def _shifted(self, law: Law, t: Array, k: int, way: float) -> Array:
        there = law.position.copy()
        there[:, k] += way
        return self.tool_coordinates(self.rigid_poses(Law(there, law.rate, law.acceleration), t))

    def _at(self, path: Poses, t: Array) -> Array:
        """Poses (T, 7) of the payload under one load."""
        study = self.study
        locked = locked_poses(study.robot, study.simulation, path, study.load, float(t[0]))
        refuse_missing(locked, t)
        if not self.inertia:
            return locked.equilibria.states.pose
        states = locked.equilibria.states
        rates = rigid_motion(locked.system, RigidPoses(locked.robot, path))[1]
        r, payload = inertia_forces(locked.system, states, rates, locked.acts.wrench)
        nothing = np.zeros((len(t), *states.q.shape[1:]))
        step = arrow_solve(locked.system, locked.m, r, payload, np.zeros_like(states.lam), nothing)
        return states.displace(step.dq, step.dy).pose


def is_permanent(study: Study) -> bool:
    """Test whether load, heat and drives stay what they are: at rest, only the pose says how the robot bends."""
    robot, wrench = study.robot, study.load.wrench
    heat = robot.heat is not None and robot.heat.time is not None
    tables = any(getattr(leg.drive, "time", None) is not None for leg in robot.legs)
    return (wrench is None or isinstance(wrench, ConstantWrench)) and not heat and not tables


def refuse_missing(locked: LockedPoses, t: Array) -> None:
    """Raise ComputationError if there is no equilibrium at one of the instants (T,) of a path."""
    if len(locked.at) < len(t):
        k = int(np.flatnonzero(locked.equilibria.code)[0])
        raise ComputationError(
            f"{locked.equilibria.one(k).reason}, at t = {t[k]:.6g} s of the path",
            next_step="Reduce the motion or the load",
        )


def inertia_forces(system: System, states: RestStates, rates: Rates, wrench: Array) -> tuple[Array, Array]:
    """Inertial loads of a rigid path (T,) in the balances of legs (T, legs, n) and payload (T, 6), Eq. (T22.2)."""
    still = np.zeros((len(states), system.legs, system.ports.size))
    moving = residual(system, states, still, rates.v[..., system.ports], wrench, rates)
    resting = residual(system, states, still, still, wrench)
    return moving[0] - resting[0], moving[1] - resting[1]


def tool_miss(robot: Robot, path: Poses, wanted: Poses) -> tuple[Array, Array]:
    """Displacement and rotation (P, 3) each of the tool from where it should be."""
    turned = difference(quaternion(path.rotation), quaternion(wanted.rotation))
    return path.place(robot.tool) - wanted.place(robot.tool), turned


Given = float | str | None


@dataclass(frozen=True, kw_only=True)
class DriveLimits:
    """Largest `speed` [m/s], `acceleration` [m/s^2] and `force` [N] of every drive, of cranks in rad and N m; or none.

    What screws and motors of the study are made for counts besides.
    """

    speed: float | None
    acceleration: float | None
    force: float | None

    def bounds_forces(self, robot: Robot) -> bool:
        """Test whether the limits bound forces or torques of the drives."""
        return self.force is not None or _motors(robot)

    def shares(self, path: RigidPath, force: Array | None = None) -> tuple[Array, Array]:
        """Speeds (T, any), and what grows with accelerations (T, any), each over its limit, with sign.

        `force`, (T, legs) [N]: of the drives where these are not those of the rigid robot.
        """
        robot = path.robot
        driven = kinematics.rigid_limbs(robot).state == DRIVEN
        values = np.stack([np.stack(path.legs.coordinate(name), axis=0) for name in COORDINATES], axis=-1)
        rate, bend = values[1][:, driven], values[2][:, driven]
        force = path.forces.drive_force if force is None else force
        fast = [rate / self.speed] if self.speed is not None else []
        strong = [bend / self.acceleration] if self.acceleration is not None else []
        strong += [force / self.force] if self.force is not None else []
        for i, leg in enumerate(robot.legs):
            if leg.screw is None:
                continue
            limits, rates = leg.screw.limits, (path.legs.rate[:, i], path.legs.accel[:, i])
            if limits.speed is not None:
                fast.append((rates[0] / leg.screw.per_turn * leg.screw.rotor.ratio / limits.speed)[:, None])
            if limits.force is not None:
                strong.append((force[:, i] / limits.force)[:, None])
            if limits.torque is not None:
                strong.append((motor_torque(leg.screw, force[:, i], *rates) / limits.torque)[:, None])
        none = np.zeros((len(path.time), 1))
        return np.concatenate([none, *fast], axis=1), np.concatenate([none, *strong], axis=1)


def drive_limits(study: Study, speed: Given, acceleration: Given, force: Given) -> DriveLimits:
    """The limits that are given and those of the study.

    Raises
    ------
    InputError
        None of them bounds accelerations: the least time would be 0.
    """
    kinds = {"speed": "velocity", "acceleration": "acceleration", "force": "force"}
    found: dict[str, float | None] = {}
    for (name, dimension), value in zip(kinds.items(), (speed, acceleration, force), strict=True):
        found[name] = None if value is None else quantity(value, dimension, key=name)
        if found[name] is not None and not found[name] > 0:  # type: ignore[operator]
            raise InputError("is not a limit", key=name, value=value, allowed="above 0")
    limits = DriveLimits(**found)
    if limits.acceleration is None and not limits.bounds_forces(study.robot):
        raise InputError(
            "says nowhere what its drives may do: the least time would be 0",
            file=study.path,
            key="force",
            allowed='force = "2 kN" or acceleration = "5 m/s^2" of every drive; leg.drive.limits of screws',
        )
    return limits


def _motors(robot: Robot) -> bool:
    given = [leg.screw.limits for leg in robot.legs if leg.screw is not None]
    return any(limits.force is not None or limits.torque is not None for limits in given)
