"""Stiffness and motions of a whole robot on the independent motions of its legs, Eq. (T7.17)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexapod.common.arrays import Array, Index
from flexapod.solve.batch import RestMatrices
from flexapod.solve.saddle_point import solve_each
from flexapod.solve.statics.elimination import LegBases, border_columns, keep_held_pivots, leg_bases
from flexapod.solve.system import System

DEPENDENT = 1e-6  # by how much a row that others imply at home may miss what they imply elsewhere: elastic turns


@dataclass(frozen=True, kw_only=True)
class Motions:
    """Independent motions of a robot at P poses, the same ones at all of them.

    ``bases``: of the legs; ``N`` (P, r, d): the d motions by the r of `ReducedStiffness`, None where they are these;
    ``columns`` (d,): which coordinate each of them is, as `flat_columns` counts; ``most`` (P,): by how much
    what stands for a held pivot moves while one of them moves by one, at most; infinite where other rows are held
    than at home.
    """

    bases: list[LegBases]
    columns: Index
    N: Array | None
    most: Array

    def __getitem__(self, chosen: Index) -> Motions:
        """Select some of the poses."""
        N = None if self.N is None else self.N[chosen]
        return replace(self, bases=[b[chosen] for b in self.bases], N=N, most=self.most[chosen])

    def stiffness(self, system: System, m: RestMatrices) -> Array:
        """The whole stiffness on them, (P, d, d), Eq. (T7.17)."""
        K = reduce_stiffness(system, self.bases, m).dense()
        return K if self.N is None else self.N.swapaxes(1, 2) @ K @ self.N

    def flat(self, system: System, vectors: Array) -> Array:
        """Flat coordinates (P, size, any) of motions (P, d, any)."""
        return expand_motions(system, self.bases, vectors if self.N is None else self.N @ vectors)


@dataclass(frozen=True, kw_only=True)
class ReducedStiffness:
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


def reduce_stiffness(system: System, bases: list[LegBases], m: RestMatrices) -> ReducedStiffness:
    """Stiffness on admissible motions; ``bases`` from `leg_bases` or `keep_held_pivots`."""
    free = system.border
    B, C, S = [], [], m.payload_K[:, free[:, None], free]
    for b in bases:
        b_part, c_part, s_part = reduced_legs(system, b, m)
        B.append(b_part)
        C.append(c_part)
        S = S + s_part.sum(axis=1)
    return ReducedStiffness(B=B, C=C, S=S)


def reduced_legs(system: System, b: LegBases, m: RestMatrices) -> tuple[Array, Array, Array]:
    """N^T K N (P, g, m, m), N^T (K Y + X) (P, g, m, f) and Y^T K Y + Y^T X + X^T Y (P, g, f, f), Eq. (T7.17)."""
    K, Nt, Yt = m.K[:, b.legs], b.N.swapaxes(-1, -2), b.Y.swapaxes(-1, -2)
    KY = K @ b.Y
    if m.X is None:
        return Nt @ (K @ b.N), Nt @ KY, Yt @ KY
    X = border_columns(system, m.X[:, b.legs])
    return Nt @ (K @ b.N), Nt @ (KY + X), Yt @ (KY + X) + X.swapaxes(-1, -2) @ b.Y


def hub_motion(system: System, flat: Array) -> Array:
    """Rows of the payload's steps and of shared coordinates (..., 6 + shared, m) of flat coordinates (..., size, m)."""
    return np.concatenate([flat[..., system.legs * system.n :, :], flat[..., system.shared_coordinates, :]], axis=-2)


def expand_motions(system: System, bases: list[LegBases], vectors: Array) -> Array:
    """Flat coordinates (P, size, m) of admissible motions (P, r, m)."""
    P, _, count = vectors.shape
    flat = np.zeros((P, system.size, count))
    legs = flat[:, : system.legs * system.n].reshape(P, system.legs, system.n, count)
    y, at = vectors[:, vectors.shape[1] - system.border.size :], 0
    flat[:, system.legs * system.n + system.hub_free] = y[:, : system.hub_free.size]
    for b in bases:
        width = b.rest.size
        z = vectors[:, at : at + width].reshape(P, *b.rest.shape, count)
        legs[:, b.legs] = b.N @ z + b.Y @ y[:, None]
        at += width
    return flat


def independent_motions(system: System, m: RestMatrices) -> Motions:
    """Independent motions of a whole robot with `substitutes`, Eqs. (T7.16), (T7.28)."""
    bases = keep_held_pivots(system, leg_bases(system, m))
    most = np.max([b.most for b in bases], axis=0)
    G, of = border_rows(bases), system.substitutes
    by = np.concatenate([of[b.legs[:, None], b.border].ravel() for b in bases])
    kept, columns = by >= 0, flat_columns(system, bases)  # a row that follows from the others is not kept
    if not kept.any():
        return Motions(bases=bases, columns=columns, N=None, most=_not_implied(G, most))
    place = (columns == by[kept][:, None]).argmax(axis=1)
    free = np.setdiff1d(np.arange(columns.size), place)
    moves = -solve_each(G[:, kept][..., place], G[:, kept][..., free])
    N = np.zeros((len(G), columns.size, free.size))
    N[:, free, np.arange(free.size)], N[:, place] = 1.0, moves
    most = np.maximum(most, np.abs(moves).max(axis=(1, 2), initial=0.0))
    return Motions(bases=bases, columns=columns[free], N=N, most=_not_implied(G[:, ~kept] @ N, most))


def _not_implied(rows: Array, most: Array) -> Array:
    """Infinite where rows (P, any, d) that others imply at home hold a motion here; else as it was, (P,)."""
    return np.where(np.abs(rows).max(axis=(1, 2), initial=0.0) > DEPENDENT, np.inf, most)


def flat_columns(system: System, bases: list[LegBases]) -> Index:
    """Coordinate of each of (z, y), (r,): of the legs as in flat coordinates, then as in `System.border`."""
    of_legs = [(b.legs[:, None] * system.n + b.rest).ravel() for b in bases]
    return np.concatenate([*of_legs, system.legs * system.n + system.border])


def border_rows(bases: list[LegBases]) -> Array:
    """Held pivots by the admissible motions of legs that keep them as rows, (P, rows, r)."""
    width, f = sum(b.rest.size for b in bases), bases[0].Y.shape[-1]
    G, row, at = np.zeros((len(bases[0].N), sum(b.legs.size * b.border.size for b in bases), width + f)), 0, 0
    for b in bases:
        m, h = b.rest.shape[1], b.border.size
        for i in range(b.legs.size):
            G[:, row : row + h, at : at + m] = b.N[:, i, b.border]
            G[:, row : row + h, width:] = b.Y[:, i, b.border]
            row, at = row + h, at + m
    return G
