"""Time steps of M a'' + K(t) a = f(t) by Gauss collocation with two stages, order 4, undamped, Eq. (T10.19)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flexapod.typing import Array

__all__ = ["gauss_step"]

_ROOT = np.sqrt(3.0) / 6
NODES = np.array([0.5 - _ROOT, 0.5 + _ROOT])
WEIGHTS = np.array([[0.25, 0.25 - _ROOT], [0.25 + _ROOT, 0.25]])
SQUARED = WEIGHTS @ WEIGHTS


def gauss_step(
    mass: Array, stage: Callable[[float], tuple[Array, Array]], t: float, h: float, a: Array, a_dot: Array
) -> tuple[Array, Array]:
    """State after one step.

    Parameters
    ----------
    mass : (n, n) array
        Constant over the step.
    stage : callable
        Stiffness (n, n) and load (n,) at an instant [s].
    t, h : float
        Start and length of the step [s].
    a, a_dot : (n,) arrays

    Returns
    -------
    tuple of (n,) arrays
        a and a_dot at t + h.
    """
    n = len(a)
    big, right = np.empty((2 * n, 2 * n)), np.empty(2 * n)
    for i in range(2):
        K, f = stage(t + NODES[i] * h)
        rows = slice(i * n, (i + 1) * n)
        for j in range(2):
            big[rows, j * n : (j + 1) * n] = h**2 * SQUARED[i, j] * K
        big[rows, rows] += mass
        right[rows] = f - K @ (a + NODES[i] * h * a_dot)
    first, second = np.linalg.solve(big, right).reshape(2, n)
    # Position weights b A = (b_j (1 - c_j)) of the two stages.
    place = 0.5 * (1 - NODES)
    return a + h * a_dot + h**2 * (place[0] * first + place[1] * second), a_dot + 0.5 * h * (first + second)
