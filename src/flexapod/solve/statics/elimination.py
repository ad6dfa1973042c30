"""Elimination of each leg onto the payload, for many poses at once, Eqs. (T6.6)-(T6.9) and (T7.16)-(T7.17).

The readable twin of ``native/arrow.c`` with the pose as first axis. Every leg is pivoted by the coordinates
that its closure determines; a pivot that is held stays as a row of the border. Where independent motions are
wanted, shapes of the leg take the place of its held pivots (`keep_held_pivots`), the same ones at every pose
(`System.substitutes`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexapod.common.arrays import Array, Index, Mask
from flexapod.solve.batch import RestMatrices
from flexapod.solve.saddle_point import inverse_each, solve_each
from flexapod.solve.system import System


@dataclass(frozen=True, kw_only=True)
class LegBases:
    """Admissible motions of legs that hold the same coordinates, dq = N z + Y y, Eq. (T7.16).

    ``legs`` (g,): which; ``pivot`` (rows,): coordinates found from the closure; ``rest`` (g, m): those kept in z;
    ``border`` (h,): pivots that are held but free here, so that each leg has h rows q_k = 0 more; ``inverse``
    (P, g, rows, rows): of the pivots' columns of J; ``N`` (P, g, n, m); ``Y`` (P, g, n, f) for the f coordinates of
    the payload that are not held and those that all legs share; ``most`` (P,): by how much a shape that stands for a
    held pivot moves while another coordinate moves by one, at most.
    """

    legs: Index
    pivot: Index
    rest: Index
    border: Index
    inverse: Array
    N: Array
    Y: Array
    most: Array

    def __getitem__(self, chosen: Index) -> LegBases:
        """Select some of the poses."""
        return replace(self, **{name: getattr(self, name)[chosen] for name in ("inverse", "N", "Y", "most")})


def leg_bases(system: System, m: RestMatrices) -> list[LegBases]:
    """Bases of all legs at P poses, grouped by what they hold."""
    return [_bases(system, m, *kind) for kind in system.kinds]


def _bases(system: System, m: RestMatrices, legs: Index, held: Mask, rest: Index) -> LegBases:
    pivot, n, shared = np.array(system.kernel.shapes.pivots, dtype=np.intp), system.n, system.shared_coordinates
    J, P = m.J[:, legs], border_columns(system, m.P[:, legs])
    P[..., system.hub_free.size :] = -J[..., shared]
    inverse = inverse_each(J[..., pivot])
    N, Y = np.zeros((*J.shape[:2], n, rest.size)), np.zeros((*J.shape[:2], n, P.shape[-1]))
    N[..., pivot, :] = -inverse @ J[..., rest]
    N[..., rest, np.arange(rest.size)] = 1.0
    Y[..., pivot, :] = inverse @ P
    Y[..., shared, P.shape[-1] - shared.size + np.arange(shared.size)] = 1.0
    each, border, most = rest[None].repeat(legs.size, axis=0), pivot[held[pivot]], np.zeros(len(J))
    return LegBases(legs=legs, pivot=pivot, rest=each, border=border, inverse=inverse, N=N, Y=Y, most=most)


def border_columns(system: System, x: Array) -> Array:
    """Columns (..., 6) by the payload's steps as columns by the border's coordinates, (..., f)."""
    found, free = np.zeros((*x.shape[:-1], system.border.size)), system.hub_free
    found[..., : free.size] = x[..., free]
    return found


def keep_held_pivots(system: System, bases: list[LegBases]) -> list[LegBases]:
    """Bases whose legs keep their held pivots where legs are compliant; the others have their borders still.

    ``system`` with `substitutes`.
    """
    of = system.substitutes
    return [_closed(b, of[b.legs[:, None], b.border], system.n) if b.border.size else b for b in bases]


def _closed(b: LegBases, by: Index, n: int) -> LegBases:
    """Take the shapes ``by`` (g, h) for held pivots out of z: N_s z_s = - N_r z_r - Y y on the rows of the border."""
    if not (by // n == b.legs[:, None]).all():
        return b
    chosen = (b.rest[:, None] == (by % n)[..., None]).argmax(axis=-1)
    out = np.zeros(b.rest.shape, dtype=bool)
    np.put_along_axis(out, chosen, True, axis=-1)
    kept = np.argsort(out, axis=-1, kind="stable")[:, : b.rest.shape[1] - b.border.size]
    shapes, others = (np.take_along_axis(b.N, k[None, :, None], axis=-1) for k in (chosen, kept))
    given = np.concatenate([others, b.Y], axis=-1)
    moves = solve_each(shapes[..., b.border, :], given[..., b.border, :])
    moved = given - shapes @ moves
    moved[..., b.border, :] = 0.0
    width = kept.shape[1]
    return replace(
        b, border=b.border[:0], rest=np.take_along_axis(b.rest, kept, axis=1), N=moved[..., :width],
        Y=moved[..., width:], most=np.abs(moves).max(axis=(1, 2, 3), initial=0.0),
    )  # fmt: skip
