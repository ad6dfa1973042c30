"""Printed forces of planar robots (Orsino, Hess-Coelho & Malvezzi 2021), by the general equations in a plane."""

import numpy as np
import pytest

from flexapod.kinematics import RigidPoses
from flexapod.model import Simulation
from flexapod.solve.rigid_motion import rigid_motion
from flexapod.solve.robot_system import robot_system
from flexapod.solve.statics.rigid_forces import joint_forces
from flexapod.verification.cases.mechanisms import PRINTED, fast_path, planar_robot

pytestmark = pytest.mark.literature


@pytest.mark.parametrize(("kind", "printed"), PRINTED.items())
def test_printed_forces(kind, printed):
    study, path = planar_robot(kind), fast_path()
    system = robot_system(study, Simulation(fidelity="rigid"), 0.0)
    held = joint_forces(system, *rigid_motion(system, RigidPoses(study, path)), np.zeros(6)).held[0]
    driven = [system.kernel.shapes.index("l" if leg.driven == "stroke" else "chi") for leg in study.legs]
    np.testing.assert_allclose(held[np.arange(3), driven], printed, rtol=0, atol=5.1e-6)  # five decimals
