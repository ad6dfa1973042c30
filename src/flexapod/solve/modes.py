"""Undamped and damped modes of the locked robot about its static equilibrium, Eqs. (T7.2)-(T7.5)."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh, null_space

from flexapod import rigid
from flexapod.errors import ComputationError, InputError
from flexapod.model import Robot, Simulation
from flexapod.solve.damped import damping_ratios
from flexapod.solve.equilibrium import Equilibrium, equilibrium
from flexapod.solve.system import RobotSystem, rigid_state, robot_system
from flexapod.typing import Array


@dataclass(frozen=True, kw_only=True)
class RobotModes:
    """Modes about an equilibrium, ascending.

    ``frequency`` (m,) [Hz] undamped; ``damping_ratio`` (m,) of the damped modes; ``shapes`` (m, N), mass-normalised, in
    the flat coordinates of `system.RobotSystem` (six legs, then CoM in the world frame and rotation in platform axes).
    """

    frequency: Array
    damping_ratio: Array
    shapes: Array
    equilibrium: Equilibrium
    system: RobotSystem


def refuse_pure_force(robot: Robot, what: str) -> None:
    """Raise InputError if a leg's drive is a force without feedback stiffness: nothing holds its stroke."""
    for i, leg in enumerate(robot.legs, start=1):
        if leg.drive.type == "force" and (leg.drive.feedback is None or leg.drive.feedback.stiffness == 0):
            raise InputError(
                f"{what} of leg {i} has no meaning: a pure force drive holds no position, so the stroke is free",
                key="leg.drive",
                value="force",
                allowed='"prescribed", "servo", or a force drive with feedback stiffness',
                next_step='A simulation can start with [initial] start = "moving"',
            )


def locked_equilibrium(
    robot: Robot, simulation: Simulation, path: rigid.Poses, wrench: Array | None = None
) -> tuple[RobotSystem, Equilibrium]:
    """Static equilibrium with the drives locked at the lengths of one rigid pose.

    Raises
    ------
    InputError
        A pure force drive.
    ComputationError
        No equilibrium at this pose.
    """
    refuse_pure_force(robot, "a static equilibrium")
    system = robot_system(robot, simulation)
    state = rigid_state(system, robot, path)
    lengths = rigid.inverse_kinematics(robot, path).length[0]
    found = equilibrium(system, state, lengths, np.zeros(6), np.zeros(6) if wrench is None else wrench)
    if not found.found:
        raise ComputationError(found.reason, next_step="Check the pose for a singularity and the load of the legs.")
    return system, found


def robot_modes(
    robot: Robot, simulation: Simulation, path: rigid.Poses | None = None, wrench: Array | None = None
) -> RobotModes:
    """Modes of the locked robot at a pose (default: home), all degrees of freedom.

    Raises
    ------
    InputError
        Rigid legs on prescribed strokes (nothing can move), or a pure force drive.
    ComputationError
        No equilibrium at this pose, or masses that no body can have.
    """
    path = rigid.home_pose(robot) if path is None else path
    system, found = locked_equilibrium(robot, simulation, path, wrench)
    m = system.matrices(found.state, np.zeros(6) if wrench is None else wrench)
    scale = 1.0 / np.sqrt(np.maximum(np.diag(m.M), 1e-12))
    N = scale[:, None] * null_space(m.G * scale)
    if not N.size:
        raise InputError(
            "leaves nothing that could vibrate with the drives locked",
            key="simulation.fidelity",
            value=simulation.fidelity,
            allowed="lumped, finite-segment, assumed-modes, beam-fem, solid-fem",
        )
    M, K = N.T @ m.M @ N, N.T @ m.K @ N
    try:
        squared, vectors = eigh(0.5 * (K + K.T), M)
    except np.linalg.LinAlgError:
        raise ComputationError(
            "the mass matrix is not positive: a piston is shorter than what its leg has outside the cylinder, or a leg "
            "has no mass at all",
            next_step="Give leg.piston.length at least the largest leg length less leg.cylinder.mouth.",
        ) from None
    omega = np.sqrt(np.maximum(squared, 0.0))
    D = vectors.T @ N.T @ m.D @ N @ vectors
    return RobotModes(
        frequency=omega / (2 * np.pi),
        damping_ratio=damping_ratios(omega, D),
        shapes=(N @ vectors).T,
        equilibrium=found,
        system=system,
    )
