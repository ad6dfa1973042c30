"""The rigid path of a motion as Chebyshev series: poses and legs, each with two derivatives, made once."""

from __future__ import annotations

import numpy as np

from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import InputError
from flexapod.common.piecewise_chebyshev import NODES, Pieces
from flexapod.kinematics.closures import ClosureMotion
from flexapod.kinematics.discontinuities import motion_breaks, path_knots
from flexapod.kinematics.laws import Law
from flexapod.kinematics.leg_geometry import COORDINATES, Limbs
from flexapod.kinematics.rigid_poses import RigidPoses
from flexapod.kinematics.robot import poses, poses_with_legs, rigid_limbs
from flexapod.kinematics.trajectory import Poses
from flexapod.model import Motion, Robot

SAME = 1e-12  # of a path's duration: an instant so near to a jump is that of the jump


class PathSeries:
    """The rigid robot along a motion, from 0 to `duration` [s], at whatever instants.

    Legs with a closed form are computed where they are asked for. Others are solved at few instants between `knots`;
    where they do not reach one of these, and outside of the path, they are solved at the instants themselves.
    """

    def __init__(self, robot: Robot, motion: Motion, duration: float) -> None:
        self.robot: Robot = robot
        self.motion: Motion = motion
        self.duration: float = duration
        self.knots: Array = path_knots(motion, duration)
        self.limbs: Limbs = rigid_limbs(robot)
        self._jumps = np.array(motion_breaks(motion).jumps)
        with_series = not self.limbs.plain or self.limbs.guides
        self._pieces = Pieces(self._groups, self.knots) if with_series else None
        self._constraints: Pieces | None = None
        lengths = {"l", "chi"} if self.limbs.carriage == "slider" else {"l"}
        self.length: float = float(self.limbs.home[:, COORDINATES.index("l")].mean())
        unit = [1.0 if name in lengths else self.length for name in COORDINATES] * len(self.limbs)
        self._places = np.array([1.0] * 3 + [self.length] * 9 + unit)  # a group has one physical scale
        self._rates = np.array([1.0] * 3 + [self.length] * 3 + unit)

    @property
    def has_series(self) -> bool:
        """Test whether the path has no closed form, and its series have not been given up."""
        return self._pieces is not None

    def exact(self, t: Array) -> RigidPoses:
        """The rigid robot at instants (T,), solved there; raises as `robot.poses`."""
        return RigidPoses(self.robot, poses(self.robot, self.motion, t))

    def at(self, t: Array) -> RigidPoses:
        """The rigid robot at instants (T,); raises as `robot.poses`."""
        pieces = self._pieces
        if pieces is None or not len(t) or not (t.min() >= 0 and t.max() <= self.duration):
            return self.exact(t)
        try:
            found = list(pieces(t))
            there = self._near_jumps(t)
            if there.any():
                found = [part.copy() for part in found]
                for part, values in zip(found, self._groups(t[there]), strict=True):
                    part[there] = values
        except _Unreached:
            self._pieces = None
            return self.exact(t)
        return self._rigid(found)

    def make(self, count: int) -> None:
        """Make the series if the path will be asked for at so many instants that it pays; nothing is refused here."""
        if self._pieces is None or NODES * (len(self.knots) - 1) > count:
            return
        try:
            self._pieces(np.linspace(0.0, self.duration, count))
        except _Unreached:
            self._pieces = None

    def constraints(self, t: Array) -> Array:
        """Constraints of the locked legs, as of `RigidPoses.constraints`, where the path has series."""
        if self._constraints is None:
            self._constraints = Pieces(lambda t: [self.at(t).constraints], self.knots)
        return self._constraints(t)[0]

    def _near_jumps(self, t: Array) -> Mask:
        return np.asarray((np.abs(t[:, None] - self._jumps) <= SAME * self.duration).any(axis=1))

    def _groups(self, t: Array) -> list[Array]:
        """Places, rates and accelerations of platform and legs at instants, in one unit each."""
        try:
            path, moved = poses_with_legs(self.robot, self.motion, t)
        except InputError as error:
            raise _Unreached from error
        T = len(t)
        if not all(np.isfinite(x).all() for x in moved[:3]):
            raise _Unreached
        parts = (
            (path.position, path.rotation, moved.q),
            (path.velocity, path.omega, moved.q_dot),
            (path.acceleration, path.alpha, moved.q_ddot),
        )
        units = self._places, self._rates, self._rates
        return [
            np.concatenate([x.reshape(T, -1) for x in part], axis=1) * unit
            for part, unit in zip(parts, units, strict=True)
        ]

    def _rigid(self, groups: list[Array]) -> RigidPoses:
        """The rigid robot from its groups."""
        units = self._places, self._rates, self._rates
        place, rate, change = (values / unit for values, unit in zip(groups, units, strict=True))
        T, n = len(place), len(self.limbs)
        path = Poses(
            position=place[:, :3],
            rotation=place[:, 3:12].reshape(T, 3, 3),
            velocity=rate[:, :3],
            omega=rate[:, 3:6],
            acceleration=change[:, :3],
            alpha=change[:, 3:6],
        )
        q, q_dot, q_ddot = (x.reshape(T, n, -1) for x in (place[:, 12:], rate[:, 6:], change[:, 6:]))
        still = np.zeros((T, 6))
        q.flags.writeable = False
        return RigidPoses(self.robot, path, moved=ClosureMotion(q, q_dot, q_ddot, Law(still, still, still)))


class _Unreached(Exception):
    """Legs do not reach an instant at which a series was to be made."""
