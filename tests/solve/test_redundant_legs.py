"""Rigid robots on more legs than they need, in time."""

import numpy as np
import pytest
from tests.helpers.moving import moving
from tests.helpers.runs import balance, run_robot
from tests.helpers.samples import sample_study

from flexapod import kinematics
from flexapod.common.errors import ComputationError
from flexapod.solve.statics.ideal_robot import rigid_forces

pytestmark = pytest.mark.consistency


def test_forces_of_eight_rigid_legs_are_those_of_the_rigid_robot():
    """Drives and joints at every instant against the equations of motion on the path, shared by the same rule."""
    errors = []
    for h in (1e-3, 5e-4):
        study = moving("8-UPS", fidelity="rigid", modes=None, step=h)
        study = study.replace(initial=study.initial.replace(start="moving"))
        run = run_robot(study)
        path = kinematics.poses(study.robot, study.motion, run["time"])
        forces = rigid_forces(kinematics.RigidPoses(study.robot, path), np.zeros(6))
        assert forces.open_forces == 2
        scale = np.abs(forces.drive_force).max()
        errors.append(np.abs(run["drive"][..., 0] - forces.drive_force).max() / scale)
        assert np.abs(run["lam"] - forces.joint_force).max() < 2 * errors[-1] * scale
        assert run["closure"].max() < 1e-13
        assert np.ptp(balance(run)) < 2e-3 * np.ptp(run["sums"][:, 1])
    # Accelerations of second order in a motion of a hundred steps; rounding in forces is ten times below at 0.5 ms.
    assert errors[1] < 2e-3
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)


def test_a_welded_robot_of_rigid_legs_cannot_move():
    with pytest.raises(ComputationError, match=r"rigid legs do not fit at t = .* leg 1 misses what holds it by"):
        run_robot(moving("6-FPF", fidelity="rigid", modes=None))


def test_drives_with_a_force_of_their_own_have_it():
    """Gas springs of 500 N were shown with the 114 N of stiffnesses that share; now no force is left open."""
    study = sample_study("eight-legs")
    home = kinematics.home_pose(study.robot)
    forces = rigid_forces(kinematics.RigidPoses(study.robot, home), np.zeros(6))
    np.testing.assert_allclose(forces.drive_force[0, 6:], 500.0, rtol=1e-12)
    assert forces.open_forces == 0
    weight = study.robot.payload.mass * study.robot.gravity
    np.testing.assert_allclose(forces.joint_force[0].sum(axis=0), -weight, atol=1e-9)
    arms = study.robot.platform_joints - study.robot.com
    np.testing.assert_allclose(np.cross(arms, forces.joint_force[0]).sum(axis=0), 0.0, atol=1e-9)
