"""Linear ties between displacements, solved for the ones that follow: what `Deck.equations` writes."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import null_space, qr

from flexapod.exchange.decks import Term
from flexapod.typing import Array

__all__ = ["Tie", "cross_matrix", "solved"]

_NOTHING = 1e-12  # a factor below this is rounding: factors are ratios of lengths


@dataclass(frozen=True, kw_only=True)
class Tie:
    """Displacements that share a few unknown motions q: ``rows @ u[terms] = motion @ q``.

    `terms`: (n,) displacements; `rows` (m, n) and `motion` (m, k) of like size in every row.
    """

    terms: tuple[Term, ...]
    rows: Array
    motion: Array


def cross_matrix(r: Array) -> Array:
    """The matrix of ``theta -> theta x r``, shape (3, 3)."""
    x, y, z = r
    return np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])


def solved(ties: Sequence[Tie], keep: Collection[Term] = ()) -> dict[Term, dict[Term, float]]:
    """The ties without their q, solved for as many displacements as they determine.

    Parameters
    ----------
    ties : sequence of Tie
        Independent of each other; each with an unknown motion of its own.
    keep : collection of Term
        Displacements that must not be solved for.

    Returns
    -------
    dict
        ``{a: {b: factor}}`` for u_a = sum factor u_b; no a is a b.
    """
    terms = sorted({term for tie in ties for term in tie.terms})
    place = {term: i for i, term in enumerate(terms)}
    blocks = []
    for tie in ties:
        rows = np.zeros((len(tie.rows), len(terms)))
        rows[:, [place[term] for term in tie.terms]] = tie.rows
        blocks.append(null_space(tie.motion.T).T @ rows if tie.motion.shape[1] else rows)
    C = np.vstack(blocks)
    loose = np.array([i for i, term in enumerate(terms) if term not in set(keep)])
    order = qr(C[:, loose], mode="r", pivoting=True)[-1]
    chosen = np.sort(loose[order[: len(C)]])
    others = np.setdiff1d(np.arange(len(terms)), chosen)
    factors = -np.linalg.solve(C[:, chosen], C[:, others])
    return {
        terms[a]: {terms[others[j]]: float(row[j]) for j in np.flatnonzero(np.abs(row) > _NOTHING)}
        for a, row in zip(chosen, factors, strict=True)
    }
