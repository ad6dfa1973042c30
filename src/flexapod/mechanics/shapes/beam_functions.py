"""Eigenfunctions of uniform beams clamped at zeta = 0, without cancellation, and the symmetric eigenproblem.

Every function of the Euler-Bernoulli beams is written as
``A cos(e z) + B sin(e z) + C exp(-e z) + D exp(-e (1 - z))``, Eq. (T1.2): all four terms stay below one in
magnitude, so that high modes keep their digits where cosh - sinh would lose them. The eigenproblem
K x = lambda M x is solved by NumPy: importing SciPy's `linalg` takes longer than all a simulation asks of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError


@dataclass(frozen=True, kw_only=True)
class BeamFunction:
    """One eigenfunction phi(zeta) with root ``eps`` and coefficients ``(A, B, C, D)`` of Eq. (T1.2)."""

    eps: float
    coefficients: tuple[float, float, float, float]

    def __call__(self, zeta: Array, derivative: int = 0) -> Array:
        """Value (or ``derivative``-th derivative in zeta) at ``zeta`` (any shape), dimensionless."""
        return np.tensordot(np.array(self.coefficients), _terms(self.eps, zeta, derivative), axes=1)


def _terms(eps: float, zeta: Array, derivative: int) -> Array:
    """Return the four terms of Eq. (T1.2), shape (4, ...), differentiated in zeta."""
    z, turn = eps * np.asarray(zeta, dtype=float), 0.5 * np.pi * derivative
    return eps**derivative * np.array(
        [np.cos(z + turn), np.sin(z + turn), (-1.0) ** derivative * np.exp(-z), np.exp(z - eps)]
    )


def _clamped_rows(eps: float) -> list[Array]:
    """Return the clamp phi(0) = phi'(0) = 0 as two rows on (A, B, C, D); derivatives are divided by eps^n."""
    zero = np.zeros(())
    return [_terms(eps, zero, 0), _terms(eps, zero, 1) / eps]


def _free_tip_rows(eps: float, mu: float, inertia: float) -> list[Array]:
    """Tip with mass ratio mu = m/(rhoA L) and rotary inertia ratio J/(rhoA L^3), Eq. (T1.3)."""
    d = [_terms(eps, np.ones(()), n) / eps**n for n in range(4)]
    return [d[2] - inertia * eps**3 * d[1], d[3] + mu * eps * d[0]]


def clamped_tip_mass(count: int, mu: float, inertia: float) -> list[BeamFunction]:
    """First ``count`` eigenfunctions with a tip body, norm int phi^2 dzeta = 1, positive curvature at the clamp.

    Parameters
    ----------
    count : int
    mu, inertia : float
        m/(rhoA L) and J/(rhoA L^3) of the tip body, Eq. (T1.3).
    """
    from scipy.optimize import root_scalar  # heavy, and the default basis of robots needs no roots

    def matrix(eps: float) -> Array:
        rows = np.array(_clamped_rows(eps) + _free_tip_rows(eps, mu, inertia))
        return rows / np.linalg.norm(rows, axis=1, keepdims=True)  # a heavy tip must not drown the clamp

    def characteristic(eps: float) -> float:
        return float(np.linalg.det(matrix(eps)))

    found: list[BeamFunction] = []
    grid = np.arange(0.05, np.pi * (count + 2), 0.1)
    values = np.array([characteristic(e) for e in grid])
    for i in np.flatnonzero(np.sign(values[:-1]) != np.sign(values[1:]))[:count]:
        root = root_scalar(characteristic, bracket=(grid[i], grid[i + 1]), xtol=1e-15, rtol=4 * np.finfo(float).eps)
        eps = float(root.root)
        null = np.linalg.svd(matrix(eps))[2][-1]
        found.append(_normalised(eps, null))
    return found


def _normalised(eps: float, coefficients: Array) -> BeamFunction:
    raw = BeamFunction(eps=eps, coefficients=tuple(coefficients.tolist()))
    zeta, weight = gauss_unit()
    norm = np.sqrt(weight @ raw(zeta) ** 2) * np.sign(raw(np.zeros(1), 2)[0])
    return BeamFunction(eps=eps, coefficients=tuple((coefficients / norm).tolist()))


def gauss_unit(points: int = 96) -> tuple[Array, Array]:
    """Gauss-Legendre abscissas and weights on [0, 1]; 96 points integrate products of the first 15 modes exactly."""
    x, w = np.polynomial.legendre.leggauss(points)
    return 0.5 * (x + 1.0), 0.5 * w


def gauss_pieces(pieces: int) -> tuple[Array, Array]:
    """Abscissas and weights of `gauss_unit` on each of ``pieces`` equal pieces of [0, 1] (none: on the whole)."""
    x, w = gauss_unit()
    n = max(pieces, 1)
    return ((np.arange(n)[:, None] + x) / n).ravel(), np.tile(w / n, n)


def clamped_free(count: int) -> list[BeamFunction]:
    """Eigenfunctions of the clamped-free beam (the paper's Eqs. 2-3 with the norm corrected), Eq. (T1.2)."""
    return clamped_tip_mass(count, 0.0, 0.0)


def check_finite(*matrices: Array) -> None:
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
    check_finite(K, M)
    root = np.linalg.cholesky(M)
    half = np.linalg.solve(root, K)
    A = np.linalg.solve(root, half.T)
    values, vectors = np.linalg.eigh(0.5 * (A + A.T))
    return values, np.asarray(np.linalg.solve(root.T, vectors), dtype=np.float64)
