"""The symmetric eigenproblem K x = lambda M x.

By NumPy: importing SciPy's `linalg` takes longer than all a simulation asks of it.
"""

from __future__ import annotations

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError

__all__ = ["eigh", "finite"]


def finite(*matrices: Array) -> None:
    """Refuse numbers that are not finite: LAPACK answers them with noise, or not at all.

    Raises
    ------
    ComputationError
    """
    if not all(np.isfinite(matrix).all() for matrix in matrices):
        raise ComputationError(
            "the equations hold a number that is not finite",
            next_step="Look in the study for a value that is far too large or far too small",
        )


def eigh(K: Array, M: Array) -> tuple[Array, Array]:
    """Eigenvalues, ascending, and eigenvectors X (columns), X^T M X = 1.

    Parameters
    ----------
    K : (n, n) array
        Symmetric.
    M : (n, n) array
        Symmetric, positive definite: M = L L^T reduces the problem to L^-1 K L^-T y = lambda y, x = L^-T y.

    Raises
    ------
    ComputationError
        A number in them is not finite.
    numpy.linalg.LinAlgError
        M is not positive definite.
    """
    finite(K, M)
    root = np.linalg.cholesky(M)
    half = np.linalg.solve(root, K)
    A = np.linalg.solve(root, half.T)
    values, vectors = np.linalg.eigh(0.5 * (A + A.T))
    return values, np.asarray(np.linalg.solve(root.T, vectors), dtype=np.float64)
