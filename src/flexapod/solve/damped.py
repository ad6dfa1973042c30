"""Damping ratios of damped modes, Eqs. (T7.4)-(T7.5), (T7.23)."""

import numpy as np
from numpy.typing import NDArray

from flexapod.bases.eigen import finite
from flexapod.typing import Array

__all__ = ["OSCILLATES", "damping_ratios", "poles"]

OSCILLATES = 1e-9  # imaginary part over size of an eigenvalue: less is a pair of real ones, split by rounding


def damping_ratios(omega: Array, D: Array) -> Array:
    """-Re/|.| of the damped eigenvalue that shares most of each undamped shape, Eqs. (T7.4)-(T7.5), (m,).

    D_jj omega_j / 2 for a mode of which no oscillating eigenvalue has at least half (overdamped or evenly mixed).

    Parameters
    ----------
    omega : ndarray, shape (m,)
        Undamped angular frequencies [rad/s], above 0; inf for what has no mass.
    D : ndarray, shape (m, m)
        Damping matrix in modal coordinates of unit stiffness [s].

    Raises
    ------
    ComputationError
        A number in it is not finite.
    """
    finite(D)
    size = len(omega)
    ratio = 0.5 * np.diag(D) * np.where(np.isfinite(omega), omega, 0.0)
    if not D.any():
        return ratio
    # (T7.23)  Eigenvalues 1/mu: the slow modes come out right however fast a light part is.
    slowness = np.diag(omega.min() / omega)
    values, shapes = np.linalg.eig(_slow(omega, D))
    oscillating = np.imag(values) < -OSCILLATES * np.abs(values)
    values, share = values[oscillating], slowness @ np.abs(shapes[:size, oscillating])
    share /= np.linalg.norm(share, axis=0)
    while share.size and share.max() > 0.5:  # the clearest pair first
        mode, column = np.unravel_index(share.argmax(), share.shape)
        ratio[mode] = -np.real(values[column]) / np.abs(values[column])
        share[mode, :] = share[:, column] = 0
    return ratio


def poles(omega: Array, D: Array) -> NDArray[np.complex128]:
    """Eigenvalues [1/s] of damped modes as of `damping_ratios`, without those of what has no mass nor damping."""
    finite(D)
    values = np.linalg.eigvals(_slow(omega, D))
    return omega.min() / values[np.abs(values) > np.finfo(float).eps]


def _slow(omega: Array, D: Array) -> Array:
    """Matrix with the eigenvalues omega_1/mu."""
    slowness = np.diag(omega.min() / omega)
    return np.block([[-omega.min() * D, -slowness], [slowness, np.zeros_like(slowness)]])
