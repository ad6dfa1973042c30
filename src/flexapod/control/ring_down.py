"""Poles of what a record of a ring-down is made of: damping that was achieved, beside that of a closed loop."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexapod.common.arguments import whole
from flexapod.common.arrays import floats
from flexapod.common.errors import InputError
from flexapod.control.discretization import period_of

__all__ = ["ring_down"]

LONGEST = 200  # samples in a window: enough for the slowest of some ten vibrations


def ring_down(samples: ArrayLike, period: float | str, order: int = 10) -> NDArray[np.complex128]:
    """Poles of a free vibration by its samples, Eq. (T26.9), the slowest first, (any,) [1/s].

    Parameters
    ----------
    samples : array_like, shape (T,) or (T, m)
        Equally spaced, while nothing but the controller acts; a constant does not count.
    period : float or str
        Time between them [s], or their rate.
    order : int
        Number of poles: two of each vibration that shows. More than there are take up noise.

    Returns
    -------
    ndarray
        Those that a pair of conjugates has above the real axis, and real ones.

    Raises
    ------
    InputError
        Too few samples.
    """
    T = period_of(period)
    try:
        x = np.atleast_1d(floats(samples))
    except ValueError:
        x = np.full(1, np.nan)
    if not x.size or not np.isfinite(x).all():
        raise InputError("are no finite numbers", key="samples", allowed="(T,) or (T, m), equally spaced")
    order = whole(order, "order", 1, 2 * LONGEST)
    x = np.diff(x.reshape(len(x), -1), axis=0)
    length = min(len(x) // 2, LONGEST)
    if length * x.shape[1] <= order:
        raise InputError("are too few", key="samples", value=len(x) + 1, allowed=f"more than {2 * order + 2}")
    windows = np.stack([x[k : len(x) - length + k + 1] for k in range(length)], axis=0)  # (length, any, m)
    hankel = windows.transpose(0, 2, 1).reshape(length * x.shape[1], -1)
    U = np.linalg.svd(hankel, full_matrices=False)[0][:, :order]
    step = np.linalg.lstsq(U[: -x.shape[1]], U[x.shape[1] :], rcond=None)[0]
    z = np.linalg.eigvals(step).astype(np.complex128)
    poles = np.asarray(np.log(z[np.abs(z) > np.finfo(float).tiny]) / T, dtype=np.complex128)
    poles = poles[np.imag(poles) >= 0]
    return poles[np.argsort(np.abs(poles), kind="stable")]
