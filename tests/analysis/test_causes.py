"""The deviation by cause: exact sums, a residual of second order, force over stiffness at rest."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.helpers.runs import paper_robot, with_legs

import flexapod as fx
from flexapod import model
from flexapod.analysis.results.causes import Errors, L, deviation_by_cause, errors_of
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.analysis.simulation import run_simulation
from flexapod.kinematics import COORDINATES
from flexapod.model import AxisMotion, ForceDrive, Payload, ServoDrive

pytestmark = pytest.mark.unit

STILL = AxisMotion(type="roll", amplitude=0.0, duration=1.0)
SHORT = {"duration": 0.1, "step": 1e-3}
SERVO = ServoDrive(stiffness=2e7, damping=2e4)


def rolling(**legs):
    study = paper_robot(leg=legs)
    return study.replace(motion=study.motion.replace(duration=0.2, hold=0.0))


def light(study, **piston):
    """Legs without weight of their own."""
    return with_legs(
        study,
        lambda leg: leg.replace(
            cylinder=leg.cylinder.replace(mass=0.0, inertia=0.0),
            piston=leg.piston.replace(rhoA=1e-9, E=None, density=None, **piston),
        ),
    )


@pytest.mark.parametrize("fidelity", ["rigid", "lumped", "assumed-modes"])
@pytest.mark.parametrize("drive", [{}, {"drive": SERVO}], ids=["prescribed", "servo"])
def test_shares_and_residual_add_up_to_the_deviation(fidelity, drive):
    data = fx.simulate(rolling(**drive), fidelity=fidelity, **SHORT)
    whole = data.deviation_by_cause.sum(("cause", "leg")) + data.deviation_residual
    np.testing.assert_allclose(whole, data.com_deviation, rtol=0, atol=4 * np.finfo(float).eps)  # metres round at 1e-16


def test_errors_split_the_length_without_remainder():
    found = run_simulation(model.override(rolling(drive=SERVO), **SHORT))
    path, values = found.path.at(found.record.time), found.values()
    errors = errors_of(found.march.system, path, found.record)
    whole = values["leg_length"] - values["leg_length_command"]
    np.testing.assert_allclose(errors.total[..., L], whole, rtol=0, atol=4 * np.finfo(float).eps)
    assert not np.delete(errors.total, L, axis=-1).any()


def test_the_residual_is_of_second_order():
    # Equilibria under 20, 10 and 5 kN: halving the load quarters what the first order leaves out.
    study = light(paper_robot()).replace(motion=STILL)
    study = study.replace(robot=study.robot.replace(gravity=[0, 0, 0]))
    residuals, deviations = [], []
    for scale in (1.0, 0.5, 0.25):
        wrench = scale * np.array([4e3, -3e3, -2e4, 500, 300, 200])
        data = fx.simulate(study, load=wrench, duration=1e-3, step=1e-3, fidelity="lumped").isel(time=0)
        residuals.append(float(np.linalg.norm(data.deviation_residual)))
        deviations.append(float(np.linalg.norm(data.com_deviation)))
    # The next term is smaller by the deviation over the size of the robot, about 1e-3.
    np.testing.assert_allclose(np.log2(np.divide(residuals[:-1], residuals[1:])), 2.0, atol=0.02)
    np.testing.assert_allclose(np.log2(np.divide(deviations[:-1], deviations[1:])), 1.0, atol=0.01)
    assert 1e-12 < residuals[0] < 0.01 * deviations[0]


def test_shares_against_a_pose_moved_by_hand():
    # Length errors made by moving the platform, not by a solver: the shares must give the move back.
    study = paper_robot()
    robot, path = study.robot, fx.kinematics.poses(study.robot, study.motion, np.array([0.7]))
    com, shift, turn = robot.payload.com, 1e-7 * np.array([3.0, -2, 1]), 1e-7 * np.array([-2.0, 1, 4])
    R = Rotation.from_rotvec(turn).as_matrix() @ path.rotation[0]
    position = path.point(com)[0][0] + shift - R @ com
    before, after = (fx.kinematics.leg_lengths(robot.base_joints, robot.platform_joints, x, A)
                     for x, A in ((path.position[0], path.rotation[0]), (position, R)))  # fmt: skip
    bent = np.zeros((1, 6, len(COORDINATES)))
    bent[..., L] = after - before
    errors = Errors(by_cause={"axial-strain": 0 * bent, "bending": bent, "drive": 0 * bent})
    shares = deviation_by_cause(RigidPath(study, np.array([0.7])), errors)
    np.testing.assert_allclose(shares.sum(axis=(1, 2))[0], shift, atol=1e-13)  # lengths round at 1e-16, J^-1 at 100
    assert not shares[:, [0, 2]].any()


def test_a_servo_gives_by_force_over_stiffness():
    data = fx.simulate(rolling(drive=SERVO), **SHORT)
    rest = data.isel(time=0)
    np.testing.assert_allclose(rest.leg_stroke - rest.leg_length_command, -rest.actuator_force / 2e7, rtol=1e-9)
    share = rest.deviation_by_cause.sel(cause="drive")
    robot, path = paper_robot().robot, fx.kinematics.home_pose(paper_robot().robot)
    jacobian = fx.kinematics.length_jacobian(
        robot.base_joints, robot.platform_joints, path.position[0], path.rotation[0], robot.payload.com
    )
    expected = np.linalg.inv(jacobian)[:3].T * (-rest.actuator_force.values / 2e7)[:, None]
    np.testing.assert_allclose(share, expected, rtol=1e-8, atol=1e-15)


def test_stretch_at_rest_is_thrust_over_stiffness():
    # The thrust falls linearly from the drive's force to the joint's: its mean times Lp / EA.
    rest = fx.simulate(paper_robot(), fidelity="lumped", duration=1e-3, step=1e-3).isel(time=0)
    robot = paper_robot().robot
    axis = robot.home_vectors / robot.home_lengths[:, None]
    thrust = np.einsum("li,li->l", rest.joint_force.values, axis)
    piston = robot.legs[0].piston
    expected = -0.5 * (rest.actuator_force.values + thrust) * piston.length / piston.EA
    # Direction of the sagged legs against home: 2e-5 m of deviation over 0.9 m.
    np.testing.assert_allclose(rest.axial_amplitude.values[:, 0], expected, rtol=1e-3)
    assert np.abs(rest.deviation_by_cause.sel(cause="drive")).max() == 0.0


def test_light_legs_stretch_by_their_force_over_stiffness():
    rest = fx.simulate(light(paper_robot()), fidelity="lumped", duration=1e-3, step=1e-3).isel(time=0)
    piston = paper_robot().robot.legs[0].piston
    expected = -rest.actuator_force.values * piston.length / piston.EA
    np.testing.assert_allclose(rest.axial_amplitude.values[:, 0], expected, rtol=1e-6)  # weight 1e-8 N
    assert np.abs(rest.deviation_by_cause.sel(cause="bending")).max() < 1e-14


def test_rigid_legs_have_no_deviation():
    data = fx.simulate(rolling(), fidelity="rigid", **SHORT)
    # Newton leaves the closures at rounding; the payload follows through the inverse Jacobian (about 10).
    assert np.abs(data.com_deviation).max() < 1e-13
    assert np.abs(data.deviation_by_cause).max() < 1e-13


def test_bending_is_foreshortening_plus_offset_of_the_tip():
    data = fx.simulate(rolling(), modes=1, basis="tip-load", **SHORT)
    robot = paper_robot().robot
    stroke, tip2 = data.leg_stroke.values, (data.tip_deflection.values**2).sum(axis=-1)
    free = stroke - robot.legs[0].cylinder.mouth
    expected = (-0.6 / free + 0.5 / stroke) * tip2  # of the static tip-load shape, in closed form
    found = data.leg_length.values - stroke - data.axial_amplitude.values[:, :, 0]
    scale = np.abs(expected).max()
    assert scale > 1e-10
    np.testing.assert_allclose(found, expected, atol=1e-3 * scale + 1e-15)  # third order; rounding of lengths


def test_the_tool_deviates_with_the_turn():
    study = paper_robot()
    payload = study.robot.payload
    tool = payload.com + np.array([0.1, -0.2, 0.5])
    study = study.replace(robot=study.robot.replace(payload=Payload(
        mass=payload.mass, inertia=payload.inertia, com=payload.com, tool=tool)))  # fmt: skip
    data = fx.simulate(study, duration=0.6, step=1e-3, fidelity="lumped")
    R, Rr = (Rotation.from_quat(data[name].values, scalar_first=True)
             for name in ("platform_quaternion", "platform_quaternion_rigid"))  # fmt: skip
    arm = tool - payload.com
    np.testing.assert_allclose(
        data.tool_deviation, data.com_deviation + R.apply(arm) - Rr.apply(arm), atol=4 * np.finfo(float).eps
    )
    # To first order it is the cross product of the turn with the arm.
    turn = data.rotation_deviation.values
    first = data.com_deviation.values + np.cross(turn, Rr.apply(arm))
    np.testing.assert_allclose(data.tool_deviation, first, atol=2 * (turn**2).sum(axis=1).max())
    assert np.abs(data.tool_deviation - data.com_deviation).max() > 1e-6


def test_rotation_deviation_turns_the_rigid_platform_into_the_flexible_one():
    data = fx.simulate(paper_robot(), duration=0.6, step=1e-3, fidelity="lumped")
    R, Rr = (Rotation.from_quat(data[name].values, scalar_first=True).as_matrix()
             for name in ("platform_quaternion", "platform_quaternion_rigid"))  # fmt: skip
    turn = Rotation.from_rotvec(data.rotation_deviation.values).as_matrix()
    np.testing.assert_allclose(turn @ Rr, R, atol=1e-15)
    angle = np.linalg.norm(data.rotation_deviation, axis=1)
    assert 1e-6 < angle.max() < 1e-3
    np.testing.assert_allclose(np.linalg.norm(data.platform_quaternion, axis=1), 1.0, atol=1e-15)


def test_angular_velocity_is_that_of_the_quaternion_in_world_axes():
    # Central differences and the integrator's velocities both err with the square of the step.
    study, errors = paper_robot(profile="smooth"), []
    study = study.replace(motion=study.motion.replace(duration=0.3))
    for h in (1e-3, 5e-4):
        data = fx.simulate(study, duration=0.3, step=h, output_step=h, fidelity="lumped")
        R = Rotation.from_quat(data.platform_quaternion.values, scalar_first=True)
        between = (R[2:] * R[:-2].inv()).as_rotvec() / (2 * h)
        errors.append(np.abs(between - data.platform_angular_velocity.values[1:-1]).max())
    assert np.abs(data.platform_angular_velocity).max() > 2
    assert errors[1] < 1e-3
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)


def test_force_drive_adds_feed_forward_and_feedback():
    drive = ForceDrive(law="rigid", feedback={"stiffness": 1e7, "damping": 1e4})
    data = fx.simulate(rolling(drive=drive), fidelity="lumped", **SHORT).isel(time=0)
    spring = 1e7 * (data.leg_length_command - data.leg_stroke)
    np.testing.assert_allclose(data.actuator_force, data.actuator_force_rigid + spring, rtol=1e-9)
