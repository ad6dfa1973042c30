"""Rigid legs in the multibody model against the Newton-Euler inverse dynamics, an independent formulation."""

import numpy as np
import pytest
from tests.helpers.runs import paper_robot, run_robot

from flexapod import kinematics
from flexapod.model import AxisMotion
from flexapod.solve.rigid_motion import rigid_state
from flexapod.solve.robot_system import robot_system

pytestmark = pytest.mark.consistency


@pytest.mark.parametrize("kind", ["surge", "sway", "heave", "roll", "pitch", "yaw"])
def test_forces_at_the_rigid_path(kind):
    study = paper_robot(fidelity="rigid")
    amplitude = 0.05 if kind in ("surge", "sway", "heave") else 0.3
    motion = AxisMotion(type=kind, amplitude=amplitude, duration=0.4, profile="quintic", pivot=[0.02, 0.01, 0.1])
    system, wrench = robot_system(study.robot, study.simulation, 0.0), np.array([30.0, -20, 10, 5, -4, 3])
    for t in (0.0, 0.11, 0.23):
        path = kinematics.poses(study.robot, motion, np.array([t]))
        x = rigid_state(system, kinematics.RigidPoses(study.robot, path))
        r, g, _ = system.residual(x, np.zeros((6, 1, 4)), wrench)
        assert np.abs(g).max() < 1e-15  # metres of order one, to rounding
        # KKT: G^T (lam, -f) = -r, as many equations as the 24 multipliers once the payload's are included.
        G = np.vstack([system.matrices(x, wrench).G, np.eye(system.size)[system.fixed_mask]])
        multipliers, *_ = np.linalg.lstsq(G.T, -r, rcond=None)
        forces = kinematics.inverse_dynamics(study.robot, path, wrench)
        scale = np.abs(forces.actuator_force).max()
        np.testing.assert_allclose(-multipliers[18:], forces.actuator_force[0], rtol=0, atol=1e-12 * scale)  # 5e-15
        np.testing.assert_allclose(multipliers[:18].reshape(6, 3), forces.joint_force[0], rtol=0, atol=1e-12 * scale)


def march_error(profile, h, duration=1.2):
    study = paper_robot(profile=profile, fidelity="rigid", step=h, output_step=4e-3, duration=duration)
    run = run_robot(study)
    forces = kinematics.inverse_dynamics(
        study.robot, kinematics.poses(study.robot, study.motion, run["time"])
    ).actuator_force
    return run["time"], np.abs(run["drive"][:, :, 0] - forces) / np.abs(forces).max()


def test_marched_forces_are_second_order_on_a_smooth_law():
    # Index-3 forces carry rounding noise that grows as 1/h^2; at 1 ms it is still 100 times below the error.
    errors = [march_error("smooth", h)[1].max() for h in (4e-3, 2e-3, 1e-3)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    np.testing.assert_allclose(orders, 2.0, atol=0.1)


def test_marched_forces_on_the_quintic_away_from_its_ends():
    # The quintic's jumps in jerk excite the integrator's damped mode for some tens of steps; 50 ms are 100 steps.
    time, error = march_error("quintic", 5e-4)
    inner = (time > 0.05) & (np.abs(time - 1.0) > 0.05)
    assert error[inner].max() < 1e-4
