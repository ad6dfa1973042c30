"""Each leg eliminated onto the payload, for many poses at once, Eqs. (T6.6)-(T6.9) and (T7.16)-(T7.17).

The readable twin of ``native/arrow.c`` with the pose as first axis. Every leg is pivoted by the coordinates that its
closure determines; a pivot that is held stays as a row of the border. Where independent motions are wanted, shapes of
the leg take the place of its held pivots (`closed`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexapod.arrays import Array, Mask
from flexapod.solve.batch import RestMatrices
from flexapod.solve.system import Index, System

__all__ = ["LegBases", "closed", "leg_bases", "open_borders", "solve_each"]

YIELDS = 0.01  # what a shape must move a held pivot by, for what the payload does, to take its place
SAME = 1e-9  # share below which what legs hold of the payload counts as the same


@dataclass(frozen=True, kw_only=True)
class LegBases:
    """Admissible motions of legs that hold the same coordinates, dq = N z + Y y, Eq. (T7.16).

    ``legs`` (g,): which; ``pivot`` (rows,): coordinates found from the closure; ``rest`` (m,): those kept in z;
    ``border`` (h,): pivots that are held but free here, so that each leg has h rows q_k = 0 more; ``inverse``
    (P, g, rows, rows): of the pivots' columns of J; ``N`` (P, g, n, m); ``Y`` (P, g, n, f) for the f coordinates of
    the payload that are not held and those that all legs share.
    """

    legs: Index
    pivot: Index
    rest: Index
    border: Index
    inverse: Array
    N: Array
    Y: Array


def leg_bases(system: System, m: RestMatrices) -> list[LegBases]:
    """Bases of all legs at P poses, grouped by what they hold."""
    return [_bases(system, m, *kind) for kind in system.kinds]


def _bases(system: System, m: RestMatrices, legs: Index, held: Mask, rest: Index) -> LegBases:
    pivot, n = np.array(system.kernel.shapes.pivots, dtype=np.intp), system.n
    J = m.J[:, legs]
    P = np.concatenate([m.P[:, legs][..., system.hub_free], -J[..., system.shared]], axis=-1)
    inverse = solve_each(J[..., pivot], np.broadcast_to(np.eye(pivot.size), (*J.shape[:2], pivot.size, pivot.size)))
    N, Y = np.zeros((*J.shape[:2], n, rest.size)), np.zeros((*J.shape[:2], n, P.shape[-1]))
    N[..., pivot, :] = -inverse @ J[..., rest]
    N[..., rest, np.arange(rest.size)] = 1.0
    Y[..., pivot, :] = inverse @ P
    Y[..., system.shared, P.shape[-1] - system.shared.size + np.arange(system.shared.size)] = 1.0
    return LegBases(legs=legs, pivot=pivot, rest=rest, border=pivot[held[pivot]], inverse=inverse, N=N, Y=Y)


def closed(bases: list[LegBases]) -> list[LegBases]:
    """Bases whose legs keep their held pivots, as far as legs can give way; the others have their borders still."""
    return [_closed(b) if b.border.size else b for b in bases]


def _closed(b: LegBases) -> LegBases:
    """Take one shape for each held pivot out of z: N_s z_s = - N_r z_r - Y y on the rows of the border."""
    D, Y = b.N[..., b.border, :], b.Y[..., b.border, :]
    chosen, share = _substitutes(D, Y)
    if chosen is None or not share > YIELDS:
        return b
    out = np.zeros((*D.shape[:2], b.rest.size), dtype=bool)
    np.put_along_axis(out, chosen, True, axis=-1)
    kept = np.argsort(out, axis=-1, kind="stable")[..., : b.rest.size - b.border.size]
    shapes, others = (np.take_along_axis(b.N, k[..., None, :], axis=-1) for k in (chosen, kept))
    given = np.concatenate([others, b.Y], axis=-1)
    moved = given - shapes @ solve_each(shapes[..., b.border, :], given[..., b.border, :])
    moved[..., b.border, :] = 0.0
    width = kept.shape[-1]
    return replace(b, border=b.border[:0], rest=b.rest[:width], N=moved[..., :width], Y=moved[..., width:])


def _substitutes(D: Array, Y: Array) -> tuple[Index | None, float]:
    """Shape for each row of D (P, g, h, m), (P, g, h), and the least pivot over what the payload moves by the row."""
    if D.shape[-1] < D.shape[-2]:
        return None, 0.0
    left, size = D.copy(), np.maximum(np.abs(D).max(axis=-1), np.abs(Y).max(axis=-1, initial=0.0))
    chosen, share = np.zeros(D.shape[:-1], dtype=np.intp), np.inf
    for k in range(D.shape[-2]):
        column = np.abs(left[..., k, :]).argmax(axis=-1)[..., None]
        chosen[..., k : k + 1] = column
        pivot = np.take_along_axis(left[..., k, :], column, axis=-1)
        share = min(share, float((np.abs(pivot[..., 0]) / size[..., k]).min(initial=np.inf)))
        if not share > YIELDS:
            return None, 0.0
        below = np.take_along_axis(left[..., k + 1 :, :], column[..., None, :], axis=-1)
        left[..., k + 1 :, :] -= below / pivot[..., None] * left[..., k : k + 1, :]
    return chosen, share


def open_borders(bases: list[LegBases]) -> bool:
    """Whether legs hold the payload against each other in ways in which none of them gives way, at the first pose."""
    rows = []
    for b in bases:
        if not len(b.N) or not b.border.size:
            continue
        D, Y = b.N[0][..., b.border, :], b.Y[0][..., b.border, :]
        size = np.maximum(np.abs(D).max(axis=-1, initial=0.0), np.abs(Y).max(axis=-1, initial=0.0))[..., None]
        if not np.isfinite(size).all():
            continue
        size = np.where(size > 0, size, 1.0)  # a pivot that nothing moves: the strut of a fixed platform
        left, share, _ = np.linalg.svd(D / size)
        rank = (share > YIELDS).sum(axis=-1)
        rows += [u[:, k:].T @ (y / s) for u, k, y, s in zip(left, rank, Y, size, strict=True)]
    rigid = np.concatenate(rows) if rows else np.zeros((0, 0))
    return len(rigid) > np.linalg.matrix_rank(rigid, tol=SAME) if rigid.size else len(rigid) > 0


def solve_each(A: Array, b: Array) -> Array:
    """Solve A x = b for stacked matrices; NaN where a matrix is singular."""
    try:
        return np.asarray(np.linalg.solve(A, b), dtype=np.float64)
    except np.linalg.LinAlgError:
        if len(A) == 1:
            return np.full(b.shape, np.nan)
        half = len(A) // 2
        return np.concatenate([solve_each(A[:half], b[:half]), solve_each(A[half:], b[half:])])
