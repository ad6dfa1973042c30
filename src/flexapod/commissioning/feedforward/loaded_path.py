"""Where the loaded robot stands that is commanded a path, at rest or with its inertia, Eqs. (T22.1)-(T22.2)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexapod import kinematics
from flexapod.analysis.results.poses import BATCH, coordinates_of
from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import ComputationError, InputError
from flexapod.kinematics import Law, Poses
from flexapod.kinematics.rotations import difference, matrix, quaternion
from flexapod.model import AXES, ConstantWrench, ForceDrive, Robot, Study
from flexapod.solve.batch import RestStates, residual
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.rigid_motion import rigid_motion
from flexapod.solve.statics.block_arrow import arrow_solve
from flexapod.solve.statics.locked_robot import LockedPoses
from flexapod.solve.system import System

__all__ = ["LoadedPath", "apart", "inertia_forces", "refuse_missing"]

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

    def wanted(self, t: Array) -> Law:
        """Coordinates of the motion (T, 6)."""
        return kinematics.coordinates(self.study.motion, t)

    def rigid(self, law: Law, t: Array) -> Poses:
        """Poses of the rigid robot with these coordinates."""
        return kinematics.poses_of_law(self.study.robot, self.study.motion, law, t)

    def loaded(self, law: Law, t: Array) -> Poses:
        """Poses of the platform frame of the loaded robot that is commanded these coordinates (T, 6), at rest.

        Raises
        ------
        ComputationError
            There is no equilibrium at an instant.
        """
        path, at = self.rigid(law, t), []
        for part in self._alike(t):
            at.append(self._at(path.part(part), t[part]))
        pose = np.concatenate(at)
        R = matrix(pose[:, 3:])
        return Poses.at_rest(pose[:, :3] - R @ self.study.robot.com, R)

    def seen(self, path: Poses) -> Array:
        """Coordinates (T, 6) in which a miss is measured: about the pivot, where not all are commanded at the tool."""
        robot = self.study.robot
        return coordinates_of(robot, path, self.study.motion.pivot if self.axes.all() else robot.tool)

    def gain(self, law: Law, t: Array) -> Array:
        """How the `seen` coordinates of the rigid robot grow with those that are commanded, (T, m, m), Eq. (T22.1)."""
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
        return self.seen(self.rigid(Law(there, law.rate, law.acceleration), t))

    def _alike(self, t: Array) -> list[slice]:
        """Instants that are computed together: of what changes with time each by itself."""
        robot, wrench = self.study.robot, self.study.load.wrench
        drives = any(isinstance(leg.drive, ForceDrive) and leg.drive.time is not None for leg in robot.legs)
        heat = robot.heat is not None and robot.heat.time is not None
        same = (wrench is None or isinstance(wrench, ConstantWrench)) and not drives and not heat
        step = BATCH if same else 1
        return [slice(first, min(first + step, len(t))) for first in range(0, len(t), step)]

    def _at(self, path: Poses, t: Array) -> Array:
        """Poses (T, 7) of the payload under one load."""
        study = self.study
        locked = locked_poses(study.robot, study.simulation, path, study.load, float(t[0]))
        refuse_missing(locked, t)
        if not self.inertia:
            return locked.equilibria.states.pose
        states = locked.equilibria.states
        r, payload = inertia_forces(locked.system, locked.robot, states, path, locked.acts.wrench)
        nothing = np.zeros((len(t), *states.q.shape[1:]))
        step = arrow_solve(locked.system, locked.m, r, payload, np.zeros_like(states.lam), nothing)
        return states.moved(step.dq, step.dy).pose


def refuse_missing(locked: LockedPoses, t: Array) -> None:
    """Raise ComputationError if there is no equilibrium at one of the instants (T,) of a path."""
    if len(locked.at) < len(t):
        k = int(np.flatnonzero(locked.equilibria.code)[0])
        raise ComputationError(
            f"{locked.equilibria.one(k).reason}, at t = {t[k]:.6g} s of the path",
            next_step="Reduce the motion or the load",
        )


def inertia_forces(system: System, robot: Robot, states: RestStates, path: Poses, wrench: Array) -> tuple[Array, Array]:
    """What a rigid path (T,) adds by its rates to the balances of legs (T, legs, n) and payload (T, 6), Eq. (T22.2)."""
    rates = rigid_motion(system, robot, path)[1]
    still = np.zeros((len(path), system.legs, system.ports.size))
    moving = residual(system, states, still, rates.v[..., system.ports], wrench, rates)
    resting = residual(system, states, still, still, wrench)
    return moving[0] - resting[0], moving[1] - resting[1]


def apart(robot: Robot, path: Poses, wanted: Poses) -> tuple[Array, Array]:
    """Displacement and rotation (P, 3) each of the tool from where it should be."""
    turned = difference(quaternion(path.rotation), quaternion(wanted.rotation))
    return path.place(robot.tool) - wanted.place(robot.tool), turned
