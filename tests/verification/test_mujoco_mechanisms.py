"""Forces of rigid robots of many kinds against MuJoCo, which closes the chains of their legs by itself."""

import numpy as np
import pytest
from tests.helpers.chains import NAMED
from tests.helpers.mechanisms import AMPLITUDES, DURATION, MOVING, OWN, ROBOTS

from flexapod import kinematics
from flexapod.model import CombinedMotion, Simulation
from flexapod.solve.rigid_motion import rigid_motion
from flexapod.solve.robot_system import robot_system
from flexapod.solve.statics.rigid_forces import joint_forces
from flexapod.verification.engines import mujoco_forces

pytestmark = pytest.mark.consistency

pytest.importorskip("mujoco")

WRENCH = np.array([50.0, -30, 80, 5, -4, 6])


@pytest.mark.parametrize(
    "name", [name for name in MOVING if name != "6-FPF"]
)  # its springs are no part of a rigid robot
def test_forces_are_those_of_mujoco(name):
    robot, own = ROBOTS[name](), OWN.get(name, tuple(NAMED))
    pivot = [0.01, -0.02, 0.03] if own == tuple(NAMED) else [0, 0, 0]
    motion = CombinedMotion(amplitudes={axis: AMPLITUDES[axis] for axis in own}, duration=DURATION, pivot=pivot)
    wrench = WRENCH * ([1, 1, 0, 0, 0, 1] if robot.plane else [1] * 6)
    path = kinematics.poses(robot, motion, np.linspace(0.2, 0.8, 3) * DURATION)
    theirs = mujoco_forces.inverse_dynamics(robot, path, wrench)
    system = robot_system(robot, Simulation(fidelity="rigid"), 0.0)
    ours = joint_forces(system, *rigid_motion(system, kinematics.RigidPoses(robot, path)), wrench)
    places = [system.kernel.shapes.index("chi" if leg.driven == "carriage" else "l") for leg in robot.legs]
    driven = np.array([bool(leg.driven) for leg in robot.legs])
    drive = np.where(driven, ours.held[:, range(robot.count), places], 0.0)
    # Rounding times the condition of the closures, some hundred, inverted twice; 3e-13 seen.
    np.testing.assert_allclose(theirs.actuator_force, drive, rtol=0, atol=1e-11 * np.abs(drive).max())
    size = np.abs(ours.joint_force).max()
    np.testing.assert_allclose(theirs.joint_force, ours.joint_force, rtol=0, atol=1e-11 * size)
