"""Drives at rest, whatever they drive: a stroke, a carriage; prescribed, sprung, pushing."""

from unittest.mock import patch

import numpy as np
import pytest
from tests.helpers.mechanisms import hexapod, sliders, three_rps
from tests.helpers.runs import uncompiled_kernel

from flexapod import kinematics
from flexapod.kinematics.leg_geometry import DRIVEN
from flexapod.model import Feedback, ForceDrive, Simulation
from flexapod.model.leg.drive import ServoDrive
from flexapod.solve.batch import port_forces
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.statics.ideal_robot import rigid_forces
from flexapod.solve.statics.static_loads import drive_values

pytestmark = pytest.mark.consistency

ROBOTS = {"stroke": hexapod, "carriage": lambda: sliders("PUS"), "hinges": three_rps}
SPRING = Feedback(stiffness=3e6, damping=1e3)
RIGID, LUMPED = Simulation(fidelity="rigid"), Simulation(fidelity="lumped")


@pytest.fixture(autouse=True)
def interpreted():
    with patch("flexapod.solve.robot_system.kernel", uncompiled_kernel):
        yield


def driven(model, drive):
    return model.replace(legs=tuple(leg.replace(drive=drive) for leg in model.legs))


def at_rest(model, simulation):
    locked = locked_poses(model, simulation, kinematics.home_pose(model))
    assert locked.equilibria.code == 0
    states = locked.equilibria.states
    forces = port_forces(locked.system, states, locked.command, locked.acts.force)
    return locked, states, drive_values(locked.system, model, forces)[0]


@pytest.mark.parametrize("what", ROBOTS)
@pytest.mark.parametrize("simulation", [RIGID, LUMPED], ids=["rigid", "lumped"])
def test_prescribed_drives_hold_what_the_rigid_robot_needs(what, simulation):
    model = ROBOTS[what]()
    needed = rigid_forces(kinematics.RigidPoses(model, kinematics.home_pose(model)), np.zeros(6)).drive_force[0]
    _, states, force = at_rest(model, simulation)
    # Rigid legs: the same statics twice. Lumped ones sag by some micrometres of half a metre.
    np.testing.assert_allclose(force, needed, rtol=1e-10 if simulation is RIGID else 1e-3)
    assert np.isfinite(states.lam).all()


@pytest.mark.parametrize("what", ROBOTS)
def test_drives_that_push_with_the_rigid_force_do_not_sag(what):
    """Law "rigid": the feedback has nothing to give, on a stroke and on a carriage."""
    model = driven(ROBOTS[what](), ForceDrive(feedback=SPRING))
    locked, states, _ = at_rest(model, RIGID)
    np.testing.assert_allclose(states.q, locked.start.q, atol=1e-12)
    np.testing.assert_allclose(states.pose, locked.start.pose, atol=1e-12)


@pytest.mark.parametrize("what", ROBOTS)
def test_servos_give_way_by_their_force_over_their_stiffness(what):
    model = driven(ROBOTS[what](), ServoDrive(stiffness=4e7))
    locked, states, force = at_rest(model, RIGID)
    there = kinematics.robot_limbs(model).state == DRIVEN
    name = "chi" if there[0, 0] else "l"
    k = locked.system.kernel.shapes.index(name)
    np.testing.assert_allclose(4e7 * (locked.start.q - states.q)[0, :, k], force, rtol=1e-6)
    needed = rigid_forces(kinematics.RigidPoses(model, kinematics.home_pose(model)), np.zeros(6)).drive_force[0]
    np.testing.assert_allclose(force, needed, rtol=1e-3)
