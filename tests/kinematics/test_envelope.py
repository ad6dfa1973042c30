"""Legs over a whole box of travel and tilts: closed forms, brute force, and what is said of a robot."""

import math
from itertools import product

import numpy as np
import pytest

import flexapod as fx
from flexapod import kinematics, model
from flexapod.analysis.checks.envelope import envelope
from flexapod.common.errors import InputError
from flexapod.kinematics.envelope import (
    Box,
    Spans,
    box_poses,
    closed_form,
    extremes,
    leg_range,
    length_bounds,
    length_limits,
    movable_axes,
)

pytestmark = pytest.mark.analytic

PRESETS = ("paper-robot", "machine-hexapod", "small-hexapod", "nano-hexapod", "motion-base")
BOXES = 120


def random_box(k):
    """Box of some axes about home, its robot, and half the stroke by which errors are measured."""
    random = np.random.default_rng(3500 + k)
    robot = fx.preset(PRESETS[k % len(PRESETS)]).robot
    half = np.ptp(length_limits(robot), axis=1).min() / 2
    size = np.repeat([half, half / kinematics.rigid_limbs(robot).L_c], 3)
    ends = size * random.uniform(0.05, 0.4, (2, 6)) * (random.random(6) > 0.2)
    pivot = robot.payload.tool if k % 2 else 0.3 * robot.home_height * random.normal(size=3)
    return robot, Box(low=-ends[0], high=ends[1], pivot=pivot), half


def brute_force(robot, box, count):
    """Shortest and longest lengths (n,) over travel and `count` values of each tilt, by rotation matrices alone.

    At a tilt: the longest of the corners of travel, and the distance of the base joint from the box that the platform
    joint fills.
    """
    home = kinematics.home_pose(robot)
    pivot = home.position[0] + home.rotation[0] @ box.pivot
    arms = (robot.platform_joints - box.pivot) @ home.rotation[0].T
    roll, pitch, yaw = np.meshgrid(*(np.unique(np.linspace(box.low[k], box.high[k], count)) for k in (3, 4, 5)))
    x, y, z = (a.ravel()[:, None] for a in (roll, pitch, yaw))
    across = arms[:, 1] * np.cos(x) - arms[:, 2] * np.sin(x), arms[:, 1] * np.sin(x) + arms[:, 2] * np.cos(x)
    turned = arms[:, 0] * np.cos(y) + across[1] * np.sin(y), across[0], across[1] * np.cos(y) - arms[:, 0] * np.sin(y)
    place = np.stack(
        [turned[0] * np.cos(z) - turned[1] * np.sin(z), turned[0] * np.sin(z) + turned[1] * np.cos(z), turned[2]], -1
    )
    place += pivot - robot.base_joints
    corners = np.array(list(product(*np.stack([box.low[:3], box.high[:3]], axis=1))))
    longest = np.max([np.linalg.norm(place + corner, axis=-1).max(axis=0) for corner in corners], axis=0)
    outside = np.maximum(np.maximum(place + box.low[:3], -(place + box.high[:3])), 0.0)
    return np.linalg.norm(outside, axis=-1).min(axis=0), longest


def excess(k, parts, count):
    """By how much bounds lie beyond brute force, shares of the half stroke, (2 n,)."""
    robot, box, half = random_box(k)
    least, most = brute_force(robot, box, count)
    low, high = length_bounds(Spans.from_robot(robot, box.pivot), box, parts)
    return np.concatenate([least - low, high - most]) / half


@pytest.mark.parametrize("k", range(10))
def test_bounds_hold_against_brute_force(k):
    for parts in (4, 8):
        assert excess(k, parts, 13).min() >= -1e-12


def test_bounds_are_close_and_close_with_the_square_of_the_parts():
    medians = [np.median([excess(k, parts, 13) for k in range(10)]) for parts in (4, 8, 16)]
    assert 0.002 < medians[0] < 0.012
    assert medians[0] / medians[1] == pytest.approx(4, rel=0.25) and medians[1] / medians[2] == pytest.approx(
        4, rel=0.5
    )


@pytest.mark.parametrize("parts, median, most", [(4, 0.007, 0.15), (8, 0.002, 0.04)])
def test_bounds_of_120_boxes(parts, median, most):
    found = np.array([excess(k, parts, 31) for k in range(BOXES)])
    assert found.min() >= -1e-12
    assert np.median(found.max(axis=1)) < median and found.max() < most


@pytest.mark.parametrize("k", range(BOXES))
def test_lengths_that_are_found_are_those_of_brute_force(k):
    robot, box, half = random_box(k)
    least, most = brute_force(robot, box, 31)
    found = leg_range(robot, box)
    assert (found.least - least).max() < 0.02 * half and (most - found.most).max() < 0.02 * half
    for length, pose in ((found.least, found.least_pose), (found.most, found.most_pose)):
        reached = kinematics.reach(robot, kinematics.robot.poses_from_home(robot, pose, None, box.pivot)).length
        np.testing.assert_allclose(np.diag(reached), length, rtol=1e-12)


def test_travel_alone_is_exact():
    """Two legs on one vertical line, joint at the pivot: distance of a point from a box, and of its farthest corner."""
    spans = Spans(foot=np.array([[0.0, 0.0, 1.0], [0.3, 0.0, 1.0]]), arm=np.zeros((2, 3)))
    box = Box.from_ranges({"surge": (-0.1, 0.2), "sway": (-0.4, 0.3), "heave": (-0.5, 0.1)})
    low, high = length_bounds(spans, box, 4)
    np.testing.assert_allclose(low, [0.5, math.hypot(0.2, 0.5)], rtol=1e-14)
    np.testing.assert_allclose(
        high, [math.sqrt(0.2**2 + 0.4**2 + 1.1**2), math.sqrt(0.5**2 + 0.4**2 + 1.1**2)], rtol=1e-14
    )
    least, most, _, _ = extremes(spans, box, np.zeros((1, 3)))
    np.testing.assert_allclose([least[0], most[0]], [low, high], rtol=1e-14)


def test_a_joint_on_a_circle():
    """Arm r turns by yaw about an axis at distance d from the base joint: d - r where it points there, by cosines."""
    d, r, ends = 1.0, 0.4, (-0.5, 0.9)
    spans = Spans(foot=np.array([[-d, 0.0, 0.0]]), arm=np.array([[r, 0.0, 0.0]]))
    box = Box.from_ranges({"yaw": ends})
    low, high = length_bounds(spans, box, 64)
    assert low[0] == pytest.approx(d - r, abs=1e-4) and low[0] <= d - r
    farthest = math.sqrt(d * d + r * r - 2 * d * r * math.cos(ends[1]))
    assert high[0] == pytest.approx(farthest, abs=2e-4) and high[0] >= farthest


def test_no_smaller_second_order_would_do():
    """A far base joint sees of an arm r along the leg r (1 - cos h), which is all of r h^2 / 2 to fourth order."""
    d, r, h = 1e4, 1.0, 0.1
    box = Box.from_ranges({"yaw": (-h, h)})
    for side in (1.0, -1.0):
        spans = Spans(foot=np.array([[d, 0.0, 0.0]]), arm=np.array([[side * r, 0.0, 0.0]]))
        low, high = length_bounds(spans, box, 1)
        end = math.sqrt(d * d + r * r + 2 * side * d * r * math.cos(h))
        away = end - low[0] if side > 0 else high[0] - end
        assert 0 <= away < 2e-3 * r * h * h / 2


def test_a_base_joint_inside_the_box_bounds_nothing():
    spans = Spans(foot=np.zeros((1, 3)), arm=np.array([[0.1, 0.0, 0.0]]))
    low, high = length_bounds(spans, Box.from_ranges({"surge": (-0.2, 0.2), "yaw": (-0.3, 0.3)}), 4)
    assert low[0] == 0.0 and 0.3 <= high[0] < 0.31


def scaled(study, share, **kwargs):
    """Box of all axes: a share of the half stroke of a robot, about its tool."""
    robot = study.robot
    size = share * np.ptp(length_limits(robot), axis=1).min() / 2
    ranges = {axis: (-size, size) if k < 3 else (-0.02, 0.02) for k, axis in enumerate(model.AXES)}
    return robot, Box.from_ranges(ranges, pivot=robot.payload.tool, **kwargs)


def test_answers():
    study = fx.preset("machine-hexapod")
    small, large = (envelope(*scaled(study, share)) for share in (0.2, 1.2))
    assert small.answer == "sure" and small.lengths_sure and 0 < small.left < 0.5
    assert large.answer == "no" and large.left < 0 and not large.worst.is_kept
    assert large.worst.margin == pytest.approx(
        min(large.longest.limit - large.longest.value, large.shortest.value - large.shortest.limit)
    )
    assert small.singularity.looked == 729 and small.singularity.value > 0.1 and small.clearance.value > 0


def test_refined_until_the_limits_are_kept_or_looked_at():
    """Limits ever nearer to what is found: finer parts keep them, next to it none do."""
    robot, box = scaled(fx.preset("machine-hexapod"), 0.3)
    found = leg_range(robot, box)
    wide = (found.most - found.least).max()
    parts = []
    for spare in (0.1, 2e-4, 5e-5, 1e-9):
        limits = np.stack([found.least - spare * wide, found.most + spare * wide], axis=1)
        kept = leg_range(robot, box, limits)
        parts.append((kept.parts, bool(kept.sure.all()), bool(kept.out.any())))
    assert parts == [(4, True, False), (8, True, False), (16, True, False), (16, False, False)]


def test_alone_is_the_worst_of_each_axis():
    robot, box = scaled(fx.preset("machine-hexapod"), 0.3, alone=True)
    found, each = envelope(robot, box), [envelope(robot, one) for one in box.separate()]
    assert len(each) == 6 and found.singularity.looked == 18
    assert found.longest.value == max(one.longest.value for one in each)
    assert found.shortest.margin == min(one.shortest.margin for one in each)
    assert sum(value != 0 for value in found.longest.pose) == 1
    together = envelope(*scaled(fx.preset("machine-hexapod"), 0.3))
    assert together.longest.value > found.longest.value and together.left < found.left


def test_legs_with_two_universal_joints_are_vectors_too():
    """Closures that are solved by Newton have the lengths of the closed form."""
    robot, box = scaled(fx.preset("flight-simulator"), 0.2)
    assert closed_form(robot) and not kinematics.rigid_limbs(robot).plain
    found = leg_range(robot, box)
    _, path = box_poses(robot, Box(low=box.low, high=box.high, pivot=box.pivot))
    length = kinematics.reach(robot, path).length
    assert (length >= found.least_bound).all() and (length <= found.most_bound).all()
    np.testing.assert_allclose(length.max(axis=0), found.most, rtol=1e-9)


def test_fewer_motions_are_looked_at():
    robot = fx.preset("tripod").robot
    axes = movable_axes(robot)
    assert axes.sum() == 3 and not closed_form(robot)
    names = [axis for axis, moves in zip(model.AXES, axes, strict=True) if moves]
    box = Box.from_ranges({axis: (-0.01, 0.01) for axis in names})
    found = envelope(robot, box)
    assert found.answer == "looked" and found.singularity.looked == 27 and np.isnan(found.lengths.most_bound).all()
    with pytest.raises(InputError):
        envelope(robot, Box.from_ranges({axis: (-0.01, 0.01) for axis in model.AXES}))


def test_beyond_a_singular_pose_the_value_is_negative():
    """Similar hexagons are singular at a yaw of 90 deg (Fichter 1986)."""
    robot = fx.preset("machine-hexapod").robot
    near, far = (envelope(robot, Box.from_ranges({"yaw": (0.0, math.radians(a))})).singularity for a in (60, 120))
    assert near.value > 0 and near.is_kept
    assert far.value < 0 and not far.is_kept


@pytest.mark.parametrize(
    "ranges, words",
    [({"surg": (0, 1)}, "surge"), ({"surge": (1, 0)}, "not a range"), ({"yaw": (0, math.nan)}, "not a range")],
)
def test_refusals(ranges, words):
    with pytest.raises(InputError, match=words):
        Box.from_ranges(ranges)
