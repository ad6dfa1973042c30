"""Each leg eliminated onto the payload, for many poses at once, Eqs. (T6.6)-(T6.9) and (T7.16)-(T7.17).

The readable twin of ``native/arrow.c`` with the pose as first axis. Legs whose stroke is prescribed and which can
stretch are pivoted by (alpha, beta, c_0), so that the stroke drops out; the others by (alpha, beta, l).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod.solve.many import RestMatrices
from flexapod.solve.system import Index, System
from flexapod.typing import Array

__all__ = ["LegBases", "Reduced", "expanded", "leg_bases", "null_space_of_borders", "reduced", "solve_each"]


@dataclass(frozen=True, kw_only=True)
class LegBases:
    """Admissible motions of legs that are eliminated in the same way, dq = N z + Y y, Eq. (T7.16).

    ``legs`` (g,): which; ``pivot`` (3,): coordinates found from the closure; ``rest`` (m,): those kept; ``border``:
    whether the stroke is prescribed but free here, so that each leg has a border row l = 0; ``inverse`` (P, g, 3, 3):
    of the pivots' columns of J; ``N`` (P, g, n, m); ``Y`` (P, g, n, 6).
    """

    legs: Index
    pivot: Index
    rest: Index
    border: bool
    inverse: Array
    N: Array
    Y: Array


def leg_bases(system: System, m: RestMatrices) -> list[LegBases]:
    """Bases of all legs at P poses, grouped by their pivots."""
    l_index, n, can_stretch = system.kernel.shapes.l_index, system.n, system.kernel.shapes.axial.count > 0
    found = []
    for held in (True, False):
        legs = np.flatnonzero(system.held[:, l_index] == held)
        if not legs.size:
            continue
        stroke_out = held and can_stretch
        pivot = np.array([l_index - 2, l_index - 1, l_index + 1 if stroke_out else l_index])
        rest = np.setdiff1d(np.arange(n), [*pivot, l_index])
        found.append(_bases(m, legs, pivot, rest, border=held and not can_stretch))
    return found


def _bases(m: RestMatrices, legs: Index, pivot: Index, rest: Index, *, border: bool) -> LegBases:
    J, P = m.J[:, legs], m.P[:, legs]
    inverse = solve_each(J[..., pivot], np.broadcast_to(np.eye(3), (*J.shape[:2], 3, 3)))
    N, Y = np.zeros((*J.shape[:2], J.shape[-1], rest.size)), np.zeros((*J.shape[:2], J.shape[-1], 6))
    N[..., pivot, :] = -inverse @ J[..., rest]
    N[..., rest, np.arange(rest.size)] = 1.0
    Y[..., pivot, :] = inverse @ P
    return LegBases(legs=legs, pivot=pivot, rest=rest, border=border, inverse=inverse, N=N, Y=Y)


@dataclass(frozen=True, kw_only=True)
class Reduced:
    """A matrix A of the whole robot on admissible motions (z of each leg, y of the payload), Eq. (T7.17).

    ``B``, ``C``: N^T A N (P, g, m, m) and N^T A Y (P, g, m, 6) of each group; ``S`` (P, 6, 6): of the payload with
    Y^T A Y of all legs.
    """

    B: list[Array]
    C: list[Array]
    S: Array

    def dense(self) -> Array:
        """The whole matrix, (P, r, r), symmetric part."""
        sizes = [b.shape[1] * b.shape[2] for b in self.B]
        size = sum(sizes) + 6
        full = np.zeros((len(self.S), size, size))
        full[:, -6:, -6:] = self.S
        at = 0
        for B, C in zip(self.B, self.C, strict=True):
            for i in range(B.shape[1]):
                rows = slice(at, at + B.shape[2])
                full[:, rows, rows], full[:, rows, -6:] = B[:, i], C[:, i]
                full[:, -6:, rows] = C[:, i].swapaxes(1, 2)
                at += B.shape[2]
        return 0.5 * (full + full.swapaxes(1, 2))


def reduced(bases: list[LegBases], legs: Array, payload: Array) -> Reduced:
    """Matrix on admissible motions from its blocks: legs (P, 6, n, n), symmetric, and payload (P, 6, 6)."""
    B, C, S = [], [], payload.copy()
    for b in bases:
        AN, AY = legs[:, b.legs] @ b.N, legs[:, b.legs] @ b.Y
        B.append(b.N.swapaxes(-1, -2) @ AN)
        C.append(b.N.swapaxes(-1, -2) @ AY)
        S = S + (b.Y.swapaxes(-1, -2) @ AY).sum(axis=1)
    return Reduced(B=B, C=C, S=S)


def expanded(bases: list[LegBases], vectors: Array) -> Array:
    """Flat coordinates (P, 6 n + 6, m) of admissible motions (P, r, m)."""
    P, _, count = vectors.shape
    n = bases[0].N.shape[2]
    legs, y, at = np.zeros((P, sum(b.legs.size for b in bases), n, count)), vectors[:, -6:], 0
    for b in bases:
        width = b.legs.size * b.rest.size
        z = vectors[:, at : at + width].reshape(P, b.legs.size, b.rest.size, count)
        legs[:, b.legs] = b.N @ z + b.Y @ y[:, None]
        at += width
    return np.concatenate([legs.reshape(P, legs.shape[1] * n, count), y], axis=1)


def null_space_of_borders(bases: list[LegBases], l_index: int) -> Array | None:
    """Basis (P, r, r - b) of the admissible motions that keep prescribed strokes; None where the pivots do already."""
    rows, P = [], len(bases[0].N)
    size = sum(b.legs.size * b.rest.size for b in bases) + 6
    at = 0
    for b in bases:
        for i in range(b.legs.size):
            if b.border:
                row = np.zeros((P, size))
                row[:, at : at + b.rest.size] = b.N[:, i, l_index]
                row[:, -6:] = b.Y[:, i, l_index]
                rows.append(row)
            at += b.rest.size
    if not rows:
        return None
    right = np.linalg.svd(np.stack(rows, axis=1), full_matrices=True)[2]
    return np.asarray(right[:, len(rows) :].swapaxes(1, 2), dtype=np.float64)


def solve_each(A: Array, b: Array) -> Array:
    """Solve A x = b for stacked matrices; NaN where a matrix is singular."""
    try:
        return np.asarray(np.linalg.solve(A, b), dtype=np.float64)
    except np.linalg.LinAlgError:
        if len(A) == 1:
            return np.full(b.shape, np.nan)
        half = len(A) // 2
        return np.concatenate([solve_each(A[:half], b[:half]), solve_each(A[half:], b[half:])])
