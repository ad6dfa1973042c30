"""Rigid forces along a path, and what errors do to the payload there, as Chebyshev series made once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError, InputError
from flexapod.common.piecewise_chebyshev import Pieces
from flexapod.kinematics.leg_geometry import COORDINATES, DRIVEN
from flexapod.solve.statics.ideal_robot import RobotForces, has_closed_form, rigid_errors, rigid_forces

CHI = COORDINATES.index("chi")


class PathForces:
    """Rigid forces along a path, of robots without a closed form as series.

    Forces are linear in the wrench at the tool, which may jump where the path does not: they are those without a wrench
    and those by unit wrenches, of which each is made when it is asked for.

    Parameters
    ----------
    path : PathSeries
    """

    def __init__(self, path: kinematics.PathSeries) -> None:
        self.path: kinematics.PathSeries = path
        legs = path.limbs
        turning = (legs.state[:, CHI] == DRIVEN) & (legs.carriage == "crank")
        drives = np.where(turning, 1 / path.length, 1.0)  # to newtons: a group has one physical scale
        self._unit = np.concatenate([drives, np.ones(3 * len(legs)), np.full(3 * len(legs), 1 / path.length)])
        self._made: dict[int | str, Pieces] = {}
        self._open = 0
        payload = path.robot.payload
        self._size = 1.0 if payload is None else 1.0 + 10.0 * payload.mass  # of a wrench: about as large as the weight

    def forces(self, at: kinematics.RigidPoses, t: Array, wrench: Array) -> RobotForces:
        """Forces of `rigid_forces` at instants (T,) of the path; `at`: the robot there; `wrench` (T, 6)."""
        if self._closed:
            return rigid_forces(at, wrench)
        try:
            found = self._series(-1, self._by_wrench(np.zeros(6)))(t)[0]
            for k in np.flatnonzero(wrench.any(axis=0)).tolist():
                more = self._series(k, self._by_wrench(self._size * np.eye(6)[k]))(t)[0]
                found = found + wrench[:, k, None] / self._size * more
        except (ComputationError, InputError):  # at nodes: words are those of the instants
            return rigid_forces(at, wrench)
        n = len(self.path.limbs)
        drive, force, moment = np.split(found / self._unit, [n, 4 * n], axis=1)
        return RobotForces(
            drive_force=drive,
            joint_force=force.reshape(-1, n, 3),
            joint_moment=moment.reshape(-1, n, 3),
            open_forces=self._open,
        )

    def errors(self, at: kinematics.RigidPoses, t: Array) -> Array:
        """Displacements by errors of `rigid_errors` at instants (T,) of the path."""
        if self._closed:
            return rigid_errors(at)
        length = self.path.length
        slides = {"l", "chi"} if self.path.limbs.carriage == "slider" else {"l"}
        unit = np.array([1.0 if name in slides else 1 / length for name in COORDINATES])[:, None]
        unit = unit * np.array([1.0, 1.0, 1.0, length, length, length])

        def compute(t: Array) -> list[Array]:
            return [rigid_errors(self.path.at(t)) * unit]

        try:
            return self._series("errors", compute)(t)[0] / unit
        except (ComputationError, InputError):
            return rigid_errors(at)

    @property
    def _closed(self) -> bool:
        return not self.path.has_series or has_closed_form(self.path.robot)

    def _series(self, name: int | str, compute: Callable[[Array], list[Array]]) -> Pieces:
        if name not in self._made:
            self._made[name] = Pieces(compute, self.path.knots)
        return self._made[name]

    def _by_wrench(self, wrench: Array) -> Callable[[Array], list[Array]]:
        """Forces by a constant wrench as rows, less those without one; those without one for a wrench of zero."""

        def rows(at: kinematics.RigidPoses, wrench: Array) -> Array:
            found, T = rigid_forces(at, wrench), len(at.poses)
            self._open = found.open_forces
            moment = np.zeros_like(found.joint_force) if found.joint_moment is None else found.joint_moment
            parts = (found.drive_force, found.joint_force, moment)
            return np.concatenate([x.reshape(T, -1) for x in parts], axis=1) * self._unit

        def compute(t: Array) -> list[Array]:
            at = self.path.at(t)
            found = rows(at, np.zeros(6))
            return [rows(at, wrench) - found if wrench.any() else found]

        return compute
