"""Shortest and longest lengths of the legs over a whole box of travel and tilts, Eqs. (T2.49)-(T2.52)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import reduce
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import InputError, check_known
from flexapod.kinematics import motions
from flexapod.kinematics.leg_geometry import COORDINATES
from flexapod.kinematics.rigid_poses import reach
from flexapod.kinematics.robot import home_pose, pistons, poses_from_home, rigid_limbs, stroke_limits
from flexapod.kinematics.trajectory import Poses, rotation_matrix, turning_axes
from flexapod.model.motion import AXES

if TYPE_CHECKING:
    from flexapod.model import Robot

PARTS = (4, 8, 16)  # of each range of tilts: coarse ones first, finer ones where the limits are not yet kept
LOOKS = 5  # tilts of each range at which all travel is known in closed form
BLOCK = 512  # parts of the tilts at once


@dataclass(frozen=True, kw_only=True)
class Box:
    """Ranges of surge, sway, heave [m], roll, pitch, yaw [rad] from home, all at once or each alone.

    Attributes
    ----------
    low, high : ndarray, shape (6,)
        Ends; both zero of an axis that stays at home.
    pivot : ndarray, shape (3,)
        Point of the platform that the travel moves and the tilts leave in place, platform axes [m].
    alone : bool
        Each axis moves with the others at home.
    """

    low: Array
    high: Array
    pivot: Array = field(default_factory=lambda: np.zeros(3))
    alone: bool = False

    @classmethod
    def from_ranges(
        cls, ranges: Mapping[str, tuple[float, float]], pivot: ArrayLike = (0.0, 0.0, 0.0), *, alone: bool = False
    ) -> Box:
        """Box of ranges (low, high) [m, rad] by axis, "surge" to "yaw"; an axis that is not named stays at home.

        Raises
        ------
        InputError
            An unknown axis, an end that is not finite, ends in the wrong order.
        """
        ends = np.zeros((2, 6))
        for name, (low, high) in ranges.items():
            check_known(name, AXES, "box", "is not a coordinate")
            if not (np.isfinite(low) and np.isfinite(high) and low <= high):
                raise InputError(
                    "is not a range", key=f"box {name}", value=(low, high), allowed="finite ends, the lower one first"
                )
            ends[:, AXES.index(name)] = low, high
        return cls(low=ends[0], high=ends[1], pivot=np.asarray(pivot, dtype=float), alone=alone)

    @property
    def moving_axes(self) -> Mask:
        """Axes that do not stay at home, (6,)."""
        return (self.low != 0) | (self.high != 0)

    def separate(self) -> tuple[Box, ...]:
        """Boxes of all axes at once: itself, or one for each axis where they move alone."""
        if not self.alone or self.moving_axes.sum() < 2:
            return (replace(self, alone=False),)
        rows = np.eye(6)[self.moving_axes]
        return tuple(replace(self, low=self.low * row, high=self.high * row, alone=False) for row in rows)

    def grid_poses(self, count: int, axes: Mask | None = None) -> Array:
        """Poses (P, 6) of `count` values of each range, ends first; other axes than `axes` (6,) stay at home."""
        moves = np.ones(6, dtype=bool) if axes is None else axes
        values = [
            np.unique(np.linspace(low, high, count)) if moved else np.zeros(1)
            for low, high, moved in zip(self.low, self.high, moves, strict=True)
        ]
        return np.array(list(product(*values)))

    def middles(self, parts: int) -> tuple[Array, Array]:
        """Middles (P, 3) of `parts` parts of each range of tilts, and half the width of a part (3,) [rad]."""
        low, high = self.low[3:], self.high[3:]
        half = (high - low) / (2 * parts)
        each = [a + h * (2 * np.arange(parts) + 1) if h > 0 else np.array([a]) for a, h in zip(low, half, strict=True)]
        return np.array(list(product(*each))), half


@dataclass(frozen=True, kw_only=True)
class LegRange:
    """Lengths of n legs over a box.

    Attributes
    ----------
    least, most : ndarray, shape (n,)
        Shortest and longest that were found [m]; NaN where a leg does not reach a pose.
    least_pose, most_pose : ndarray, shape (n, 6)
        There.
    least_bound, most_bound : ndarray, shape (n,)
        No pose of the box makes a leg shorter or longer [m]; NaN where none is known.
    limits : ndarray, shape (n, 2)
        Least and largest length that stroke and piston allow [m].
    looked : int
        Tilts at which all travel was looked at in closed form; of other robots than n-UPS poses.
    parts : int
        Of each range of tilts for the bounds; 0 without bounds.
    """

    least: Array
    most: Array
    least_pose: Array
    most_pose: Array
    least_bound: Array
    most_bound: Array
    limits: Array
    looked: int
    parts: int

    @property
    def out(self) -> Mask:
        """Legs that leave their limits at a pose that was found, or do not reach it, (n,)."""
        return ~((self.least >= self.limits[:, 0]) & (self.most <= self.limits[:, 1]))

    @property
    def sure(self) -> Mask:
        """Legs that keep their limits at each pose of the box, (n,)."""
        return (self.least_bound >= self.limits[:, 0]) & (self.most_bound <= self.limits[:, 1])


def closed_form(robot: Robot) -> bool:
    """Test whether legs that stretch go from a fixed joint to the platform, and the platform has all six motions."""
    legs = rigid_limbs(robot)
    return not legs.carriage and not legs.guides and bool(legs.unknown[:, COORDINATES.index("l")].all())


def movable_axes(robot: Robot, pivot: ArrayLike = (0.0, 0.0, 0.0)) -> Mask:
    """Coordinates (6,) that can be chosen independently of each other: all six, or those that a mechanism has."""
    legs = rigid_limbs(robot)
    if not legs.guides:
        return ~legs.hub_held
    return motions.independent_axes(legs, np.zeros(6, dtype=bool), np.asarray(pivot, dtype=float))


def box_poses(robot: Robot, box: Box, count: int = 3) -> tuple[Array, Poses]:
    """Coordinates (P, 6) and poses of `count` values of each axis of a box, corners among them.

    Raises
    ------
    InputError
        The robot does not have a motion of the box.
    """
    rows, path = [], []
    for one in box.separate():
        rows.append(one.grid_poses(count))
        path.append(poses_from_home(robot, rows[-1], _commanded_axes(robot, one), one.pivot))
    if len(path) == 1:
        return rows[0], path[0]
    position, rotation = (np.concatenate([getattr(x, name) for x in path]) for name in ("position", "rotation"))
    return np.concatenate(rows), Poses.at_rest(position, rotation)


def _commanded_axes(robot: Robot, box: Box) -> Mask | None:
    return None if not rigid_limbs(robot).guides else box.moving_axes


def length_limits(robot: Robot) -> Array:
    """Least and largest length (n, 2) [m] that stroke and piston of the legs allow, Eqs. (T2.37)-(T2.38)."""
    limits, (mouth, piston) = stroke_limits(robot), pistons(robot)
    most = np.where(mouth > 0, mouth + piston, np.inf)
    return np.stack([np.maximum(limits[:, 0], mouth), np.minimum(limits[:, 1], most)], axis=1)


@dataclass(frozen=True, kw_only=True)
class Spans:
    """Legs as vectors between joints over a box: `foot` + travel + R `arm`, world axes, (n, 3) [m], Eq. (T2.49)."""

    foot: Array
    arm: Array

    @classmethod
    def from_robot(cls, robot: Robot, pivot: Array) -> Spans:
        """Numbers of n-UPS about a pivot, platform axes."""
        home = home_pose(robot)
        place = home.position[0] + home.rotation[0] @ pivot
        return cls(foot=place - robot.base_joints, arm=(robot.platform_joints - pivot) @ home.rotation[0].T)

    def part(self, legs: NDArray[np.intp]) -> Spans:
        """Some of the legs."""
        return Spans(foot=self.foot[legs], arm=self.arm[legs])

    def turned_arms(self, angles: Array) -> Array:
        """Arms (P, n, 3) at tilts (P, 3)."""
        return self.arm @ rotation_matrix(angles).swapaxes(1, 2)


def extremes(spans: Spans, box: Box, angles: Array) -> tuple[Array, Array, Array, Array]:
    """Shortest and longest lengths (P, n) [m] over all travel at tilts (P, 3), and where (P, n, 3), Eq. (T2.50)."""
    here, low, high = spans.foot + spans.turned_arms(angles), box.low[:3], box.high[:3]
    near = np.clip(-here, low, high)
    far = np.where(np.abs(here + low) > np.abs(here + high), low, high)
    return np.linalg.norm(here + near, axis=-1), np.linalg.norm(here + far, axis=-1), near, far


def length_bounds(spans: Spans, box: Box, parts: int) -> tuple[Array, Array]:
    """Lengths (n,) [m] that no pose of a box makes a leg fall below, or exceed, Eqs. (T2.51)-(T2.52).

    Parameters
    ----------
    spans : Spans
    box : Box
        All axes at once.
    parts : int
        Of each range of tilts.
    """
    middles, half = box.middles(parts)
    arm, total = np.linalg.norm(spans.arm, axis=1), half.sum()
    bend = arm * total**2 / 2
    corners = np.array(list(product(*(np.unique(ends) for ends in zip(box.low[:3], box.high[:3], strict=True)))))
    least, most = np.full(len(arm), np.inf), np.zeros(len(arm))
    for first in range(0, len(middles), BLOCK):
        angles = middles[first : first + BLOCK]
        carried, axes = spans.turned_arms(angles), turning_axes(angles) * half
        here = spans.foot + carried
        near = here + np.clip(-here, box.low[:3], box.high[:3])
        length, slope = _slopes(near, carried, axes)
        least = np.minimum(least, (length - np.minimum(slope + bend, arm * total)).min(axis=0))
        for corner in corners:
            length, slope = _slopes(here + corner, carried, axes)
            second = (arm * total) ** 2 / (2 * np.where(length > 0, length, np.nan))
            most = np.fmax(most, (length + np.fmin(slope + bend + second, arm * total)).max(axis=0))
    return np.maximum(least, 0.0), most


def _slopes(span: Array, carried: Array, axes: Array) -> tuple[Array, Array]:
    """Lengths (P, n) of `span` (P, n, 3), and sums of what each tilt by half a part adds to them to first order."""
    length = np.linalg.norm(span, axis=-1)
    moment = np.cross(carried, span) @ axes  # length times change by each of the three
    return length, np.divide(np.abs(moment).sum(axis=-1), length, out=np.zeros_like(length), where=length > 0)


def leg_range(robot: Robot, box: Box, limits: Array | None = None, parts: tuple[int, ...] = PARTS) -> LegRange:
    """Lengths of the legs over a whole box, for sure where they are vectors between joints.

    Parameters
    ----------
    robot : Robot
    box : Box
    limits : ndarray, shape (n, 2), optional
        Least and largest length of the legs [m]; default: what stroke and piston allow.
    parts : tuple of int
        Of each range of tilts, coarse ones first: finer ones for legs whose limits are neither kept nor left.

    Returns
    -------
    LegRange

    Raises
    ------
    InputError
        The robot does not have a motion of the box.
    """
    limits = length_limits(robot) if limits is None else limits
    if not closed_form(robot):
        return _range_of_poses(robot, box, limits)
    spans = Spans.from_robot(robot, box.pivot)
    found = reduce(_join_ranges, (_looked_range(spans, one, limits) for one in box.separate()))
    return _add_bounds(spans, box.separate(), found, parts)


def _add_bounds(spans: Spans, boxes: tuple[Box, ...], found: LegRange, parts: tuple[int, ...]) -> LegRange:
    """The range with its bounds, refined for legs that are neither within their limits nor out of them."""
    legs = np.arange(len(found.least))
    for count in parts:
        bounds = [length_bounds(spans.part(legs), one, count) for one in boxes]
        least, most = found.least_bound.copy(), found.most_bound.copy()
        least[legs] = np.min([pair[0] for pair in bounds], axis=0)
        most[legs] = np.max([pair[1] for pair in bounds], axis=0)
        found = replace(found, least_bound=least, most_bound=most, parts=count)
        legs = np.flatnonzero(~found.sure & ~found.out)
        if not legs.size:
            break
    return found


def _looked_range(spans: Spans, box: Box, limits: Array) -> LegRange:
    tilts = box.grid_poses(LOOKS, np.arange(6) >= 3)[:, 3:]
    least, most, near, far = extremes(spans, box, tilts)
    legs, low, high = np.arange(len(limits)), least.argmin(axis=0), most.argmax(axis=0)
    unknown = np.full(len(limits), np.nan)
    return LegRange(
        least=least[low, legs],
        most=most[high, legs],
        least_pose=np.concatenate([near[low, legs], tilts[low]], axis=1),
        most_pose=np.concatenate([far[high, legs], tilts[high]], axis=1),
        least_bound=unknown,
        most_bound=unknown,
        limits=limits,
        looked=len(tilts),
        parts=0,
    )


def _range_of_poses(robot: Robot, box: Box, limits: Array) -> LegRange:
    rows, path = box_poses(robot, box)
    length = reach(robot, path).length
    legs, low, high = np.arange(len(limits)), length.argmin(axis=0), length.argmax(axis=0)
    unknown = np.full(len(limits), np.nan)
    return LegRange(
        least=length[low, legs],
        most=length[high, legs],
        least_pose=rows[low],
        most_pose=rows[high],
        least_bound=unknown,
        most_bound=unknown,
        limits=limits,
        looked=len(rows),
        parts=0,
    )


def _join_ranges(one: LegRange, other: LegRange) -> LegRange:
    """The range over two boxes, without bounds."""
    lower, higher = other.least < one.least, other.most > one.most
    return replace(
        one,
        least=np.where(lower, other.least, one.least),
        most=np.where(higher, other.most, one.most),
        least_pose=np.where(lower[:, None], other.least_pose, one.least_pose),
        most_pose=np.where(higher[:, None], other.most_pose, one.most_pose),
        looked=one.looked + other.looked,
    )
