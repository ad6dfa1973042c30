"""Forces in all joints of rigid robots of many kinds against virtual power with exact rates."""

import numpy as np
import pytest
from tests.helpers.chains import NAMED, as_mechanism
from tests.helpers.mechanisms import AMPLITUDES, DURATION, MOVING, OWN, ROBOTS, quintic
from tests.oracles import virtual_power

from flexapod import kinematics
from flexapod.model import CombinedMotion, Simulation
from flexapod.solve.rigid_motion import rigid_motion
from flexapod.solve.robot_system import robot_system
from flexapod.solve.statics.rigid_forces import joint_forces

pytestmark = pytest.mark.consistency

WRENCH = np.array([50.0, -30, 80, 5, -4, 6])
IDEAL = [name for name in MOVING if name != "6-FPF"]  # its springs are no part of the rigid robot


@pytest.mark.parametrize("name", IDEAL)
def test_forces_are_those_of_virtual_power(name):
    robot, own = ROBOTS[name](), OWN.get(name, tuple(NAMED))
    pivot = [0.01, -0.02, 0.03] if own == tuple(NAMED) else [0, 0, 0]
    motion = CombinedMotion(amplitudes={axis: AMPLITUDES[axis] for axis in own}, duration=DURATION, pivot=pivot)
    t, wrench = np.array([0.12, 0.3]), WRENCH * ([1, 1, 0, 0, 0, 1] if robot.plane else [1] * 6)
    system = robot_system(robot, Simulation(fidelity="rigid"), 0.0)
    ours = joint_forces(system, *rigid_motion(system, kinematics.rigid_poses(robot, motion, t)), wrench)
    shapes = system.kernel.shapes
    mechanism, found = as_mechanism(robot, own, pivot), None
    seen = [0, 1] if robot.plane else [0, 1, 2]  # what acts across a plane is left open
    for i, instant in enumerate(t):
        law = np.array([quintic(AMPLITUDES[axis], instant) for axis in own]).T
        found = virtual_power.follow(mechanism, *law, guess=found)
        other = virtual_power.forces(mechanism, found, wrench)
        places = [shapes.index("chi" if leg.driven == "carriage" else "l") for leg in robot.legs]
        drive = np.array(
            [
                ours.held[i, j, k] if leg.driven else np.nan
                for j, (leg, k) in enumerate(zip(robot.legs, places, strict=True))
            ]
        )
        size = np.abs(other.tip_force).max()
        # Rounding times the condition of the closures, some hundred; 1e-13 seen.
        np.testing.assert_allclose(drive, other.drive, rtol=0, atol=1e-11 * np.nanmax(np.abs(other.drive)))
        np.testing.assert_allclose(ours.joint_force[i][:, seen], other.tip_force[:, seen], rtol=0, atol=1e-11 * size)
        if not robot.plane:
            np.testing.assert_allclose(ours.joint_moment[i], other.tip_moment, rtol=0, atol=1e-11 * size)
    assert ours.open_forces == other.open
