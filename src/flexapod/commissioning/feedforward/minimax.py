"""Coefficients that use least of limits, and the least time in which that is within them, Eqs. (T22.17)-(T22.19)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flexapod.common.arrays import Array, Mask
from flexapod.common.errors import ComputationError

SIDES = 16  # of the polygon in which the amplitude of a mode stays
NEAR, EACH = 0.9, 4  # share of the largest from which rows are in the program at once; every which look is in any case
MISSED = 1e-7  # of the largest, by which rows outside of the program may exceed it: as HiGHS does those inside
AGAIN = 20  # programs, at most
FAINT = 0.05  # share of the bound that modes outside of the program could leave together
WITHIN = 1.002  # of a limit
MORE = 1.5  # how much longer a way is taken at once, at most


def minimax(
    G: Array, g: Array, ends: tuple[Array, Array], c: Array, quiet: tuple[Array, Array] | None = None
) -> tuple[Array, float]:
    """Coefficients (n,) of least maximum of |G c + g|, and that maximum, from near ones, Eqs. (T22.17), (T22.19).

    Rows that are far from the largest enter the program when they exceed its result.

    Parameters
    ----------
    G, g : ndarray, shapes (k, T, n), (k, T)
        Of k limits at T looks.
    ends : tuple of ndarray, shapes (e, n), (e,)
        What coefficients have to meet.
    c : ndarray, shape (n,)
        Near ones.
    quiet : tuple of ndarray, shapes (m, n), (m,), optional
        Amplitudes A c + a, complex, of which the sizes add up to 1 at most.

    Raises
    ------
    ComputationError
        There are none.
    """
    from scipy.optimize import linprog

    n, (A, a) = len(c), _heard(quiet, c)
    m = len(a)
    turn = np.exp(2j * np.pi * np.arange(SIDES) / SIDES) / np.cos(np.pi / SIDES)
    sides = np.real(turn[:, None, None] * A).reshape(-1, n)
    loud = [
        np.column_stack([sides, np.tile(-np.eye(m), (SIDES, 1)), np.zeros(SIDES * m)]),
        np.concatenate([np.zeros(n), np.ones(m), [0.0]])[None],
    ]
    rest = np.append(-np.real(turn[:, None] * a).ravel(), 1.0)
    rows, x = _first_rows(G @ c + g), np.append(c, np.inf)
    for _ in range(AGAIN):
        sign, k, look = np.nonzero(rows)
        way = np.where(sign == 0, 1.0, -1.0)
        above = np.column_stack([way[:, None] * G[k, look], np.zeros((len(k), m)), -np.ones(len(k))])
        found = linprog(
            np.append(np.zeros(n + m), 1.0), A_ub=np.concatenate([above, *loud]),
            b_ub=np.append(-way * g[k, look], rest), A_eq=np.pad(ends[0], ((0, 0), (0, m + 1))), b_eq=ends[1],
            bounds=[(None, None)] * n + [(0, None)] * (m + 1), method="highs-ds",
        )  # fmt: skip
        if found.status != 0:
            raise ComputationError(f"the way was not found: {found.message}")
        x = found.x
        value = G @ x[:n] + g
        missed = (np.stack([value, -value]) > x[-1] * (1 + MISSED)) & ~rows
        if not missed.any():
            break
        rows |= missed
    return x[:n], float(x[-1])


def _first_rows(value: Array) -> Mask:
    """Rows (2, k, T), of both signs, that are near the largest, and the largest at some looks."""
    size = np.abs(value)
    rows: Mask = np.stack([value, -value]) >= NEAR * size.max()
    looks = np.arange(0, value.shape[1], EACH)
    rows[:, size[:, looks].argmax(axis=0), looks] = True
    return rows


def _heard(quiet: tuple[Array, Array] | None, c: Array) -> tuple[Array, Array]:
    """Amplitudes without those that are faint whatever the coefficients, which are not much larger than these."""
    if quiet is None:
        return np.zeros((0, len(c)), dtype=complex), np.zeros(0, dtype=complex)
    most = np.abs(quiet[0]) @ np.abs(c) + np.abs(quiet[1])
    order = np.argsort(most)
    heard = np.sort(order[np.cumsum(most[order]) > FAINT])
    return quiet[0][heard], quiet[1][heard]


Evaluate = Callable[[float, Array], tuple[Array, float]]


def least_time_by_secants(
    evaluate: Evaluate, T: float, c: Array, *, low: float, fine: float, most: float
) -> tuple[float, Array, float] | None:
    """The least time, within a share `fine`, its way and its use of limits; None where it is above `most`.

    Parameters
    ----------
    evaluate : callable
        A way for a time, from one for a time near it, and the share of limits that it uses.
    T, c : float, ndarray
        To start from.
    low : float
        No time is shorter.
    """
    best, before = None, None
    while best is None or (best[0] - low > fine * best[0] and best[2] < 1 - fine):
        if T > most:
            return None
        c, used = evaluate(T, c)
        bend = -2.0
        if before is not None and used != before[1]:
            bend = min(-0.5, float(np.log(used / before[1]) / np.log(T / before[0])))
        before = (T, used)
        best, low = ((T, c, used), low) if used <= WITHIN else (best, T)
        T *= min(MORE, max(1 / MORE, (used / (1 - 0.5 * fine)) ** (-1 / bend)))
        if best is not None and not low < T < best[0]:
            T = 0.5 * (low + best[0])
    return best
