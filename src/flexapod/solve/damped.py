"""Damping ratios of damped modes, Eqs. (T7.4)-(T7.5)."""

import numpy as np

from flexapod.typing import Array


def damping_ratios(omega: Array, D: Array) -> Array:
    """-Re/|.| of the damped eigenvalue that shares most of each undamped shape, Eqs. (T7.4)-(T7.5), (m,).

    D_jj / (2 omega_j) for a mode of which no oscillating eigenvalue has at least half (overdamped or evenly mixed).

    Parameters
    ----------
    omega : ndarray, shape (m,)
        Undamped angular frequencies [rad/s].
    D : ndarray, shape (m, m)
        Damping matrix in modal coordinates [1/s].
    """
    size, top = len(omega), omega.max()
    ratio = np.diag(D) / (2 * np.maximum(omega, 1e-12))
    if not D.any():
        return ratio
    from scipy.optimize import linear_sum_assignment  # a twentieth of a second that only damped modes need

    # Rates over the highest frequency keep the state matrix well scaled.
    state = np.block([[np.zeros((size, size)), np.eye(size)], [-np.diag((omega / top) ** 2), -D / top]])
    values, shapes = np.linalg.eig(state)
    oscillating = np.imag(values) > 1e-12
    values, share = values[oscillating], np.abs(shapes[:size, oscillating])
    mode, column = linear_sum_assignment(-share / np.linalg.norm(share, axis=0))
    clear = share[mode, column] > 0.5 * np.linalg.norm(share[:, column], axis=0)
    ratio[mode[clear]] = (-np.real(values) / np.abs(values))[column[clear]]
    return ratio
