"""Linear equations with constraints, dense."""

import numpy as np

from flexapod.arrays import Array
from flexapod.bases.eigen import finite
from flexapod.errors import ComputationError

__all__ = ["saddle_solve"]


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
    finite(full, r, g)
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
