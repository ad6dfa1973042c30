"""Eight legs, one of them too long: forces at large displacement are those of the least energy of bars."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.helpers.mechanisms import eight

from flexapod.kinematics import Poses
from flexapod.model import Simulation
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.statics.equilibrium import equilibria

pytestmark = pytest.mark.consistency

MISFIT = 1e-4


def least_energy(robot, position, turn, lengths):
    """Thrusts (8,) of bars of a length and EA / Lp where the platform, without weight, comes to rest (Newton)."""
    stiffness = np.array([leg.piston.EA / leg.piston.length for leg in robot.legs])
    for _ in range(12):
        arms = robot.platform_joints @ turn.T
        ways = position + arms - robot.base_joints
        now = np.linalg.norm(ways, axis=1)
        along = ways / now[:, None]
        J = np.hstack([along, np.cross(arms, along)])
        thrust = stiffness * (lengths - now)
        across = (np.eye(3) - along[:, :, None] * along[:, None, :]) * (thrust / now)[:, None, None]
        turning = np.cross(np.eye(3), arms[:, None]).swapaxes(1, 2)
        moves = np.concatenate([np.broadcast_to(np.eye(3), (len(arms), 3, 3)), turning], axis=2)
        K = (J.T * stiffness) @ J - np.einsum("nai,nab,nbj->ij", moves, across, moves)
        step = np.linalg.solve(K, J.T @ thrust)
        position, turn = position + step[:3], Rotation.from_rotvec(step[3:]).as_matrix() @ turn
        if np.abs(step).max() < 1e-15:
            break
    return thrust


@pytest.mark.usefixtures("uncompiled")
@pytest.mark.parametrize("fidelity", ["lumped", "assumed-modes"])
def test_a_leg_that_is_too_long(fidelity):
    robot = eight().replace(gravity=[0, 0, 0])
    position, turn = (
        robot.home_position + np.array([0.03, -0.02, 0.04]),
        Rotation.from_rotvec([0.2, -0.15, 0.1]).as_matrix(),
    )
    held = locked_poses(robot, Simulation(fidelity=fidelity), Poses.at_rest(position, turn))
    command = held.command.copy()
    command[0, 2, 0] += MISFIT
    found = equilibria(held.system, held.start, command, held.acts.force, np.zeros(6))
    assert found.code[0] == 0
    known = least_energy(robot, position, turn, command[0, :, 0])
    assert np.abs(known).max() > 1e3
    # The stretch of a kilonewton, 1e-5 m, of lengths that are known to 1e-16 m.
    np.testing.assert_allclose(found.states.drive[0, :, 0], known, rtol=0, atol=1e-7 * np.abs(known).max())
