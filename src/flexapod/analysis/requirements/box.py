"""A box of poses about home, and whether the legs reach all of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from flexapod import kinematics
from flexapod.analysis.checks.reachability import REACHED, REASONS, Codes, leg_limits, rigid_codes, slider_limits
from flexapod.analysis.results.bodies import joint_angle_limits, joint_angles
from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import InputError
from flexapod.common.ranking import first_largest
from flexapod.kinematics.envelope import Box, LegRange, leg_range
from flexapod.model import AXES, Requirement, Robot

LARGEST = 8.0  # times the box, up to which it is looked for its limits
HALVINGS = 24
LEG_TOO_SHORT, LEG_TOO_LONG = (
    [reason.flag for reason in REASONS].index(flag) for flag in ("leg_too_short", "leg_too_long")
)
FORBIDDEN = {"joint_folds", "joint_stops"}  # reasons of joints, whose leg is told by its angles


@dataclass(frozen=True)
class RequiredBox:
    """Ranges ``low`` and ``high`` (6,) of surge to yaw [m, rad] about home, of the axes that are ``moved`` (6,).

    ``alone``: each axis with the others at home; turns are about the point ``pivot`` (3,) of the platform frame [m].
    """

    robot: Robot
    moved: Mask
    low: Array
    high: Array
    alone: bool
    pivot: Array

    @property
    def corners(self) -> Array:
        """Corners, (P, 6); of axes alone their ends; nothing of a box without axes."""
        return self._points((0, 2))

    @property
    def trial_points(self) -> Array:
        """Corners, middles of edges and faces, home: three values of each axis, (P, 6)."""
        return self._points((0, 1, 2))

    def _points(self, chosen: tuple[int, ...]) -> Array:
        values = np.stack([self.low, np.zeros(6), self.high])
        axes = np.flatnonzero(self.moved)
        if self.alone:
            return np.array([np.where(np.arange(6) == k, values[i, k], 0.0) for k in axes for i in chosen]).reshape(
                -1, 6
            )
        if not axes.size:
            return np.zeros((0, 6))
        ways = [np.unique(values[list(chosen), k]) for k in axes]  # an end at home counts once
        found = np.zeros((int(np.prod([len(x) for x in ways])), 6))
        found[:, axes] = list(product(*ways))
        return found

    @property
    def envelope(self) -> Box:
        """The same for the lengths of its legs."""
        return Box(low=self.low, high=self.high, pivot=self.pivot, alone=self.alone)

    def in_proportion(self, scale: float) -> RequiredBox:
        """The box in proportion."""
        return replace(self, low=scale * self.low, high=scale * self.high)

    def poses(self, values: Array) -> kinematics.Poses:
        """Poses at rest of coordinates (P, 6) of the pivot from home."""
        return kinematics.poses_from_home(self.robot, values, self.moved, self.pivot)


def box_of(robot: Robot, wanted: Requirement) -> RequiredBox:
    """The box that is asked of a robot; of one axis at least where there are ranges.

    Raises
    ------
    InputError
        An axis along or about which the robot does not move, by its name or because none is left.
    """
    pivot = {"tool": robot.tool, "platform": np.zeros(3)}.get(wanted.pivot) if isinstance(wanted.pivot, str) else None
    pivot = np.asarray(wanted.pivot, dtype=float) if pivot is None else pivot
    named = {key: ranges for key in ("travel", "rotation") if (ranges := getattr(wanted, key)) is not None}
    explicit = np.array([any(getattr(r, axis, None) is not None for r in named.values()) for axis in AXES])
    free = _free_axes(robot, explicit, pivot)
    ends = [wanted.ends(axis) if free[k] else None for k, axis in enumerate(AXES)]
    moved = np.array([x is not None and bool(np.any(x)) for x in ends])
    for key in named:
        part = slice(3) if key == "travel" else slice(3, 6)
        if not free[part].any():
            raise InputError(
                f"asks for motions that the robot does not have: {', '.join(AXES[part])}", key=f"requirement.{key}",
                allowed=", ".join(axis for k, axis in enumerate(AXES) if free[k]), next_step="Leave it out",
            )  # fmt: skip
    low, high = (np.array([0.0 if x is None else x[side] for x in ends]) for side in (0, 1))
    return RequiredBox(robot, moved, low, high, wanted.alone, pivot)


def _free_axes(robot: Robot, explicit: Mask, pivot: Array) -> Mask:
    """Axes (6,) along and about which the robot is commanded, those that are named among them."""
    limbs = kinematics.rigid_limbs(robot)
    if limbs.guides:
        try:
            return kinematics.independent_axes(limbs, explicit, pivot)
        except InputError as error:
            axis = AXES[int(np.argmax(explicit))]
            raise InputError(error.what, key=f"requirement: {axis}", allowed=error.allowed) from None
    if (wrong := np.flatnonzero(explicit & limbs.hub_held)).size:
        axis = AXES[wrong[0]]
        raise InputError(
            "is a motion that the robot does not have",
            key=f"requirement.{'travel' if wrong[0] < 3 else 'rotation'}.{axis}",
            allowed=", ".join(name for name, held in zip(AXES, limbs.hub_held, strict=True) if not held),
        )
    return ~limbs.hub_held


@dataclass(frozen=True, kw_only=True)
class BoxReach:
    """Reach of a box: ``scale`` of it that is reached, ``within`` all, ``sure``: no pose of it can say otherwise.

    ``worst`` (6,): where legs come nearest to their limits, or are beyond them; ``leg`` from 1 there; ``reason`` in
    words, empty where all is reached; ``looked``: poses.
    """

    scale: float
    within: bool
    sure: bool
    worst: Array
    leg: int
    reason: str
    looked: int


def box_reach(box: RequiredBox) -> BoxReach:
    """Legs, joints and singularities over a box.

    Lengths for sure by `kinematics.envelope`, Eqs. (T2.49)-(T2.52), of legs that are vectors between joints; joints,
    singularities and other legs at its corners, and three values of each axis. A pose out of reach is a proof that the
    box is not kept; that it is, poses alone do not prove.
    """
    values = box.trial_points
    at = kinematics.RigidPoses(box.robot, box.poses(values))
    code = rigid_codes(at, from_home=True)
    lengths = leg_range(box.robot, box.envelope)
    within = bool((code == REACHED).all())
    reach = BoxReach(
        scale=_scale(box, within=within and not lengths.out.any()),
        within=within and not lengths.out.any(),
        sure=not within or bool(lengths.out.any()) or _is_sure(box.robot, lengths),
        worst=np.zeros(6),
        leg=0,
        reason="",
        looked=len(values),
    )
    return _with_leg(reach, lengths) if within else _with_pose(reach, at, code, values)


def _is_sure(robot: Robot, lengths: LegRange) -> bool:
    """Test whether bounds keep all limits: those of the lengths, where joints have none."""
    return bool(lengths.sure.all()) and not np.isfinite(joint_angle_limits(robot)).any()


def _with_leg(reach: BoxReach, lengths: LegRange) -> BoxReach:
    """The leg that comes nearest to its limits or leaves them, and where."""
    left = np.stack([lengths.least - lengths.limits[:, 0], lengths.limits[:, 1] - lengths.most], axis=1)
    leg, side = np.unravel_index(first_largest(-np.nan_to_num(left, nan=-np.inf)), left.shape)
    if np.isposinf(left[leg, side]):
        return reach
    worst = (lengths.least_pose, lengths.most_pose)[side][leg]
    words = REASONS[LEG_TOO_LONG if side else LEG_TOO_SHORT].words
    return replace(reach, worst=worst, leg=int(leg) + 1, reason="" if reach.within else words)


def _with_pose(reach: BoxReach, at: kinematics.RigidPoses, code: Codes, values: Array) -> BoxReach:
    """The pose that is farthest out of reach, the leg and the reason there."""
    excess, out = leg_excess(at), np.flatnonzero(code != REACHED)
    most = np.nan_to_num(excess[out], nan=np.inf).max(axis=1)
    worst = int(out[first_largest(most)])
    reason = REASONS[code[worst]]
    return replace(reach, worst=values[worst], leg=_leg(at, excess, worst, reason.flag), reason=reason.words)


def _scale(box: RequiredBox, *, within: bool) -> float:
    """Largest part of the box, in proportion, of which no pose was found out of reach; at most `LARGEST`."""
    values = box.corners if within else box.trial_points

    def keeps_limits(scale: float) -> bool:
        at = kinematics.RigidPoses(box.robot, box.poses(scale * values))
        if not (rigid_codes(at, from_home=True) == REACHED).all():
            return False
        return not leg_range(box.robot, box.in_proportion(scale).envelope, parts=()).out.any()

    return largest_reached(keeps_limits, within=within)


def largest_reached(reached: Callable[[float], bool], *, within: bool) -> float:
    """Largest scale at which `reached` holds, by doubling from 1 and halving."""
    low, high = (1.0, 2.0) if within else (0.0, 1.0)
    while within and high <= LARGEST and reached(high):
        low, high = high, 2 * high
    if high > LARGEST:
        return LARGEST
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if reached(middle) else (low, middle)
    return low


def leg_excess(at: kinematics.RigidPoses) -> Array:
    """Distance (P, legs) [m] by which legs are beyond their nearest limit, below 0 within; -inf without limits."""
    found, (limits, mouth, piston), ways = at.reach, leg_limits(at.robot), slider_limits(at.robot)
    length, place = found.length, found.carriage
    over = [limits[:, 0] - length, length - limits[:, 1], ways[:, 0] - place, place - ways[:, 1]]
    guided = np.where(mouth > 0, length - mouth - piston, -np.inf)
    return np.max([*over, guided], axis=0)


def _leg(at: kinematics.RigidPoses, excess: Array, worst: int, flag: str) -> int:
    """Number of the leg that is nearest to its limit; where joints are the limit, that which turns farthest."""
    if flag in FORBIDDEN:
        over = joint_angles(at.robot, at.directions, at.poses.rotation)[worst] - joint_angle_limits(at.robot)
        over = np.where(np.isfinite(over), over, joint_angles(at.robot, at.directions, at.poses.rotation)[worst] - 10)
        return int(np.argmax(np.nan_to_num(over, nan=-np.inf).max(axis=1))) + 1
    row = excess[worst]
    return int(np.argmax(np.nan_to_num(row, nan=np.inf))) + 1 if np.isfinite(row).any() else 0
