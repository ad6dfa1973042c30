"""Integrators of a system, found by what is 0 in its matrices, taken apart from all else exactly, (T21.33)-(T21.34)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from flexapod.common.arrays import Array, Mask

__all__ = ["Integrated", "integrators", "moved_and_shown", "reached", "without_integrators"]

Complex = NDArray[np.complex128]


@dataclass(frozen=True, kw_only=True)
class Integrated:
    """A system as A (n, n), B (n, m), C (p, n) beside powers (k, p, m) of 1/s, 1/s^2, ..., Eq. (T21.34).

    ``most`` (k, p, m): what the powers could add up to without cancelling.
    """

    A: Array
    B: Array
    C: Array
    powers: Array
    most: Array

    def drifting(self, s: Complex) -> Complex:
        """What the integrators answer at points s (f,), (p, m, f)."""
        found = np.zeros((*self.powers.shape[1:], len(s)), dtype=complex)
        for k, power in enumerate(self.powers, start=1):
            found += power[:, :, None] * s**-k
        return found


def moved_and_shown(A: Array, B: Array, C: Array) -> tuple[Array, Array, Array]:
    """The states that some input moves and some output shows, by what is 0 in the matrices."""
    links = A != 0
    kept = np.flatnonzero(reached(links, (B != 0).any(axis=1)) & reached(links.T, (C != 0).any(axis=0)))
    return A[kept][:, kept], B[kept], C[:, kept]


def reached(links: Mask, start: Mask) -> Mask:
    """States that lie behind those of the start, which are among them."""
    while True:
        further = start | (links @ start)
        if (further == start).all():
            return start
        start = further


def integrators(A: Array) -> Mask:
    """States that nothing but others moves and that no circle of states holds."""
    _, circle = connected_components(A != 0, directed=True, connection="strong")
    return (np.bincount(circle, minlength=1)[circle] == 1) & (np.diag(A) == 0)


def without_integrators(A: Array, B: Array, C: Array) -> Integrated:
    """Integrators that only drive all else, and those that all else only drives, apart from it, Eq. (T21.33)."""
    links, drift = A != 0, integrators(A)
    others = ~drift
    drives, driven = reached(links.T, others) & drift, reached(links, others) & drift
    between = drives & driven
    main = np.flatnonzero(others | between)
    up, down = np.flatnonzero(drives & ~between), np.flatnonzero(drift & ~drives)
    N = np.concatenate([down, up])
    part = lambda rows, columns: A[rows][:, columns]  # noqa: E731
    if not len(N) or not len(main):
        return _as_powers(A, B, C, N, main, (np.abs(B), np.abs(C)))
    # (T21.33)  x_main + X x_up and x_down + Y x_main are apart
    X = scipy.linalg.solve_sylvester(part(main, main), -part(up, up), -part(main, up)) if len(up) else None
    Y = scipy.linalg.solve_sylvester(part(down, down), -part(main, main), -part(down, main)) if len(down) else None
    change, back = np.eye(len(A)), np.eye(len(A))
    if X is not None:
        change[main[:, None], up], back[main[:, None], up] = X, -X
    if Y is not None:
        second, undone = np.eye(len(A)), np.eye(len(A))
        second[down[:, None], main], undone[down[:, None], main] = Y, -Y
        change, back = change @ second, undone @ back
    if not (np.isfinite(change).all() and np.isfinite(back).all()):
        none = np.zeros((0, len(C), B.shape[1]))
        return Integrated(A=A, B=B, C=C, powers=none, most=none)
    most = np.abs(back) @ np.abs(B), np.abs(C) @ np.abs(change)
    return _as_powers(back @ A @ change, back @ B, C @ change, N, main, most)


def _as_powers(
    A: Array, B: Array, C: Array, N: NDArray[np.int_], main: NDArray[np.int_], sizes: tuple[Array, Array]
) -> Integrated:
    """Integrators as powers of 1/s: their matrix to some power is 0; ``sizes``: of B and C without cancelling."""
    inner, shape = A[N][:, N], (len(C), B.shape[1])
    powers, most = [], []
    power, size = B[N], sizes[0][N]
    while power.any():
        powers.append(C[:, N] @ power)
        most.append(sizes[1][:, N] @ size)
        power, size = inner @ power, np.abs(inner) @ size
    return Integrated(
        A=A[main][:, main], B=B[main], C=C[:, main], powers=np.array(powers).reshape(len(powers), *shape),
        most=np.array(most).reshape(len(powers), *shape),
    )  # fmt: skip
