"""Forces in all joints of rigid robots: against Newton-Euler, by symmetry, by work, and where some are open."""

from dataclasses import replace

import numpy as np
import pytest
from tests.helpers.runs import paper_robot
from tests.helpers.systems import hexapod, hold, octopod, tripod

from flexapod import kinematics
from flexapod.common.errors import ComputationError
from flexapod.kinematics.jacobian import length_jacobian
from flexapod.model import override
from flexapod.solve.batch import Rates, matrices_at_rest, residual
from flexapod.solve.rigid_motion import rigid_motion
from flexapod.solve.robot_system import robot_system
from flexapod.solve.statics.equilibrium import equilibria
from flexapod.solve.statics.minimum_energy_forces import open_forces
from flexapod.solve.statics.rigid_forces import displacement_by_error, joint_forces

pytestmark = pytest.mark.consistency

WRENCH = np.array([50.0, -30.0, -200.0, 5.0, 4.0, -3.0])


def moving(instants=7):
    study = override(paper_robot(), fidelity="rigid")
    robot = study.robot.replace(payload=study.robot.payload.replace(com=[0.02, -0.03, 0.1], tool=[0.1, 0.0, 0.2]))
    path = kinematics.poses(robot, study.motion, np.linspace(0.05, 0.9 * study.duration, instants))
    system = robot_system(robot, study.simulation, 0.0)
    return robot, path, system, *rigid_motion(system, kinematics.RigidPoses(robot, path))


def test_six_legs_need_what_newton_and_euler_say():
    robot, path, system, x, rates = moving()
    found, expected = joint_forces(system, x, rates, WRENCH), kinematics.inverse_dynamics(robot, path, WRENCH)
    size = np.abs(expected.joint_force).max()
    assert found.open_forces == 0
    np.testing.assert_allclose(found.held[..., 2], expected.actuator_force, atol=1e-10 * size)
    np.testing.assert_allclose(found.joint_force, expected.joint_force, atol=1e-10 * size)
    assert (found.joint_moment == 0).all()
    assert (found.hub == 0).all()


def test_errors_of_length_displace_the_payload_as_the_jacobian_says():
    robot, path, system, x, _ = moving()
    found = displacement_by_error(system, x)
    J = length_jacobian(robot.base_joints, robot.platform_joints, path.position, path.rotation, robot.payload.com)
    inverse = np.linalg.inv(J)
    turning = path.rotation.swapaxes(1, 2) @ inverse[:, 3:]  # payload steps turn in its own axes
    expected = np.concatenate([inverse[:, :3], turning], axis=1)
    np.testing.assert_allclose(found[:, :, 2], expected.swapaxes(1, 2), atol=1e-12 * np.abs(expected).max())
    assert (np.delete(found, 2, axis=2) == 0).all()


def in_motion(system, seed=3):
    """Rates that need not fit the closures: forces are linear in them all the same."""
    rng = np.random.default_rng(seed)
    shapes = {"v": (1, system.legs, system.n), "u": (1, 6)}
    return Rates(**{name + dot: rng.normal(size=size) for name, size in shapes.items() for dot in ("", "_dot")})


def at_rest(system):
    legs, hub = np.zeros((1, system.legs, system.n)), np.zeros((1, 6))
    return Rates(v=legs, v_dot=legs, u=hub, u_dot=hub)


@pytest.mark.parametrize("make", [tripod, hexapod, octopod, lambda **k: hold(*hexapod(**k), "beta", [0, 4])])
def test_all_free_coordinates_balance(make):
    system, x = make(modes=0, axial=0)
    rates = in_motion(system)
    found = joint_forces(system, x, rates, WRENCH)
    r, payload, _ = residual(
        system, replace(x, lam=found.closure), x.q[..., system.ports], rates.v[..., system.ports], WRENCH, rates
    )
    size = np.abs(found.closure).max()
    np.testing.assert_allclose(r, found.held, atol=1e-11 * size)
    np.testing.assert_allclose(payload, found.hub, atol=1e-11 * size)
    assert found.open_forces == open_forces(system) == system.held.sum() - 6


def test_open_forces_are_those_of_the_flexible_robot_that_is_ever_stiffer():
    """Eight legs without weight: what the payload pushes with is shared by stretch alone."""
    light = {name: 0.0 for name in ("rhoA", "cylinder_mass", "cylinder_inertia", "cylinder_axial_inertia")}
    uneven = [light | {"EA": 4e7 * (1 + 0.3 * k)} for k in range(8)]
    system, x = octopod(modes=0, axial=0, legs=uneven)
    still = at_rest(system)
    found = joint_forces(system, x, still, WRENCH)
    assert found.open_forces == 2
    stiff, start = octopod(modes=0, axial=1, legs=[leg | {"EA": 1e6 * leg["EA"]} for leg in uneven])
    command = start.q[..., stiff.ports]
    flexible = equilibria(stiff, start, command, np.zeros_like(command), WRENCH)
    # The flexible legs give way by 1e-11 m, so that rounding of positions, 1e-16 m, is 1e-5 of their forces.
    np.testing.assert_allclose(
        found.held[0, :, 2], flexible.states.drive[0, :, 0], atol=1e-4 * np.abs(found.held).max()
    )
    shared = equilibria(system, x, x.q[..., system.ports], 0 * x.drive, WRENCH)
    assert shared.code == 0
    np.testing.assert_allclose(shared.states.drive[0, :, 0], found.held[0, :, 2], rtol=1e-9)


def test_hinge_moments_are_the_reactions_of_a_guided_platform():
    """3-RPS: the force across each hinge times the leg is its moment, weight by symmetry the same in all legs."""
    system, x = tripod(modes=0, axial=0, com=(0.0, 0.0, 0.1))
    still = at_rest(system)
    found = joint_forces(system, x, still, np.zeros(6))
    np.testing.assert_allclose(found.held[0, :, 1], 0.0, atol=1e-11 * np.abs(found.held).max())
    np.testing.assert_allclose(found.held[0, :, 2], found.held[0, 0, 2], rtol=1e-12)
    torque = joint_forces(system, x, still, np.array([0, 0, 0, 0, 0, 12.0]))  # about the vertical: hinges alone
    across = 12.0 / (3 * 0.2)
    length = x.q[0, 0, 2]
    np.testing.assert_allclose(np.abs(torque.held[0, :, 1] - found.held[0, :, 1]), across * length, rtol=1e-10)


def test_a_singular_pose_is_said():
    system, x = tripod(modes=0, axial=0)
    flat = replace(system, joint_p=0.0 * system.joint_p)  # all joints in one point: nothing holds the payload's turn
    still = at_rest(system)
    for compute in (lambda: joint_forces(flat, x, still, WRENCH), lambda: displacement_by_error(flat, x)):
        with pytest.raises(ComputationError, match="singular"):
            compute()


def test_closures_of_many_poses_are_those_of_each():
    _, _, system, x, rates = moving(5)
    whole = joint_forces(system, x, rates, WRENCH)
    for k in range(5):
        one = joint_forces(system, x[slice(k, k + 1)], rates[slice(k, k + 1)], WRENCH)
        np.testing.assert_allclose(one.held[0], whole.held[k], rtol=1e-12, atol=1e-9)
    assert matrices_at_rest(system, x, np.zeros(6)).X is None
