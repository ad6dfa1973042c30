"""Travel and tilts that a robot is asked for, all poses of the box: strokes for sure, joints and room between legs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from flexapod import kinematics
from flexapod.analysis.results.bodies import clearance, joint_angle_limits, joint_angles
from flexapod.common.arrays import Array
from flexapod.common.ranking import first_largest, first_least
from flexapod.kinematics.envelope import Box, LegRange, box_poses, leg_range
from flexapod.kinematics.inverse import BETA_LIMIT
from flexapod.kinematics.robot import carriage_limits, rigid_limbs
from flexapod.model import Robot

Answer = Literal["sure", "looked", "no"]


@dataclass(frozen=True, kw_only=True)
class BoxValue:
    """Worst value of one quantity over a box.

    Attributes
    ----------
    value : float
        Worst that was found [unit]; NaN where the legs do not reach a pose.
    unit : str
    limit : float or None
        What it must keep; None without one.
    margin : float
        What is left to the limit [unit], below 0 where it is not kept: of a `sure` value at every pose of the box, of
        others at the poses that were looked at. Infinite without a limit.
    pose : tuple of float
        Surge, sway, heave [m], roll, pitch, yaw [rad] from home, where it is worst.
    leg : int
        1 to n, of two the first; 0 of the whole robot.
    sure : bool
        The margin holds at every pose of the box.
    looked : int
        Poses that were looked at; of lengths of n-UPS tilts, at each of which all travel is known in closed form.
    """

    value: float
    unit: str
    limit: float | None
    margin: float
    pose: tuple[float, ...]
    leg: int
    sure: bool
    looked: int

    @property
    def is_kept(self) -> bool:
        """Test whether the limit is kept; never where the value is not a number."""
        return self.margin >= 0 and not np.isnan(self.value)


@dataclass(frozen=True, kw_only=True)
class Envelope:
    """Strokes, joints, room between legs and singularity over a box of travel and tilts.

    Attributes
    ----------
    shortest, longest : BoxValue
        Length of the leg with the least margin to what stroke and piston allow.
    carriage : BoxValue or None
        Place of the carriage with the least margin to its ends, as the study file counts it [m, of a crank rad].
    base_joint, platform_joint : BoxValue
        Turn since home of the joint with the least margin to its largest angle, or the largest turn.
    fold : BoxValue
        Angle of a joint that must stay below 85 deg.
    clearance : BoxValue or None
        Least distance of two legs; None where no legs could meet.
    singularity : BoxValue
        Smallest singular value of the scaled Jacobian; negative where the determinant has another sign than at home:
        a singular pose lies between.
    lengths : LegRange
        Of all legs, with the bounds.
    left : float
        Least share of its stroke that a leg has left to an end: for sure where `lengths_sure`, else as found. NaN
        without strokes.
    """

    shortest: BoxValue
    longest: BoxValue
    carriage: BoxValue | None
    base_joint: BoxValue
    platform_joint: BoxValue
    fold: BoxValue
    clearance: BoxValue | None
    singularity: BoxValue
    lengths: LegRange
    left: float

    @property
    def pose_limits(self) -> tuple[BoxValue, ...]:
        """Values that say whether the robot takes all poses of the box."""
        found = (self.shortest, self.longest, self.carriage, self.base_joint, self.platform_joint, self.fold)
        return tuple(value for value in (*found, self.singularity) if value is not None)

    @property
    def worst(self) -> BoxValue:
        """The length that misses its limit most, else the first other value that is not kept, else the next length."""
        length = min(self.shortest, self.longest, key=lambda value: (value.is_kept, value.margin))
        missed = [value for value in self.pose_limits if not value.is_kept]
        return length if not length.is_kept or not missed else missed[0]

    @property
    def lengths_sure(self) -> bool:
        """Test whether all legs keep their limits at every pose of the box."""
        return self.shortest.sure and self.longest.sure

    @property
    def answer(self) -> Answer:
        """Answer to "does the robot take every pose of the box".

        "no": a pose was found that it does not take. "sure": lengths keep their limits everywhere, and joints,
        carriages and determinant theirs at all poses that were looked at. "looked": no pose was found that leaves a
        limit, but lengths could do so between.
        """
        if not all(value.is_kept for value in self.pose_limits):
            return "no"
        return "sure" if self.lengths_sure else "looked"


def envelope(robot: Robot, box: Box) -> Envelope:
    """Lengths of the legs over all poses of a box, for sure, and joints, clearance, singularity at poses of it.

    Lengths of n-UPS are known in closed form for all travel at a tilt, and bounded between tilts (T2.49)-(T2.52):
    `Envelope.answer` is "sure" where the bound keeps the limits. All else, and lengths of other robots, is looked at
    at three values of each axis: 64 corners and 729 poses of six.

    Parameters
    ----------
    robot : Robot
    box : Box
        ``Box.from_ranges({"surge": (-0.015, 0.015), "roll": (-0.05, 0.05)}, pivot=robot.payload.tool, alone=False)``
        in m and rad, the pivot in platform axes ((0, 0, 0) is the platform's own); an axis that is not named stays at
        home. `kinematics.envelope.movable_axes` says which axes a mechanism of fewer motions has.

    Returns
    -------
    Envelope

    Raises
    ------
    InputError
        The robot does not have a motion of the box.
    """
    rows, path = box_poses(robot, box)
    at = kinematics.RigidPoses(robot, path)
    lengths, reached = leg_range(robot, box), at.reach
    look = _Look(rows)
    joints = joint_angles(robot, at.directions, path.rotation)
    base, platform = (look.most(joints[..., k], joint_angle_limits(robot)[:, k], "rad") for k in (0, 1))
    folds = np.max([np.zeros_like(reached.length), *reached.angles.values()], axis=0)
    return Envelope(
        shortest=_length(lengths, 0),
        longest=_length(lengths, 1),
        carriage=_carriage(robot, reached.carriage, look),
        base_joint=base,
        platform_joint=platform,
        fold=look.most(folds, np.full(robot.count, BETA_LIMIT), "rad"),
        clearance=_clearance(robot, at, look),
        singularity=_singularity(at, look),
        lengths=lengths,
        left=_left(lengths),
    )


@dataclass(frozen=True)
class _Look:
    """Poses (P, 6) that are looked at."""

    rows: Array

    def value(self, k: int, leg: int, value: float, limit: float | None, margin: float, unit: str) -> BoxValue:
        pose = tuple(map(float, self.rows[k]))
        return BoxValue(
            value=value, unit=unit, limit=limit, margin=margin, pose=pose, leg=leg, sure=False, looked=len(self.rows)
        )

    def most(self, values: Array, limits: Array, unit: str) -> BoxValue:
        """The value of (P, n) with the least margin to the limits (n,), or the largest; NaN is the worst."""
        limited = np.isfinite(limits)
        over = values - (limits if limited.any() else 0.0)
        over = np.where(np.isnan(over), np.inf, over)
        k, leg = (int(i) for i in np.unravel_index(first_largest(over), over.shape))
        value = float(values[k, leg])
        margin = float(limits[leg] - value)
        return self.value(k, leg + 1, value, float(limits[leg]) if limited[leg] else None, margin, unit)


def _length(found: LegRange, end: int) -> BoxValue:
    """The shortest (0) or longest (1) leg with the least margin, of legs without limits the farthest."""
    side = 1.0 if end else -1.0
    value, bound, poses = (
        (found.most, found.most_bound, found.most_pose) if end else (found.least, found.least_bound, found.least_pose)
    )
    limits = found.limits[:, end]
    limited = np.isfinite(limits).any() if end else (limits > 0).any()
    sure = side * bound <= side * limits
    left = side * (limits - np.where(sure, bound, value))
    rank = left if limited else -side * value
    leg = int(np.argmin(np.where(np.isnan(rank), -np.inf, rank)))
    return BoxValue(
        value=float(value[leg]),
        unit="m",
        limit=float(limits[leg]) if limited and np.isfinite(limits[leg]) else None,
        margin=float(left[leg]) if limited else np.inf if value[leg] > 0 else np.nan,
        pose=tuple(map(float, poses[leg])),
        leg=leg + 1,
        sure=bool(sure.all()),
        looked=found.looked,
    )


def _left(found: LegRange) -> float:
    """Least share of the stroke that is left."""
    stroke = np.where(np.isfinite(found.limits[:, 1]), np.ptp(found.limits, axis=1), np.nan)
    sure = found.sure.all()
    least, most = (found.least_bound, found.most_bound) if sure else (found.least, found.most)
    left = np.minimum(least - found.limits[:, 0], found.limits[:, 1] - most)
    if np.isnan(left).any():
        return np.nan
    return float(np.nanmin(left / stroke)) if np.isfinite(stroke).any() else np.nan


def _carriage(robot: Robot, place: Array, look: _Look) -> BoxValue | None:
    kind, limits = rigid_limbs(robot).carriage, carriage_limits(robot)
    if not kind:
        return None
    left = np.minimum(place - limits[:, 0], limits[:, 1] - place)
    rank = left if np.isfinite(limits).any() else -np.abs(place)
    rank = np.where(np.isnan(rank), -np.inf, rank)
    k, leg = (int(i) for i in np.unravel_index(first_least(rank), rank.shape))
    value, (first, last) = float(place[k, leg]), limits[leg]
    limit = float(first if value - first < last - value else last)
    unit = "rad" if kind == "crank" else "m"
    return look.value(k, leg + 1, value, limit if np.isfinite(limit) else None, float(left[k, leg]), unit)


def _clearance(robot: Robot, at: kinematics.RigidPoses, look: _Look) -> BoxValue | None:
    nearest = clearance(robot, at.poses.place(robot.platform_joints), at.directions, at.reach.length)
    if nearest is None:
        return None
    gap = np.where(np.isnan(nearest.gap), -np.inf, nearest.gap)
    k = first_least(gap)
    return look.value(k, int(nearest.legs[k][0]) + 1, float(nearest.gap[k]), None, np.inf, "m")


def signed_singularity(at: kinematics.RigidPoses) -> Array:
    """Smallest singular values (P,), negative where the determinant has another sign than at home.

    A singular pose lies between home and such a pose, however large its own value is.
    """
    home, found = kinematics.singularity(at.robot, kinematics.home_pose(at.robot)), at.singularity
    return found.smallest_singular_value * np.where(found.determinant * home.determinant[0] < 0, -1.0, 1.0)


def _singularity(at: kinematics.RigidPoses, look: _Look) -> BoxValue:
    if at.reach.lost.any():
        k = int(np.argmax(at.reach.lost))
        return look.value(k, 0, np.nan, 0.0, np.nan, "1")
    signed = signed_singularity(at)
    k = first_least(signed)
    return look.value(k, 0, float(signed[k]), 0.0, float(signed[k]), "1")
