"""What the closures demand of accelerations at a moving start against the accelerations of the rigid path."""

from functools import partial

import numpy as np
import pytest

import flexapod as fx
from flexapod import kinematics
from flexapod.solve.rigid_motion import rigid_state
from flexapod.solve.robot_system import robot_system
from flexapod.solve.time.command_tables import robot_law
from flexapod.solve.time.start import accelerations

pytestmark = pytest.mark.consistency


@pytest.mark.parametrize("t", [0.2, 0.5, 0.83])
def test_closures_of_the_rigid_path(t):
    """The rigid path keeps the closures: G v_dot = - G_dot v holds with its own, independently derived accelerations.

    G_dot v is a fourth-order difference over 1e-4 s: rounding of 1e-16 over that step, 1e-12, times some ten terms,
    beside a remainder of 1e-16 times the fifth derivative, about 1e4 here.
    """
    study = fx.preset("paper-robot")
    system = robot_system(study.robot, study.simulation, 0.0)
    x = rigid_state(system, kinematics.rigid_poses(study.robot, study.motion, np.array([t])))
    law = robot_law(system, study.robot, study.load, partial(kinematics.rigid_poses, study.robot, study.motion))
    table, wrench = law(np.array([t]))
    found = accelerations(system, x, table[0], wrench[0])
    G = system.matrices(x, np.zeros(6)).G
    needed = G @ x.v_dot
    assert np.abs(needed).max() > 0.01  # m/s^2: a wrong sign would show
    np.testing.assert_allclose(G @ found.v_dot, needed, rtol=0, atol=1e-10)
