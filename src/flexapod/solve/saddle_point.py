"""Dense linear equations: with constraints, and many small ones at once."""

import numpy as np

from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import ComputationError
from flexapod.mechanics.shapes.beam_functions import check_finite


def saddle_solve(A: Array, G: Array, r: Array, g: Array) -> tuple[Array, Array]:
    """Solve [[A, G^T], [G, 0]] (x, lam) = (r, g) with rows and columns scaled to unit size.

    Raises
    ------
    ComputationError
        The matrix is singular, or a number is not finite.
    """
    size = len(A)
    full = np.block([[A, G.T], [G, np.zeros((len(G), len(G)))]])
    if not len(full):
        return r, g
    check_finite(full, r, g)
    scale = 1.0 / np.sqrt(np.maximum(np.abs(full).max(axis=1), 1e-300))
    scale[:size] = 1.0 / np.sqrt(np.maximum(np.abs(np.diag(A)), 1e-12 * np.abs(A).max(initial=0.0)))
    scale[size:] = 1.0 / np.maximum(np.abs(G * scale[:size]).max(axis=1, initial=0.0), 1e-300)
    try:
        solution = scale * np.linalg.solve(scale[:, None] * full * scale, scale * np.concatenate([r, g]))
    except np.linalg.LinAlgError:
        raise ComputationError(
            "the equations of motion are singular: a leg has next to no mass, or the robot is at a singularity",
            next_step="Check rhoA of the pistons, mass and inertia of the cylinders, and the pose.",
        ) from None
    return solution[:size], solution[size:]


def solve_each(A: Array, b: Array) -> Array:
    """Solve A x = b for stacked matrices; NaN where a matrix is singular."""
    try:
        return np.asarray(np.linalg.solve(A, b), dtype=np.float64)
    except np.linalg.LinAlgError:
        if len(A) == 1:
            return np.full(b.shape, np.nan)
        half = len(A) // 2
        return np.concatenate([solve_each(A[:half], b[:half]), solve_each(A[half:], b[half:])])


def inverse_each(A: Array) -> Array:
    """Inverses of stacked matrices; NaN where one is singular."""
    try:
        return np.asarray(np.linalg.inv(A), dtype=np.float64)
    except np.linalg.LinAlgError:
        return solve_each(A, np.broadcast_to(np.eye(A.shape[-1]), A.shape))


def cholesky_each(A: Array) -> tuple[Array, Mask]:
    """Lower factors (..., r, r) of symmetric matrices, and which of these are positive; NaN for the others."""
    try:
        return np.asarray(np.linalg.cholesky(A), dtype=np.float64), np.ones(A.shape[:-2], dtype=bool)
    except np.linalg.LinAlgError:  # does not say of which matrix
        if A.ndim == 2:
            return np.full(A.shape, np.nan), np.zeros((), dtype=bool)
    found = [cholesky_each(part) for part in A]
    return np.stack([root for root, _ in found]), np.stack([positive for _, positive in found])
