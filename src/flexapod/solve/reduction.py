"""Stiffness and motions of a whole robot on the independent motions of its legs, Eq. (T7.17)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod.arrays import Array
from flexapod.solve.batch import RestMatrices
from flexapod.solve.elimination import LegBases
from flexapod.solve.system import System

__all__ = ["Reduced", "expanded", "hub_motion", "null_space_of_borders", "of_border", "reduced", "reduced_legs"]


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
    free = system.border
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
    X = of_border(system, m.X[:, b.legs])
    return Nt @ (K @ b.N), Nt @ (KY + X), Yt @ (KY + X) + X.swapaxes(-1, -2) @ b.Y


def of_border(system: System, x: Array) -> Array:
    """Columns (..., 6) by the payload's steps as columns by the border's coordinates, (..., f)."""
    more = np.zeros((*x.shape[:-1], system.shared.size))
    return np.concatenate([x[..., system.hub_free], more], axis=-1)


def hub_motion(system: System, flat: Array) -> Array:
    """Rows of the payload's steps and of shared coordinates (..., 6 + shared, m) of flat coordinates (..., size, m)."""
    return np.concatenate([flat[..., system.legs * system.n :, :], flat[..., system.shared, :]], axis=-2)


def expanded(system: System, bases: list[LegBases], vectors: Array) -> Array:
    """Flat coordinates (P, size, m) of admissible motions (P, r, m)."""
    P, _, count = vectors.shape
    flat = np.zeros((P, system.size, count))
    legs = flat[:, : system.legs * system.n].reshape(P, system.legs, system.n, count)
    y, at = vectors[:, vectors.shape[1] - system.border.size :], 0
    flat[:, system.legs * system.n + system.hub_free] = y[:, : system.hub_free.size]
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
    length = np.linalg.norm(G, axis=-1, keepdims=True)
    G = G / np.where(length > 0, length, 1.0)  # a pivot that nothing moves needs no row
    _, size, right = np.linalg.svd(G, full_matrices=True)
    rank = int((size > 1e-9).sum(axis=-1).max(initial=0))
    return np.asarray(right[:, rank:].swapaxes(1, 2), dtype=np.float64)
