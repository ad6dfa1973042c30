"""The rigid robot as Datasets: lengths, poses and forces over a motion."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.helpers.mechanisms import ROBOTS
from tests.helpers.runs import paper_robot

import flexapod as fx
from flexapod.common.errors import InputError
from flexapod.model import CombinedMotion

pytestmark = pytest.mark.unit

MOTION = CombinedMotion(amplitudes={"sway": 0.03, "heave": 0.02, "roll": 0.2}, duration=0.5, hold=0.1)


def test_inverse_kinematics_is_the_command_of_a_simulation():
    study = paper_robot()
    data = fx.inverse_kinematics(study.robot, MOTION)
    assert data.sizes["time"] == 601
    simulated = fx.simulate(study.robot, MOTION, fidelity="lumped", step=1e-3)
    np.testing.assert_array_equal(data.leg_length_command, simulated.leg_length_command)
    np.testing.assert_array_equal(data.com_position_rigid, simulated.com_position_rigid)
    np.testing.assert_array_equal(data.platform_quaternion_rigid, simulated.platform_quaternion_rigid)
    assert fx.model.loads(data.attrs["study"]).motion == MOTION


def test_rates_and_accelerations_are_derivatives():
    data = fx.inverse_kinematics(paper_robot().robot, MOTION, output_step=5e-4)
    h, l = 5e-4, data.leg_length_command.values  # noqa: E741
    rate = (l[2:] - l[:-2]) / (2 * h)
    accel = (l[2:] - 2 * l[1:-1] + l[:-2]) / h**2
    # h^2 / 6 times jerks of the quintic up to 60 / T^3 times 0.1 m; second differences round at 1e-16 / h^2.
    np.testing.assert_allclose(rate, data.leg_length_rate[1:-1], atol=h**2 / 6 * 60 * 0.1 / 0.5**3)
    inside = np.abs(data.time.values[1:-1] - 0.5) > 2e-3  # the jerk jumps at the end of the motion
    np.testing.assert_allclose(accel[inside], data.leg_length_acceleration.values[1:-1][inside], atol=2e-3)
    assert np.abs(data.leg_length_acceleration).max() > 0.3


def test_forward_kinematics_brings_the_path_back():
    study = paper_robot()
    path = fx.inverse_kinematics(study.robot, MOTION, output_step=0.02)
    data = fx.forward_kinematics(study.robot, path.leg_length_command, time=path.time)
    np.testing.assert_allclose(data.com_position, path.com_position_rigid, atol=1e-11)
    np.testing.assert_allclose(data.tool_position, path.tool_position_rigid, atol=1e-11)
    np.testing.assert_allclose(data.platform_quaternion, path.platform_quaternion_rigid, atol=1e-11)
    assert data.platform_position.dims == ("time", "axis")
    np.testing.assert_array_equal(data.time, path.time)


def test_forward_kinematics_of_six_lengths():
    robot = paper_robot().robot
    data = fx.forward_kinematics(robot, robot.home_lengths)
    assert "time" not in data.dims
    np.testing.assert_allclose(data.platform_position, [0, 0, 0.9], atol=1e-12)
    # A guess leads to the posture near it: the mirror image below the base.
    below = fx.kinematics.Poses.at_rest([0, 0, -0.9], np.eye(3))
    mirrored = fx.forward_kinematics(robot, robot.home_lengths, below)
    np.testing.assert_allclose(mirrored.platform_position, [0, 0, -0.9], atol=1e-12)


@pytest.mark.parametrize("lengths", [[0.9] * 5, [[0.9] * 6, [0.9] * 5 + [np.nan]], [-0.9] * 6, "long"])
def test_lengths_that_are_refused(lengths):
    with pytest.raises(fx.InputError):
        fx.forward_kinematics(paper_robot().robot, lengths)


def test_lengths_without_a_pose():
    with pytest.raises(fx.ComputationError):
        fx.forward_kinematics(paper_robot().robot, [0.05, 2.0, 0.05, 2.0, 0.05, 2.0])


def test_instants_must_fit_the_lengths():
    robot = paper_robot().robot
    with pytest.raises(fx.InputError, match="time"):
        fx.forward_kinematics(robot, [robot.home_lengths] * 3, time=[0.0, 1.0])


def test_inverse_dynamics_keeps_newtons_law_for_the_payload():
    robot, force = paper_robot().robot, np.array([30.0, -20, 50])
    data = fx.inverse_dynamics(robot, MOTION, load=[*force, 0, 0, 0], output_step=1e-3)
    path = fx.kinematics.poses(robot, MOTION, data.time.values)
    accel = path.point(robot.payload.com)[2]
    expected = robot.payload.mass * (accel - robot.gravity) - force
    np.testing.assert_allclose(data.joint_force_rigid.sum("leg"), expected, atol=1e-9)
    simulated = fx.simulate(robot, MOTION, load=[*force, 0, 0, 0], fidelity="lumped", step=1e-3)
    np.testing.assert_allclose(data.actuator_force_rigid, simulated.actuator_force_rigid, rtol=1e-12, atol=1e-9)
    for name, unit in (("actuator_force_rigid", "N"), ("joint_force_rigid", "N"), ("base_moment_rigid", "N m")):
        assert data[name].attrs["units"] == unit


def test_the_base_bears_all_weight_at_rest():
    study = paper_robot()
    data = fx.inverse_dynamics(study, duration=0.01).isel(time=0)
    leg = study.robot.legs[0]
    weight = 9.81 * (study.robot.payload.mass + 6 * (leg.cylinder.mass + leg.piston.mass))
    np.testing.assert_allclose(data.base_force_rigid.sum("leg"), [0, 0, weight], atol=1e-9)


def test_forces_move_the_robot_with_the_power_they_give():
    # Work of the actuators over the motion: gain of kinetic and potential energy (none kinetic, at rest at both ends).
    robot = paper_robot().robot
    data = fx.inverse_dynamics(robot, MOTION, output_step=1e-3)
    power = (data.actuator_force_rigid * data.leg_length_rate).sum("leg").values
    work = np.sum(0.5 * (power[1:] + power[:-1])) * 1e-3
    path = fx.kinematics.poses(robot, MOTION, data.time.values[[0, -1]])
    kinetic, potential = fx.kinematics.energies(robot, path)
    assert work == pytest.approx(np.diff(potential)[0] + np.diff(kinetic)[0], rel=1e-5)  # trapezoids over 1 ms


def test_quaternions_are_those_of_the_motion():
    data = fx.inverse_kinematics(paper_robot().robot, MOTION)
    turn = Rotation.from_quat(data.platform_quaternion_rigid.values, scalar_first=True).as_rotvec()
    np.testing.assert_allclose(turn[-1], [0.2, 0, 0], atol=1e-14)
    assert (data.platform_quaternion_rigid.sel(quaternion="w") > 0).all()


def test_instants_that_do_not_fit_the_lengths_are_refused():
    robot = fx.preset("paper-robot").robot
    lengths = np.full(6, 0.95)
    with pytest.raises(InputError, match="single pose"):
        fx.forward_kinematics(robot, lengths, time=[0.0])
    for time, words in ((["now", "then"], "not a number"), ([0.0], "does not fit")):
        with pytest.raises(InputError, match=words):
            fx.forward_kinematics(robot, np.tile(lengths, (2, 1)), time=time)


@pytest.mark.parametrize("name", ["3-RPS", "3-UPS+UP", "6-PUS", "6-RUS", "planar 3-PRR"])
def test_forward_kinematics_from_the_drives_of_any_robot(name):
    robot = ROBOTS[name]()
    axis = "surge" if "planar" in name else "heave"
    motion = fx.model.AxisMotion(type=axis, amplitude=0.02, duration=1.0)
    ours = fx.inverse_kinematics(robot, motion, output_step=0.25)
    places = ours.drive_command.values[:, [bool(leg.driven) for leg in robot.legs]]
    data = fx.forward_kinematics(robot, places, time=ours.time)
    path = fx.kinematics.poses(robot, motion, ours.time.values)
    np.testing.assert_allclose(data.platform_position, path.position, rtol=0, atol=1e-12)
    np.testing.assert_allclose(
        data.drive_command if "drive_command" in data else data.leg_length_command,
        ours.drive_command,
        rtol=0,
        atol=1e-12,
    )
