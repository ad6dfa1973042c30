"""Reduction of M, D, K to x' = A x + B u; massless motions are condensed with dampers, Eqs. (T20.11)-(T20.16)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve, qr, solve_triangular

from flexapod.common.arrays import Array, Index
from flexapod.common.errors import ComputationError
from flexapod.solve.modal.eigenproblem import LIGHTEST

PLAIN = 1e-4  # smallest pivot of a mass matrix of unit diagonal at which nothing in it is without mass
LEFT = 1e-9  # of a damper, over the largest, that acts on what has neither mass nor damper: less is rounding


@dataclass(frozen=True, kw_only=True)
class FirstOrder:
    """States X = (x, y, v): motions with mass, motions with dampers alone, rates of the first.

    ``A`` (n, n), ``B`` (n, m); ``place``, ``rate``, ``acceleration`` (d, n + m): of all d motions by states and inputs,
    the last one where there is mass; ``second``, ``first``: which motions the x and y are.
    """

    A: Array
    B: Array
    place: Array
    rate: Array
    acceleration: Array
    second: Index
    first: Index


def with_mass(U: Array) -> tuple[Index, Index, Array]:
    """Motions with a mass of their own, the others, and what these take along of the first, Eq. (T20.11).

    ``U`` (rows, d): factor of the mass matrix, M = U^T U.
    """
    d = U.shape[1]
    size = np.linalg.norm(U, axis=0)
    moving = np.flatnonzero(size > np.finfo(float).eps * len(U) * size.max(initial=0.0))
    V = U[:, moving] / size[moving]
    try:
        plain = not moving.size or np.linalg.cholesky(V.T @ V).diagonal().min() > PLAIN
    except np.linalg.LinAlgError:
        plain = False
    if plain:
        rest = np.setdiff1d(np.arange(d), moving)
        return moving, rest, np.zeros((moving.size, rest.size))
    R, order = (np.asarray(x) for x in qr(V, mode="r", pivoting=True))
    rank = int((np.abs(R.diagonal()) > LIGHTEST).sum())
    second, loose = moving[order[:rank]], moving[order[rank:]]
    taken = solve_triangular(R[:rank, :rank], R[:rank, rank:]) * size[loose] / size[second][:, None]
    by = np.argsort(second)
    rest = np.setdiff1d(np.arange(d), second)
    T = np.zeros((second.size, rest.size))
    T[:, np.searchsorted(rest, loose)] = taken[by]
    return second[by], rest, T


def first_order(
    M: Array, D: Array, K: Array, F: Array, *, mass: tuple[Index, Index, Array], loops: Index
) -> FirstOrder:
    """M z'' + D z' + K z = F u as states.

    ``mass``: as of `with_mass`; ``loops``: motions that are states of loops, a damper each, among those without.
    """
    d, m = F.shape
    second, rest, T = mass
    W = np.eye(d)
    W[np.ix_(second, rest)] = -T
    D, K, F = W.T @ D @ W, W.T @ K @ W, W.T @ F
    bodies = np.setdiff1d(rest, loops)
    damped, still, T = _with_damper(D, K, bodies)
    V = np.eye(d)
    V[np.ix_(damped, still)] = -T
    D, K, F, W = V.T @ D @ V, V.T @ K @ V, V.T @ F, W @ V
    first = np.concatenate([damped, loops]).astype(np.intp)
    kept = np.concatenate([second, first])
    _refuse_late(D, K, still)
    S = -_solved(K[np.ix_(still, still)], np.concatenate([K[np.ix_(still, kept)], -F[still]], axis=1))
    S, Su = S[:, : kept.size], S[:, kept.size :]
    D_, K_ = (x[np.ix_(kept, kept)] + x[np.ix_(kept, still)] @ S for x in (D, K))  # (T20.13)
    F_ = F[kept] - K[np.ix_(kept, still)] @ Su
    if np.abs(D[np.ix_(kept, still)] @ Su).max(initial=0.0) > LEFT * np.abs(F_).max(initial=1.0):
        raise ComputationError(
            "an input acts on what has neither mass nor damper, beside a damper: its response has no state space",
            next_step="Give what it acts on a mass, or leave the damper out.",
        )
    p, nd = second.size, first.size
    x, y = slice(0, p), slice(p, p + nd)
    n = 2 * p + nd
    of = np.zeros((nd, n + m))  # (T20.14)  y' by states and inputs
    of[:, : p + nd], of[:, p + nd : n], of[:, n:] = -K_[y], -D_[y, x], F_[y]
    of = _solved(D_[y, y], of)
    push = np.zeros((p, n + m))  # (T20.15)
    push[:, : p + nd], push[:, p + nd : n], push[:, n:] = -K_[x], -D_[x, x], F_[x]
    push -= D_[x, y] @ of
    a = cho_solve(cho_factor(M[np.ix_(second, second)]), push) if p else push
    v = np.zeros((p, n + m))
    v[:, p + nd : n] = np.eye(p)
    whole = np.concatenate([v, of, a])
    at = np.zeros((p + nd, n + m))
    at[:, : p + nd] = np.eye(p + nd)
    place, rate, acceleration = np.zeros((3, d, n + m))
    place[kept], rate[kept] = at, whole[: p + nd]
    place[still], rate[still] = S @ at, S @ whole[: p + nd]
    place[still, n:] += Su
    acceleration[second] = a
    return FirstOrder(
        A=whole[:, :n], B=whole[:, n:], place=W @ place, rate=W @ rate, acceleration=W @ acceleration,
        second=second, first=first,
    )  # fmt: skip


def _with_damper(D: Array, K: Array, at: Index) -> tuple[Index, Index, Array]:
    """Split motions without mass: those with dampers, the others, and what these carry along, Eq. (T20.12)."""
    unit = 1 / np.sqrt(np.where(np.diag(K) > 0, np.diag(K), 1.0))
    least = np.finfo(float).eps * len(D) * np.linalg.norm(unit[:, None] * D * unit)
    left = (unit[:, None] * D * unit)[np.ix_(at, at)]
    left, chosen, rows = 0.5 * (left + left.T), [], []
    while at.size and left.diagonal().max() > least:
        k = int(left.diagonal().argmax())
        row = left[k] / np.sqrt(left[k, k])
        chosen.append(k)
        rows.append(row)
        left = left - np.outer(row, row)
        left[k], left[:, k] = 0.0, 0.0
    others = np.setdiff1d(np.arange(at.size), chosen)
    if not chosen:
        return at[:0], at, np.zeros((0, at.size))
    R = np.array(rows)
    T = np.linalg.solve(R[:, chosen], R[:, others]) / unit[at[chosen]][:, None] ** -1 / unit[at[others]]
    by = np.argsort(chosen)
    return at[np.array(chosen)[by]], at[others], T[by]


def _refuse_late(D: Array, K: Array, still: Index) -> None:
    unit = 1 / np.sqrt(np.where(np.diag(K) > 0, np.diag(K), 1.0))
    size = np.abs(unit[:, None] * D * unit)
    if size[still].max(initial=0.0) > LEFT * size.max(initial=0.0):
        raise ComputationError(
            "what has neither mass nor damper is pushed by a rate: a loop acts at once on a rotor without inertia",
            next_step="Give the rotor an inertia, or its motor a bandwidth.",
        )


def _solved(A: Array, b: Array) -> Array:
    return np.asarray(np.linalg.solve(A, b), dtype=np.float64) if len(A) else b
