"""Motion and mobility of robots of many kinds against products of exponentials with exact rates."""

import numpy as np
import pytest
from tests.helpers.chains import NAMED, PLANES, as_mechanism
from tests.helpers.mechanisms import AMPLITUDES, DURATION, MOVING, OWN, ROBOTS, THREE, built, leg, quintic, ring
from tests.oracles import virtual_power

from flexapod import kinematics
from flexapod.kinematics.leg_geometry import limbs
from flexapod.kinematics.mobility import mobility
from flexapod.model import CombinedMotion

pytestmark = pytest.mark.consistency

OWN |= {"planar 3-RPR": PLANES["xy"], "planar 3-PRR": PLANES["xy"]}


def parts(chain, names, values):
    return [value for joint, value in zip(chain.joints, values, strict=True) if joint.name in names]


@pytest.mark.parametrize("name", MOVING)
def test_legs_follow_the_platform(name):
    robot, own = ROBOTS[name](), OWN.get(name, tuple(NAMED))
    pivot = [0.01, -0.02, 0.03] if own == tuple(NAMED) else [0, 0, 0]
    motion = CombinedMotion(amplitudes={axis: AMPLITUDES[axis] for axis in own}, duration=DURATION, pivot=pivot)
    t = np.array([0.12, 0.3])
    path = kinematics.poses(robot, motion, t)
    legs = kinematics.inverse_kinematics(robot, path)
    mechanism, found = as_mechanism(robot, own, pivot), None
    for i, instant in enumerate(t):
        law = np.array([quintic(AMPLITUDES[axis], instant) for axis in own]).T
        found = virtual_power.follow(mechanism, *law, guess=found)
        place = virtual_power.placed(mechanism.platform, found.platform[0])[0][-1]
        # Closed to 1e-14 by both; rates and accelerations (10 rad/s^2) by the condition of the closures.
        np.testing.assert_allclose(path.rotation[i], place[:3, :3] @ robot.home_rotation, rtol=0, atol=1e-12)
        at = place[:3, :3] @ robot.home_position + place[:3, 3]
        np.testing.assert_allclose(path.position[i], at, rtol=0, atol=1e-12)
        for order in range(3):
            states = [(leg, q[order]) for leg, q in zip(mechanism.legs, found.legs, strict=True)]
            for coordinate, joint in (("chi", "carriage"), ("l", "length")):
                ours = legs.coordinate(coordinate)[order][i]
                if coordinate == "l" and order == 0:
                    ours = ours - robot.home_lengths
                for (way, q), value in zip(states, ours, strict=True):
                    other = parts(way, [joint], q)
                    np.testing.assert_allclose(other, [value][: len(other)], rtol=0, atol=1e-11)


@pytest.mark.parametrize("name", [name for name in MOVING if not name.startswith("planar")])
def test_mobility_is_that_of_all_screws(name):
    robot = ROBOTS[name]()
    ours, other = mobility(limbs(robot, rigid=True)), virtual_power.mobility(as_mechanism(robot))
    assert ours.freedoms == other["joints"]
    for key in ("mobility", "redundant", "locked", "self_stress"):
        assert getattr(ours, key) == other[key], key


def radial():
    """3-UPU with its outer axes towards the middle, inclined to the legs: its platform can tilt with locked drives."""
    legs = [leg("UPU", axis, axis) for axis in ring(1.0, THREE)]
    return built("3-UPU", ring(0.35, THREE), ring(0.2, THREE), 0.6, legs)


def exechon():
    """Two legs that turn about one axis x, inclined to them, and hinges parallel to y; a third across."""
    x, y = np.eye(3)[:2]
    base, top = np.array([[0.4, 0, 0], [-0.4, 0, 0], [0, 0.4, 0]]), np.array([[0.2, 0, 0], [-0.2, 0, 0], [0, 0.2, 0]])
    return built("2-UPR+SPR", base, top, 0.7, [leg("UPR", x, y), leg("UPR", x, y), leg("SPR", None, x)])


@pytest.mark.parametrize(("make", "counts"), [(radial, (15, 5, 2, 2, 2)), (exechon, (13, 3, 2, 0, 2))])
def test_axes_of_crosses_that_are_not_normal_to_the_leg_count_as_given(make, counts):
    robot = make()
    found = mobility(limbs(robot))
    assert (found.freedoms, found.mobility, found.redundant, found.locked, found.self_stress) == counts
    assert tuple(virtual_power.mobility(as_mechanism(robot)).values()) == counts


def test_rates_about_a_pivot_that_is_not_the_origin():
    """Commanded about a point beside the platform, with axes that follow: against differences over time."""
    robot, pivot = ROBOTS["3-RPS"](), [0.05, -0.1, 0.25]
    motion = CombinedMotion(
        amplitudes={"heave": 0.02, "roll": 0.1, "pitch": -0.05}, independent=["heave", "roll", "pitch"],
        duration=1.0, pivot=pivot,
    )  # fmt: skip
    h = 1e-3
    t = np.array([0.3, 0.6])[:, None] + h * np.arange(-2, 3)
    path = kinematics.poses(robot, motion, t.ravel())

    def slope(values):
        x = values.reshape(2, 5, *values.shape[1:])
        return (8 * (x[:, 3] - x[:, 1]) - (x[:, 4] - x[:, 0])) / (12 * h)

    # Fourth order in steps of 1 ms of a motion of a second: (2 pi h)^4 / 30 = 5e-11 of the rates' own changes.
    np.testing.assert_allclose(slope(path.position), path.velocity[2::5], atol=1e-8)
    turning = slope(path.rotation) @ path.rotation[2::5].swapaxes(1, 2)
    spin = np.stack([turning[:, 2, 1], turning[:, 0, 2], turning[:, 1, 0]], axis=1)
    np.testing.assert_allclose(spin, path.omega[2::5], atol=1e-8)
    assert np.abs(path.velocity[2::5, :2]).max() > 1e-3  # the tripod moves sideways beside its pivot
