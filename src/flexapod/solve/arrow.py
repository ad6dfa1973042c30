"""Newton steps of a resting robot at many poses at once, each leg eliminated, Eqs. (T6.6)-(T6.9)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod.solve.elimination import LegBases, Reduced, leg_bases, reduced, solve_each
from flexapod.solve.many import RestMatrices
from flexapod.solve.system import System
from flexapod.typing import Array

__all__ = ["Step", "arrow_solve"]


@dataclass(frozen=True, kw_only=True)
class Step:
    """Change of P states: ``dq`` (P, 6, n), ``dy`` (P, 6), ``dlam`` (P, 6, 3) and ``drive`` (P, legs) forces [N]."""

    dq: Array
    dy: Array
    dlam: Array
    drive: Array


@dataclass(frozen=True, kw_only=True)
class _Group:
    """Legs that are eliminated alike: z = free - by_payload y + by_force f, columns (P, g, m, 1 or 6).

    ``given`` (P, g, n): motion that closes the gaps; ``load`` (P, g, n): residual with it; ``E`` (P, g, 6, m).
    """

    bases: LegBases
    given: Array
    load: Array
    E: Array
    free: Array
    by_payload: Array
    by_force: Array


def arrow_solve(system: System, m: RestMatrices, r: Array, r_payload: Array, g: Array, gap: Array) -> Step:
    """Solve Eq. (T7.1) at P poses; NaN where the stiffness is singular.

    Parameters
    ----------
    system : System
    m : RestMatrices
    r, r_payload, g : ndarray, shapes (P, 6, n), (P, 6), (P, 6, 3)
        From `many.residual_at_rest`.
    gap : ndarray, shape (P, 6)
        Of the prescribed strokes [m].
    """
    l_index, bases = system.kernel.shapes.l_index, leg_bases(system, m)
    A = reduced(bases, m.K, m.payload_K)
    groups = [_eliminated(b, A, k, m, r, _given(b, m, g, gap, l_index), l_index) for k, b in enumerate(bases)]
    y, forces = _border(groups, A, r_payload, gap, l_index)
    dq, dlam, drive = np.zeros_like(r), np.zeros_like(g), np.zeros_like(gap)
    for group, f in zip(groups, forces, strict=True):
        b = group.bases
        z = group.free - group.by_payload @ y[:, None, :, None] + group.by_force * f[..., None, None]
        step = group.given + (b.N @ z + b.Y @ y[:, None, :, None])[..., 0]
        balance = r[:, b.legs] + (m.K[:, b.legs] @ step[..., None])[..., 0]
        balance[..., l_index] -= f
        lam = -(b.inverse.swapaxes(-1, -2) @ balance[..., b.pivot, None])[..., 0]
        along = balance[..., l_index] + (m.J[:, b.legs][..., l_index] * lam).sum(axis=-1)
        dq[:, b.legs], dlam[:, b.legs] = step, lam
        drive[:, b.legs] = np.where(system.held[b.legs, l_index], along + f, 0.0)
    return Step(dq=dq, dy=y, dlam=dlam, drive=drive)


def _given(b: LegBases, m: RestMatrices, g: Array, gap: Array, l_index: int) -> Array:
    """Motion of each leg that closes the gaps of closure and stroke by the pivots alone, (P, g, n)."""
    q = np.zeros((*m.J.shape[:1], b.legs.size, m.J.shape[-1]))
    closure = g[:, b.legs, :, None]
    if l_index not in b.pivot:
        q[..., l_index] = -gap[:, b.legs]
        closure = closure + m.J[:, b.legs][..., l_index, None] * q[..., l_index, None, None]
    q[..., b.pivot] = -(b.inverse @ closure)[..., 0]
    return q


def _eliminated(b: LegBases, A: Reduced, k: int, m: RestMatrices, r: Array, given: Array, l_index: int) -> _Group:
    load = r[:, b.legs] + (m.K[:, b.legs] @ given[..., None])[..., 0]
    sides = [-b.N.swapaxes(-1, -2) @ load[..., None], A.C[k], b.N[..., l_index, :, None]]
    z = solve_each(A.B[k], np.concatenate(sides, axis=-1))
    return _Group(
        bases=b,
        given=given,
        load=load,
        E=A.C[k].swapaxes(-1, -2),
        free=z[..., :1],
        by_payload=z[..., 1:7],
        by_force=z[..., 7:],
    )


def _border(groups: list[_Group], A: Reduced, r_payload: Array, gap: Array, l_index: int) -> tuple[Array, list[Array]]:
    """Payload step y (P, 6) and the force (P, g) on each prescribed stroke that no pivot took out."""
    size = 6 + sum(group.bases.legs.size for group in groups if group.bases.border)
    full, side, at, places = np.zeros((len(gap), size, size)), np.zeros((len(gap), size, 1)), 6, []
    full[:, :6, :6], side[:, :6, 0] = A.S, -r_payload
    for group in groups:
        b, E = group.bases, group.E
        full[:, :6, :6] -= (E @ group.by_payload).sum(axis=1)
        side[:, :6] -= (b.Y.swapaxes(-1, -2) @ group.load[..., None] + E @ group.free).sum(axis=1)
        places.append(np.arange(at, at + b.legs.size * b.border))
        if not b.border:
            continue
        d, Y_l, rows = b.N[..., l_index, :], b.Y[..., l_index, :], places[-1]
        full[:, :6, rows] = ((E @ group.by_force)[..., 0] - Y_l).swapaxes(1, 2)
        full[:, rows, :6] = Y_l - (d[..., None, :] @ group.by_payload)[..., 0, :]
        full[:, rows, rows] = (d * group.by_force[..., 0]).sum(axis=-1)
        side[:, rows, 0] = -gap[:, b.legs] - group.given[..., l_index] - (d * group.free[..., 0]).sum(axis=-1)
        at += rows.size
    x = solve_each(full, side)[..., 0]
    forces = [
        x[:, at] if at.size else np.zeros((len(x), group.bases.legs.size))
        for group, at in zip(groups, places, strict=True)
    ]
    return x[:, :6], forces
