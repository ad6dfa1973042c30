"""Each leg eliminated onto the payload, for many poses at once, Eqs. (T6.6)-(T6.9) and (T7.16)-(T7.17).

The readable twin of ``native/arrow.c`` with the pose as first axis. Every leg is pivoted by the coordinates that its
closure determines; a pivot that is held stays as a row of the border. Where independent motions are wanted, shapes of
the leg take the place of its held pivots (`closed`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexapod.solve.many import RestMatrices
from flexapod.solve.system import Index, System
from flexapod.typing import Array, Mask

__all__ = [
    "LegBases",
    "Reduced",
    "closed",
    "expanded",
    "leg_bases",
    "null_space_of_borders",
    "open_borders",
    "reduced",
    "reduced_legs",
    "solve_each",
]

YIELDS = 0.01  # what a shape must move a held pivot by, for what the payload does, to take its place
SAME = 1e-9  # share below which what legs hold of the payload counts as the same


@dataclass(frozen=True, kw_only=True)
class LegBases:
    """Admissible motions of legs that hold the same coordinates, dq = N z + Y y, Eq. (T7.16).

    ``legs`` (g,): which; ``pivot`` (rows,): coordinates found from the closure; ``rest`` (m,): those kept in z;
    ``border`` (h,): pivots that are held but free here, so that each leg has h rows q_k = 0 more; ``inverse``
    (P, g, rows, rows): of the pivots' columns of J; ``N`` (P, g, n, m); ``Y`` (P, g, n, f) for the f coordinates of
    the payload that are not held.
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
    kinds, of = np.unique(system.held, axis=0, return_inverse=True)
    return [_bases(system, m, np.flatnonzero(of.ravel() == k), held) for k, held in enumerate(kinds)]


def _bases(system: System, m: RestMatrices, legs: Index, held: Mask) -> LegBases:
    pivot, n = np.array(system.kernel.shapes.pivots, dtype=np.intp), system.n
    rest = np.setdiff1d(np.flatnonzero(~held), pivot)
    J, P = m.J[:, legs], m.P[:, legs][..., system.hub_free]
    inverse = solve_each(J[..., pivot], np.broadcast_to(np.eye(pivot.size), (*J.shape[:2], pivot.size, pivot.size)))
    N, Y = np.zeros((*J.shape[:2], n, rest.size)), np.zeros((*J.shape[:2], n, P.shape[-1]))
    N[..., pivot, :] = -inverse @ J[..., rest]
    N[..., rest, np.arange(rest.size)] = 1.0
    Y[..., pivot, :] = inverse @ P
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
        left, share, _ = np.linalg.svd(D / size)
        rank = (share > YIELDS).sum(axis=-1)
        rows += [u[:, k:].T @ (y / s) for u, k, y, s in zip(left, rank, Y, size, strict=True)]
    rigid = np.concatenate(rows) if rows else np.zeros((0, 0))
    return len(rigid) > np.linalg.matrix_rank(rigid, tol=SAME) if rigid.size else len(rigid) > 0


@dataclass(frozen=True, kw_only=True)
class Reduced:
    """The stiffness K of the whole robot on admissible motions (z of each leg, y of the payload), Eq. (T7.17).

    ``B``, ``C``: N^T K N (P, g, m, m) and N^T (K Y + X) (P, g, m, f) of each group; ``S`` (P, f, f): of the payload
    with those of all legs; ``legs`` (P, legs, f, f): shares in S.
    """

    B: list[Array]
    C: list[Array]
    S: Array

    def dense(self) -> Array:
        """The whole matrix, (P, r, r), symmetric part."""
        sizes, f = [b.shape[1] * b.shape[2] for b in self.B], self.S.shape[-1]
        at, hub = 0, slice(sum(sizes), sum(sizes) + f)
        full = np.zeros((len(self.S), hub.stop, hub.stop))
        full[:, hub, hub] = self.S
        for B, C in zip(self.B, self.C, strict=True):
            for i in range(B.shape[1]):
                rows = slice(at, at + B.shape[2])
                full[:, rows, rows], full[:, rows, hub] = B[:, i], C[:, i]
                full[:, hub, rows] = C[:, i].swapaxes(1, 2)
                at += B.shape[2]
        return 0.5 * (full + full.swapaxes(1, 2))


def reduced(system: System, bases: list[LegBases], m: RestMatrices) -> Reduced:
    """Stiffness on admissible motions; ``bases`` from `leg_bases` or `closed`."""
    free = system.hub_free
    B, C, S = [], [], m.payload_K[:, free[:, None], free]
    for b in bases:
        b_part, c_part, s_part = reduced_legs(system, b, m)
        B.append(b_part)
        C.append(c_part)
        S = S + s_part.sum(axis=1)
    return Reduced(B=B, C=C, S=S)


def reduced_legs(system: System, b: LegBases, m: RestMatrices) -> tuple[Array, Array, Array]:
    """N^T K N (P, g, m, m), N^T (K Y + X) (P, g, m, f) and Y^T K Y + Y^T X + X^T Y (P, g, f, f), Eq. (T7.17)."""
    K, Nt, Yt = m.K[:, b.legs], b.N.swapaxes(-1, -2), b.Y.swapaxes(-1, -2)
    KY = K @ b.Y
    if m.X is None:
        return Nt @ (K @ b.N), Nt @ KY, Yt @ KY
    X = m.X[:, b.legs][..., system.hub_free]
    return Nt @ (K @ b.N), Nt @ (KY + X), Yt @ (KY + X) + X.swapaxes(-1, -2) @ b.Y


def expanded(system: System, bases: list[LegBases], vectors: Array) -> Array:
    """Flat coordinates (P, size, m) of admissible motions (P, r, m)."""
    P, _, count = vectors.shape
    flat = np.zeros((P, system.size, count))
    legs = flat[:, : system.legs * system.n].reshape(P, system.legs, system.n, count)
    y, at = vectors[:, vectors.shape[1] - system.hub_free.size :], 0
    flat[:, system.legs * system.n + system.hub_free] = y
    for b in bases:
        width = b.legs.size * b.rest.size
        z = vectors[:, at : at + width].reshape(P, b.legs.size, b.rest.size, count)
        legs[:, b.legs] = b.N @ z + b.Y @ y[:, None]
        at += width
    return flat


def null_space_of_borders(bases: list[LegBases]) -> Array | None:
    """Basis (P, r, r - b) of the admissible motions that keep held pivots; None where the bases do already."""
    width, f = sum(b.legs.size * b.rest.size for b in bases), bases[0].Y.shape[-1]
    rows, at = [], 0
    for b in bases:
        for i in range(b.legs.size):
            for k in b.border:
                row = np.zeros((len(b.N), width + f))
                row[:, at : at + b.rest.size] = b.N[:, i, k]
                row[:, width:] = b.Y[:, i, k]
                rows.append(row)
            at += b.rest.size
    if not rows:
        return None
    G = np.stack(rows, axis=1)
    G = G / np.linalg.norm(G, axis=-1, keepdims=True)
    _, size, right = np.linalg.svd(G, full_matrices=True)
    rank = int((size > 1e-9).sum(axis=-1).max(initial=0))
    return np.asarray(right[:, rank:].swapaxes(1, 2), dtype=np.float64)


def solve_each(A: Array, b: Array) -> Array:
    """Solve A x = b for stacked matrices; NaN where a matrix is singular."""
    try:
        return np.asarray(np.linalg.solve(A, b), dtype=np.float64)
    except np.linalg.LinAlgError:
        if len(A) == 1:
            return np.full(b.shape, np.nan)
        half = len(A) // 2
        return np.concatenate([solve_each(A[:half], b[:half]), solve_each(A[half:], b[half:])])
