"""Thrust at which a leg buckles between its joints, with all its parts, Eq. (T25.16)."""

from __future__ import annotations

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array
from flexapod.kinematics.leg_geometry import COORDINATES, Limbs
from flexapod.kinematics.rotations import quaternion
from flexapod.mechanics.leg.layout import columns, leg_parameters
from flexapod.model import Robot, Simulation
from flexapod.solve.kernel import evaluate
from flexapod.solve.robot_system import robot_system
from flexapod.solve.system import System

LENGTHS = 17  # at which loads are computed; between them they are interpolated
LOOSE = 1e-9  # of the largest stiffness in these units: nothing holds such a motion, as the turn of a leg about itself


def leg_loads(robot: Robot, length: Array, system: System | None = None) -> Array:
    """Least thrusts along the lines of the joints at which the legs buckle, drives locked, without weight, (T, n) [N].

    Parameters
    ----------
    robot : Robot
    length : ndarray, shape (T, n)
        Of the legs [m].
    system : System, optional
        Whose shapes count; default assumed modes.
    """
    system = robot_system(robot, Simulation(), 0.0) if system is None else system
    found = kinematics.built_limbs(robot, kinematics.robot_limbs(robot))
    if len(length) <= LENGTHS:
        return np.array([_loads(system, found, row) for row in length])
    grid = np.linspace(length.min(axis=0), length.max(axis=0), LENGTHS)
    loads = np.array([_loads(system, found, row) for row in grid])
    return np.stack([np.interp(x, at, y) for x, at, y in zip(length.T, grid.T, loads.T, strict=True)], axis=1)


def _loads(system: System, legs: Limbs, length: Array) -> Array:
    """Buckling loads of legs of some lengths (n,) [N]."""
    shapes, p = system.kernel.shapes, system.leg_p.copy()
    p[:, columns(leg_parameters(shapes), "gravity")] = 0.0
    q = np.zeros((system.legs, system.n))
    for k, name in enumerate(COORDINATES):
        if shapes.has(name):
            q[:, shapes.index(name)] = legs.home[:, k]
    q[:, shapes.l_index] = length
    if shapes.has("r"):
        q[:, shapes.index("r")] = length
    beta = legs.home[:, COORDINATES.index("beta")]
    axes = np.einsum("nij,nj->ni", legs.frames, np.stack([np.sin(beta), 0 * beta, np.cos(beta)], axis=1))
    lam = np.zeros((system.legs, shapes.rows))
    K, J = _matrices(system, q, lam, p, legs)
    lam[:, :3] = axes
    pushed = K - _matrices(system, q, lam, p, legs)[0]
    locked = system.held.copy()
    locked[:, [shapes.l_index, *shapes.shared_coordinates]] = True
    loads = np.full(system.legs, np.inf)
    for i, (own, less, rows) in enumerate(zip(K, pushed, J, strict=True)):
        rows = rows.copy()
        rows[:3] -= np.outer(axes[i], axes[i] @ rows[:3])  # what moves along the line of the joints is free
        N = _kernel_of(rows[:, ~locked[i]])
        free = np.ix_(~locked[i], ~locked[i])
        loads[i] = _least(N.T @ own[free] @ N, N.T @ less[free] @ N)
    return loads


def _matrices(system: System, q: Array, lam: Array, p: Array, legs: Limbs) -> tuple[Array, Array]:
    n, rows, posed = system.n, system.rows, system.kernel.shapes.reads_pose
    R = np.eye(3) if rows == 3 else legs.rotation
    pose = np.concatenate([np.zeros(3), quaternion(R)])
    outputs = [(n, n)] * 3 + [(rows, n)] + ([(rows, 6), (6, 6), (n, 6)] if posed else [])
    inputs = [q, lam, p, *([pose] if posed else [])]
    found = evaluate(system.kernel, "leg_matrices", system.legs, inputs, outputs)
    return found[2], found[3]


def _kernel_of(rows: Array) -> Array:
    """Directions along which nothing in the rows changes."""
    size = np.linalg.norm(rows, axis=1, keepdims=True)
    _, values, vectors = np.linalg.svd(rows / np.where(size > 0, size, 1.0))
    return vectors[int((values > LOOSE).sum()) :].T


def _least(K: Array, less: Array) -> float:
    """Smallest positive P of det(K - P less) = 0; inf where nothing is compliant."""
    scale = 1 / np.sqrt(np.maximum(np.diag(K), LOOSE * np.diag(K).max(initial=1e-300)))
    values, vectors = np.linalg.eigh(scale[:, None] * K * scale)
    held = values > LOOSE
    Z = scale[:, None] * vectors[:, held] / np.sqrt(values[held])
    found = np.linalg.eigvalsh(Z.T @ less @ Z)
    return 1.0 / float(found[-1]) if found.size and found[-1] > 0 else np.inf
