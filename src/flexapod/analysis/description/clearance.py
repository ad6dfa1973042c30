"""Angles of the joints and room between legs on the rigid path."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod import kinematics
from flexapod.analysis.description.leg_description import Extreme
from flexapod.analysis.results.bodies import clearance, joint_angle_limits, joint_angles
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.errors import FlexapodError
from flexapod.common.ranking import first_largest, first_least
from flexapod.model import Robot


@dataclass(frozen=True, kw_only=True)
class TurnedJoint:
    """Joint at an `end` of the legs with the least margin to its `limit` [rad], or with the largest turn.

    `largest`: its largest turn since home [rad]; `limit` None: none of them has one.
    """

    end: str
    leg: int
    largest: Extreme
    limit: float | None


@dataclass(frozen=True, kw_only=True)
class LegClearance:
    """Least distance of two `legs` as cylinders and pistons [m], on the path and at `home`."""

    legs: tuple[int, int]
    least: Extreme
    home: float


@dataclass(frozen=True, kw_only=True)
class StrokeEnd:
    """All legs at an end of their strokes, `shortest` or longest: largest turns of joints [rad], least distance [m].

    `margin`: least angle left of joints that have a limit; None where none has. `gap` None: no legs could meet.
    """

    shortest: bool
    base: float
    platform: float
    margin: float | None
    gap: float | None


def stroke_ends(robot: Robot) -> tuple[StrokeEnd, ...]:
    """Joints and room between legs with all strokes at their ends; nothing where strokes have none, or do not meet."""
    strokes = [leg.stroke for leg in robot.legs if leg.driven]
    if not strokes or any(stroke is None for stroke in strokes) or any(leg.driven == "carriage" for leg in robot.legs):
        return ()
    found = []
    for shortest in (True, False):
        lengths = np.array([stroke.min if shortest else stroke.max for stroke in strokes if stroke is not None])
        try:
            pose = kinematics.forward_kinematics(robot, lengths)
            legs = kinematics.inverse_kinematics(robot, pose)
        except FlexapodError:
            continue
        axes = kinematics.leg_axes(robot, pose, legs)
        turned = joint_angles(robot, axes, pose.rotation)[0]
        left = (joint_angle_limits(robot) - turned).min()
        nearest = clearance(robot, pose.place(robot.platform_joints), axes, legs.length)
        found.append(
            StrokeEnd(
                shortest=shortest,
                base=float(turned[:, 0].max()),
                platform=float(turned[:, 1].max()),
                margin=float(left) if np.isfinite(left) else None,
                gap=None if nearest is None else float(nearest.gap[0]),
            )
        )
    return tuple(found)


def joint_turns(path: RigidPath) -> tuple[TurnedJoint, ...]:
    """Angles of the joints at base and platform on a path."""
    found, limits = joint_angles(path.robot, path.axes, path.poses.rotation), joint_angle_limits(path.robot)
    lines = []
    for end, name in enumerate(("base", "platform")):
        limited = np.isfinite(limits[:, end])
        over = found[..., end] - (limits[:, end] if limited.any() else 0.0)
        k, leg = np.unravel_index(first_largest(over), over.shape)
        extreme = Extreme(value=float(found[k, leg, end]), time=float(path.time[k]))
        limit = float(limits[leg, end]) if limited.any() else None
        lines.append(TurnedJoint(end=name, leg=int(leg) + 1, largest=extreme, limit=limit))
    return tuple(lines)


def leg_clearance(path: RigidPath) -> LegClearance | None:
    """The two legs that come nearest to each other on a path."""
    robot = path.robot
    home = RigidPath(path.study, np.zeros(1), kinematics.home_pose(robot))
    nearest, there = (
        clearance(robot, x.poses.place(robot.platform_joints), x.axes, x.legs.length) for x in (path, home)
    )
    if nearest is None or there is None:
        return None
    k = first_least(nearest.gap)
    one, other = (int(leg) + 1 for leg in nearest.legs[k])
    least = Extreme(value=float(nearest.gap[k]), time=float(path.time[k]))
    return LegClearance(legs=(one, other), least=least, home=float(there.gap[0]))
