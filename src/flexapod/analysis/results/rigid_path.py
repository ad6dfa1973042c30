"""The rigid robot on its commanded path, computed once for checks, estimates and results."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from flexapod import kinematics
from flexapod.analysis.results.remarks import remark
from flexapod.common.arrays import Array
from flexapod.kinematics.closures import Closed, ClosureMotion
from flexapod.kinematics.inverse import LegState, lengths_of
from flexapod.kinematics.robot import leg_map
from flexapod.model import ActuatorStudy, Robot, Study
from flexapod.solve.result_rows import balances
from flexapod.solve.statics.ideal_robot import RobotForces, is_hexapod, rigid_errors, rigid_forces
from flexapod.solve.statics.path_forces import PathForces

if TYPE_CHECKING:
    from flexapod.solve.kernel import Kernel

FEWEST, MOST = 2000, 50_000  # intervals at which a path is looked at
SAME = 1e-9  # instants nearer to each other than this part of the step between them are the same


def path_instants(study: Study | ActuatorStudy) -> Array:
    """Instants at which a path is looked at [s]: those of the output, at least 2001, at most 50001."""
    count = int(np.clip(study.duration / study.simulation.output_step, FEWEST, MOST).round())
    return np.linspace(0.0, study.duration, count + 1)


def open_force_words(forces: RobotForces) -> list[str]:
    """Sentence on the forces that rigid statics does not determine; empty where it determines all."""
    count = forces.open_forces
    if not count:
        return []
    left = f"{count} force{'s' * (count > 1)}"
    return [remark("open forces", forces=left)]


class RigidPath(kinematics.RigidPoses):
    """The commanded path of a robot's study at T instants; each part is computed on request, once.

    Parameters
    ----------
    study : Study
    time : ndarray, shape (T,), optional
        [s]; default: `path_instants`.
    poses : Poses, optional
        Of the platform frame at these instants, where they are others than those of the motion.
    loads : PathForces, optional
        Series of this path and of its forces, where they are known.
    """

    def __init__(
        self,
        study: Study,
        time: Array | None = None,
        poses: kinematics.Poses | None = None,
        loads: PathForces | None = None,
    ) -> None:
        self.study: Study = study
        self.robot: Robot = study.robot
        self.time: Array = path_instants(study) if time is None else time
        self._loads = loads
        if poses is not None:
            self.poses = poses

    @cached_property
    def loads(self) -> PathForces:
        """Series of the path's forces, shared by all of its instants."""
        series = kinematics.PathSeries(self.robot, self.study.motion, self.study.duration)
        return PathForces(series) if self._loads is None else self._loads

    @property
    def series(self) -> kinematics.PathSeries:
        """The path as series, shared by all of its instants."""
        return self.loads.path

    @cached_property
    def poses(self) -> kinematics.Poses:
        """Poses of the platform frame with rates and accelerations."""
        found = self.series.at(self.time)
        self.moved: ClosureMotion | None = found.moved
        return found.poses

    @cached_property
    def closed_legs(self) -> Closed:
        """Coordinates of the legs by their closures, NaN where they do not reach."""
        _ = self.poses  # with them comes what the legs do
        return super().closed_legs

    @cached_property
    def legs(self) -> LegState:
        """Legs with two derivatives, arrays (T, n); raises as `RigidPoses.legs`."""
        _ = self.poses
        return super().legs

    @property
    def coarse_paths(self) -> Iterator[RigidPath]:
        """The path at few instants, ever farther from home, where it leads far; none where its poses are known."""
        looks = () if "poses" in self.__dict__ else kinematics.first_looks(self.robot, self.study.motion, self.time)
        return (RigidPath(self.study, t, self.series.exact(t).poses) for t in (self.time[at] for at in looks))

    @cached_property
    def base(self) -> kinematics.Placed | None:
        """Place of a base that is moved; poses are relative to it, and the rigid robot moves with it."""
        return kinematics.base_placed(self.robot, self.time)

    def place(self, point: Array) -> Array:
        """A point (3,) of the platform frame in the world, (T, 3)."""
        at = self.poses.place(point)
        return at if self.base is None else self.base.carried(at, self.poses.rotation)[0]

    @cached_property
    def rotation(self) -> Array:
        """Platform axes to world axes, (T, 3, 3)."""
        return self.poses.rotation if self.base is None else self.base.rotation @ self.poses.rotation

    @cached_property
    def wrench(self) -> Array:
        """Load at the tool, world axes, (T, 6)."""
        return kinematics.wrench(self.study.load, self.time)

    @cached_property
    def forces(self) -> RobotForces:
        """Forces of drives and joints."""
        if self.is_commanded:
            return self.loads.forces(self, self.time, self.wrench)
        return rigid_forces(self, self.wrench)

    @cached_property
    def lengths(self) -> Array:
        """Lengths of the legs, (T, n) [m]: those of `legs`, to the bit."""
        _ = self.poses
        if "legs" in self.__dict__ or not kinematics.rigid_limbs(self.robot).plain:
            return self.legs.length
        return lengths_of(leg_map(self.robot), self.poses)

    def forces_of_simulation(self, kernel: Kernel) -> RobotForces:
        """Forces of drives and on the platform; of six legs UPS by compiled loops, where the equations are compiled."""
        if "forces" in self.__dict__ or kernel.library is None or not is_hexapod(self.robot):
            return self.forces
        found = balances(kernel, self, self.wrench)
        return RobotForces(drive_force=found["drive_force"], joint_force=found["joint_force"])

    @cached_property
    def constraints(self) -> Array:
        """Constraints of the locked legs on the platform, as of `RigidPoses`."""
        return self.series.constraints(self.time) if self.is_commanded else super().constraints

    @cached_property
    def displacement_by_error(self) -> Array:
        """Displacement of the payload for unit errors of what is held, (T, legs, 8, 6); see `rigid_errors`."""
        return self.loads.errors(self, self.time) if self.is_commanded else rigid_errors(self)

    @property
    def is_commanded(self) -> bool:
        """Test whether the poses are those of the path's series."""
        _ = self.poses  # with them comes what the legs do
        return self.moved is not None

    def at(self, t: Array) -> RigidPath:
        """The path at other instants: this one, or what is known of its poses, where it has them."""
        count = len(t)
        known = self.time[:count]
        if len(known) != count or np.abs(known - t).max() > SAME * (self.time[-1] / len(self.time)):
            return RigidPath(self.study, t, loads=self.loads)
        if count == len(self.time):
            return self
        found = RigidPath(self.study, t, self.poses.part(slice(0, count)), self.loads)
        found.moved = None if self.moved is None else self.moved.part(slice(0, count))
        return found
