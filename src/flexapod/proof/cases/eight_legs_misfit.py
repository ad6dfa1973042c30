"""Eight legs of which one is too long."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from flexapod.model import Robot, Simulation
from flexapod.proof.case import Case, Check, checks
from flexapod.proof.parallel_robots import eight_legs
from flexapod.proof.unlike import without_gravity
from flexapod.rigid import Poses
from flexapod.solve.equilibrium import equilibria
from flexapod.solve.modes import locked_poses
from flexapod.typing import Array

MISFIT, LEG = 1e-4, 2  # m, of leg 3
SHIFT, TURN = np.array([0.03, -0.02, 0.04]), np.array([0.2, -0.15, 0.1])


def least_energy(robot: Robot, position: Array, R: Array, lengths: Array) -> Array:
    """Thrusts (8,) of bars of given lengths where a platform without weight comes to rest: Newton's method."""
    k = np.array([leg.piston.EA / leg.piston.length for leg in robot.legs])
    thrust = np.zeros(len(k))
    for _ in range(12):
        arms = robot.platform_joints @ R.T
        ways = position + arms - robot.home_bases
        now = np.linalg.norm(ways, axis=1)
        along = ways / now[:, None]
        J, thrust = np.hstack([along, np.cross(arms, along)]), k * (lengths - now)
        across = (np.eye(3) - along[:, :, None] * along[:, None, :]) * (thrust / now)[:, None, None]
        turns = np.cross(np.eye(3), arms[:, None]).swapaxes(1, 2)
        moves = np.concatenate([np.broadcast_to(np.eye(3), turns.shape), turns], axis=2)
        K = (J.T * k) @ J - np.einsum("nai,nab,nbj->ij", moves, across, moves)
        step = np.linalg.solve(K, J.T @ thrust)
        position, R = position + step[:3], Rotation.from_rotvec(step[3:]).as_matrix() @ R
    return thrust


def _compute() -> list[Check]:
    robot = without_gravity(eight_legs())
    robot = robot.replace(legs=tuple(leg.replace(axial_modes=2) for leg in robot.legs))
    position, R = robot.home_position + SHIFT, Rotation.from_rotvec(TURN).as_matrix()
    settings = Simulation(fidelity="assumed-modes", modes=6)
    held = locked_poses(robot, settings, Poses.at_rest(position, R))
    command = held.command.copy()
    command[0, LEG, 0] += MISFIT
    found = equilibria(held.system, held.start, command, held.acts.force, np.zeros(6))
    exact = least_energy(robot, position, R, command[0, :, 0])
    size, names = np.abs(exact).max(), [f"leg {i + 1}" for i in range(8)]
    return checks(names, exact, found.states.drive[0, :, 0], 1e-6 * size, "N", absolute=True)


EIGHT_LEGS_MISFIT = Case(
    name="eight-legs-misfit",
    statement="Thrusts of an 8-UPS far from home, turned by 0.27, whose third leg is 0.1 mm too long",
    source="least energy of eight bars between the joints, by Newton's method, without shapes or multipliers",
    argument="1e-6 of the largest thrust: kilonewtons from 1e-5 m of stretch, in lengths known to 1e-15 m",
    compute=_compute,
)
