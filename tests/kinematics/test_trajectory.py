"""Poses of all motions: derivatives, pivot, order of the turns, behaviour before and after."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.oracles.stewart_cases import central_difference

from flexapod.common.errors import InputError
from flexapod.kinematics.laws import PROFILES
from flexapod.kinematics.trajectory import Poses, coordinates, rotation_matrix, sample
from flexapod.model import PROFILES as MODEL_PROFILES
from flexapod.model import AxisMotion, CombinedMotion, CsvMotion, Waypoint, WaypointMotion

pytestmark = pytest.mark.unit

HOME = 0.9
AT_HOME = Poses.at_rest([0.0, 0.0, HOME], np.eye(3))
ALL_AXES = {"surge": 0.05, "sway": -0.04, "heave": 0.1, "roll": 0.4, "pitch": -0.3, "yaw": 0.5}
PIVOT = [0.1, -0.2, 0.3]
RNG = np.random.default_rng(17)
TABLE_TIME = np.linspace(0, 1.5, 16)
MOTIONS = {
    "roll": AxisMotion(type="roll", amplitude=0.46, duration=1.0, hold=1.0, pivot=PIVOT),
    "combined": CombinedMotion(amplitudes=ALL_AXES, duration=1.2, profile="cycloidal", pivot=PIVOT),
    "waypoints": WaypointMotion(
        points=[Waypoint(time=0.7, **ALL_AXES), Waypoint(time=1.4, roll=-0.3, yaw=0.2)], profile="smooth", pivot=PIVOT
    ),
    "csv": CsvMotion(time=TABLE_TIME, pose=RNG.normal(0, 0.05, (16, 6)), pivot=PIVOT),
}


def test_all_profiles_of_the_study_file_exist():
    assert set(MODEL_PROFILES) <= set(PROFILES)


@pytest.mark.parametrize("name", MOTIONS)
def test_rates_and_accelerations_are_derivatives(name):
    """Eighth-order differences, step 1e-3, away from the ends of pieces: error below 1e-9 of values of order 10-100."""
    motion = MOTIONS[name]
    t = np.array([0.1234, 0.31, 0.555, 0.66, 0.8])
    if name == "csv":  # the fifth derivative of the spline jumps at the rows of the table
        t = (TABLE_TIME[:-1] + TABLE_TIME[1:])[2:12] / 2
    poses = sample(AT_HOME, motion, t)

    def part(key):
        return lambda x: getattr(sample(AT_HOME, motion, x), key)

    scale = np.max(np.abs(poses.acceleration)) + np.max(np.abs(poses.alpha))
    assert scale > 0.1
    np.testing.assert_allclose(poses.velocity, central_difference(part("position"), t), atol=1e-9 * scale)
    np.testing.assert_allclose(poses.acceleration, central_difference(part("velocity"), t), atol=1e-9 * scale)
    np.testing.assert_allclose(poses.alpha, central_difference(part("omega"), t), atol=1e-9 * scale)
    spin = central_difference(part("rotation"), t) @ np.swapaxes(poses.rotation, 1, 2)
    np.testing.assert_allclose(spin[:, [2, 0, 1], [1, 2, 0]], poses.omega, atol=1e-9 * scale)
    np.testing.assert_allclose(spin, -np.swapaxes(spin, 1, 2), atol=1e-9 * scale)


@pytest.mark.parametrize("axis", ["roll", "pitch", "yaw"])
def test_pivot_stays_in_place_in_pure_turns(axis):
    motion = AxisMotion(type=axis, amplitude=0.5, duration=1.0, pivot=PIVOT)
    position, velocity, acceleration = sample(AT_HOME, motion, np.linspace(0, 1.5, 31)).point(PIVOT)
    np.testing.assert_allclose(position, np.tile(np.add([0, 0, HOME], PIVOT), (31, 1)), atol=1e-15)
    np.testing.assert_allclose(velocity, 0, atol=1e-15)
    np.testing.assert_allclose(acceleration, 0, atol=1e-14)


def test_rotation_is_yaw_after_pitch_after_roll():
    angles = RNG.uniform(-2, 2, (30, 3))
    expected = Rotation.from_euler("xyz", angles).as_matrix()  # about the fixed axes x, then y, then z
    np.testing.assert_allclose(rotation_matrix(angles), expected, atol=1e-14)


@pytest.mark.parametrize("name", MOTIONS)
def test_motion_starts_at_home_or_its_first_row_and_stays_at_its_end(name):
    motion = MOTIONS[name]
    law = coordinates(motion, [-1.0, 0.0, 2.0, 50.0])
    np.testing.assert_allclose(law.position[0], law.position[1], atol=1e-15)
    first = motion.pose[0] if name == "csv" else np.zeros(6)
    last = {"csv": lambda: motion.pose[-1], "waypoints": lambda: motion.poses[-1]}.get(name, lambda: motion.target)()
    np.testing.assert_allclose(law.position[[1, 3]], [first, last], atol=1e-12)
    np.testing.assert_allclose(law.position[2], last, atol=1e-12)
    assert np.max(np.abs(law.rate[[0, 2, 3]])) == 0
    assert np.max(np.abs(law.acceleration[[0, 2, 3]])) == 0


def test_waypoints_rest_at_each_point():
    motion = MOTIONS["waypoints"]
    law = coordinates(motion, motion.times)
    np.testing.assert_allclose(law.position, motion.poses, atol=1e-15)
    assert np.max(np.abs(law.rate)) == 0


def test_table_of_a_smooth_motion_gives_that_motion():
    """Quintic spline of a smooth law that rests at both ends: error of order h^6, 1e-6 of the stroke at 40 rows."""
    source = CombinedMotion(amplitudes=ALL_AXES, duration=1.0, profile="smooth")
    time = np.linspace(0, 1, 81)
    table = CsvMotion(time=time, pose=coordinates(source, time).position)
    t = np.linspace(0, 1, 997)
    errors = np.abs(coordinates(table, t).position - coordinates(source, t).position)
    assert np.max(errors) < 1e-6


def test_point_of_a_pose():
    poses = Poses.at_rest([0, 0, 1], rotation_matrix([0, 0, np.pi / 2]))
    np.testing.assert_allclose(poses.point([1, 0, 0])[0], [[0, 1, 1]], atol=1e-15)
    assert poses.point(np.zeros((4, 3)))[0].shape == (1, 4, 3)


def test_poses_are_read_only():
    with pytest.raises(ValueError, match="read-only"):
        Poses.at_rest([0, 0, 1], np.eye(3)).position[0, 0] = 1.0


def test_instants_must_be_finite():
    with pytest.raises(InputError, match="finite"):
        sample(AT_HOME, MOTIONS["roll"], [0.0, np.nan])
