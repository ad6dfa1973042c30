"""Functions of time as polynomials between knots: as exact as rounding, made only where that saves computing."""

from functools import partial

import numpy as np
import pytest
from tests.helpers.mechanisms import three_rps

from flexapod import kinematics
from flexapod.common.piecewise_chebyshev import ENOUGH, NODES, Pieces
from flexapod.kinematics.laws import PROFILES
from flexapod.model import CombinedMotion, CsvMotion, Load, Simulation, Waypoint, WaypointMotion
from flexapod.solve.robot_system import robot_system
from flexapod.solve.time.command_tables import robot_law

pytestmark = pytest.mark.unit


class Counted:
    """A function, and of how many instants it was asked."""

    def __init__(self, function):
        self.function, self.instants = function, 0

    def __call__(self, t):
        self.instants += len(t)
        return self.function(t)


def kinked(t):
    """Smooth but at t = 0.3, where the second group jumps."""
    late = t >= 0.3
    return [np.exp(np.sin(20 * t))[:, None], np.where(late, 5.0, 1e6)[:, None, None] * np.stack([[np.cos(t), t]]).T]


def test_pieces_are_the_function():
    compute = Counted(kinked)
    pieces, t = Pieces(compute, np.array([0.0, 0.3, 2.0])), np.linspace(0, 2, 5001)
    for found, expected in zip(pieces(t), kinked(t), strict=True):
        assert found.shape == expected.shape
        # last coefficients below ENOUGH; sums of twenty terms round to some 1e-15
        np.testing.assert_allclose(found, expected, rtol=0, atol=ENOUGH * np.abs(expected).max())
    assert compute.instants < 2000
    known = compute.instants
    pieces(t[::7])
    pieces(np.array([0.3, 2.0 + 1e-12]))
    assert compute.instants == known


def test_few_instants_are_computed_as_they_are():
    pieces, t = Pieces(kinked, np.array([0.0, 0.3, 2.0])), np.linspace(0, 2, NODES - 1)
    for found, expected in zip(pieces(t), kinked(t), strict=True):
        np.testing.assert_array_equal(found, expected)


def test_a_rough_function_is_computed_as_it_is():
    compute = Counted(lambda t: [np.where(t > 0.1234567, 1.0, np.sin(1e7 * t))])
    pieces, t = Pieces(compute, np.array([0.0, 1.0])), np.linspace(0, 1, 1000)
    np.testing.assert_array_equal(pieces(t)[0], compute(t)[0])
    assert compute.instants < 4 * len(t)  # what was tried is a geometric series that ends below len(t)


def test_a_jump_between_knots_that_rounding_parts_ends():
    """Two tables of one instant may name it with other last digits; no piece between them is ever smooth."""
    there = 0.3
    knots = np.array([0.0, there, np.nextafter(np.nextafter(there, 1), 1), 1.0])
    pieces = Pieces(lambda t: [np.where(t[:, None] <= np.nextafter(there, 1), t[:, None], 2.0)], knots)
    t = np.linspace(0.0, 1.0, 2001)
    np.testing.assert_allclose(pieces(t)[0][:, 0], np.where(t < there, t, 2.0), rtol=0, atol=1e-13)


def table_motion():
    time = np.linspace(0, 0.4, 5)
    pose = np.outer(np.sin(np.pi * time / 0.4) ** 2, [0, 0, 0.02, 0.1, 0, 0])
    return CsvMotion(time=time, pose=pose)


MOTIONS = {
    **{name: CombinedMotion(amplitudes={"heave": 0.02, "roll": 0.1}, profile=name, duration=0.4) for name in PROFILES},
    "waypoints": WaypointMotion(points=[Waypoint(time=0.1, heave=0.01), Waypoint(time=0.4, heave=-0.01, roll=0.05)]),
    "table": table_motion(),
}


@pytest.mark.parametrize("name", MOTIONS)
def test_commands_are_those_of_the_rigid_path(name):
    robot, motion = three_rps(), MOTIONS[name]
    system = robot_system(robot, Simulation(fidelity="rigid"), 0.0)
    poses = Counted(partial(kinematics.rigid_poses, robot, motion))
    series = kinematics.PathSeries(robot, motion, 0.5)
    exact, tabulated = (robot_law(system, robot, Load(), x) for x in (poses, series.at))
    t = np.linspace(0, 0.5, 4001)
    (expected, _), (found, _) = exact(t), tabulated(t)
    for column, allowed in enumerate((1e-13, 1e-12, 1e-11)):  # m, m/s, m/s^2: of lengths 0.6, rates 1, 10 at most
        scale = max(1.0, np.abs(expected[..., column]).max())
        assert np.abs(found[..., column] - expected[..., column]).max() < allowed * scale
    assert series.has_series
