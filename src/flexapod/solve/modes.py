"""Undamped and damped modes of the locked robot about its static equilibrium, Eqs. (T7.2)-(T7.5), (T7.16)-(T7.17)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexapod import rigid
from flexapod.errors import ComputationError, InputError
from flexapod.model import Robot, Simulation
from flexapod.solve.damped import damping_ratios
from flexapod.solve.elimination import LegBases, expanded, leg_bases, null_space_of_borders, reduced
from flexapod.solve.equilibrium import FOUND, Equilibria, Equilibrium, equilibria, refuse_fallen
from flexapod.solve.many import RestMatrices, matrices_at_rest, rigid_rest
from flexapod.solve.system import Index, RobotSystem, robot_system
from flexapod.typing import Array, Mask

NO_MASS = (
    "the mass matrix is not positive: a piston is shorter than what its leg has outside the cylinder, or a leg "
    "has no mass at all"
)


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


@dataclass(frozen=True, kw_only=True)
class LockedPoses:
    """A robot with drives locked at the ``lengths`` (P, 6) of a rigid ``path`` of P poses.

    Equilibria, and the matrices ``m`` of those found, ``at``.
    """

    robot: Robot
    path: rigid.Poses
    system: RobotSystem
    simulation: Simulation
    lengths: Array
    equilibria: Equilibria
    at: Index
    m: RestMatrices


@dataclass(frozen=True, kw_only=True)
class ManyModes:
    """Modes about the equilibria found in `LockedPoses`, p of them, ascending; NaN where masses are not `positive`.

    ``frequency`` (p, m) [Hz]; ``positive`` (p,); ``damping_ratio`` (p, m) and ``shapes`` (p, m, N) as in `RobotModes`,
    empty unless asked for.
    """

    frequency: Array
    positive: Mask
    damping_ratio: Array
    shapes: Array


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


def locked_poses(robot: Robot, simulation: Simulation, path: rigid.Poses, wrench: Array | None = None) -> LockedPoses:
    """Static equilibria with the drives locked at the lengths of each of P rigid poses.

    Raises
    ------
    InputError
        A pure force drive.
    """
    refuse_pure_force(robot, "a static equilibrium")
    system, load = robot_system(robot, simulation), np.zeros(6) if wrench is None else wrench
    start = rigid_rest(system, robot, path)
    lengths = start.q[:, :, system.kernel.shapes.l_index]
    found = equilibria(system, start, lengths, np.zeros(lengths.shape), load)
    at = np.flatnonzero(found.code == FOUND)
    m = matrices_at_rest(system, found.states[at], load)
    return LockedPoses(
        robot=robot, path=path, system=system, simulation=simulation, lengths=lengths, equilibria=found, at=at, m=m
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
    locked = locked_poses(robot, simulation, path, wrench)
    return locked.system, the_equilibrium(locked)


def the_equilibrium(locked: LockedPoses) -> Equilibrium:
    """The equilibrium of a single pose; ComputationError if there is none."""
    found = locked.equilibria.one(0)
    if not found.found:
        raise ComputationError(found.reason, next_step="Check the pose for a singularity and the load of the legs.")
    refuse_fallen(locked.robot, locked.path, found.state.pose)
    return found


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
    return the_modes(locked_poses(robot, simulation, rigid.home_pose(robot) if path is None else path, wrench))


def the_modes(locked: LockedPoses) -> RobotModes:
    """Modes at a single pose; raises as `robot_modes`."""
    found, modes = the_equilibrium(locked), modes_of(locked, shapes=True)
    if not modes.positive[0]:
        raise ComputationError(
            NO_MASS, next_step="Give leg.piston.length at least the largest leg length less leg.cylinder.mouth."
        )
    return RobotModes(
        frequency=modes.frequency[0],
        damping_ratio=modes.damping_ratio[0],
        shapes=modes.shapes[0],
        equilibrium=found,
        system=locked.system,
    )


def modes_of(locked: LockedPoses, *, shapes: bool = False) -> ManyModes:
    """Modes at all equilibria, Eq. (T7.3), on the admissible motions (T7.16); with damping and ``shapes`` if asked.

    Raises
    ------
    InputError
        Rigid legs on prescribed strokes: nothing can move.
    """
    bases = leg_bases(locked.system, locked.m)
    N = null_space_of_borders(bases, locked.system.kernel.shapes.l_index)
    M, K = _reduced(bases, N, locked.m.M, locked.m.payload_M), _reduced(bases, N, locked.m.K, locked.m.payload_K)
    if not M.shape[-1]:
        raise InputError(
            "leaves nothing that could vibrate with the drives locked",
            key="simulation.fidelity",
            value=locked.simulation.fidelity,
            allowed="lumped, finite-segment, assumed-modes, beam-fem, solid-fem",
        )
    back, positive = _inverse_roots(M)
    A = back @ K @ back.swapaxes(1, 2)
    A = 0.5 * (A + A.swapaxes(1, 2))
    nothing = np.zeros((0, M.shape[-1]))
    if not shapes:
        omega = _omega(np.linalg.eigvalsh(A), positive)
        return ManyModes(frequency=omega / (2 * np.pi), positive=positive, damping_ratio=nothing, shapes=nothing)
    squared, vectors = np.linalg.eigh(A)
    omega, z = _omega(squared, positive), back.swapaxes(1, 2) @ vectors
    flat = expanded(bases, z if N is None else N @ z)
    return ManyModes(
        frequency=omega / (2 * np.pi),
        positive=positive,
        damping_ratio=_damping(locked, omega, flat),
        shapes=flat.swapaxes(1, 2),
    )


def _reduced(bases: list[LegBases], N: Array | None, legs: Array, payload: Array) -> Array:
    whole = reduced(bases, legs, payload).dense()
    return whole if N is None else N.swapaxes(1, 2) @ whole @ N


def _inverse_roots(M: Array) -> tuple[Array, Mask]:
    """Inverses of the Cholesky factors of mass matrices (p, r, r), and which of these are positive."""
    one = np.broadcast_to(np.eye(M.shape[-1]), M.shape)
    try:
        root, positive = np.linalg.cholesky(M), np.ones(len(M), dtype=bool)
    except np.linalg.LinAlgError:  # does not say of which matrix
        positive = np.array([_is_positive(matrix) for matrix in M], dtype=bool)
        root = np.linalg.cholesky(np.where(positive[:, None, None], M, one))
    return np.asarray(np.linalg.solve(root, one), dtype=np.float64), np.asarray(positive, dtype=bool)


def _is_positive(matrix: Array) -> bool:
    try:
        np.linalg.cholesky(matrix)
    except np.linalg.LinAlgError:
        return False
    return True


def _omega(squared: NDArray[np.floating], positive: Mask) -> Array:
    return np.where(positive[:, None], np.sqrt(np.maximum(squared, 0.0)), np.nan)


def _damping(locked: LockedPoses, omega: Array, flat: Array) -> Array:
    """Damping ratios (p, m) of shapes (p, N, m)."""
    p, n = len(flat), locked.system.n
    legs = flat[:, :-6].reshape(p, 6, n, flat.shape[2])
    D = (legs.swapaxes(-1, -2) @ locked.m.D @ legs).sum(axis=1)
    found = [damping_ratios(w, d) if np.isfinite(w).all() else w for w, d in zip(omega, D, strict=True)]
    return np.array(found).reshape(omega.shape)
