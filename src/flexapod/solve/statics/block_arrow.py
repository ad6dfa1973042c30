"""Newton steps of a resting robot at many poses at once, each leg eliminated, Eqs. (T6.6)-(T6.9)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod.common.arrays import Array
from flexapod.solve.batch import RestMatrices
from flexapod.solve.saddle_point import solve_each
from flexapod.solve.statics.elimination import LegBases, border_columns, leg_bases
from flexapod.solve.statics.reduction import reduce_stiffness
from flexapod.solve.system import System


@dataclass(frozen=True, kw_only=True)
class ArrowStep:
    """Change of P states: ``dq`` (P, legs, n), ``dy`` (P, 6), ``dlam`` (P, legs, rows) and ``drive`` (P, legs, ports).

    ``drive`` are forces of held coordinates, ``dlam`` those of the closures.
    """

    dq: Array
    dy: Array
    dlam: Array
    drive: Array


@dataclass(frozen=True, kw_only=True)
class _Group:
    """Legs eliminated in the same way: z = free - by_payload y + by_force f, columns (P, g, m, 1, f or h).

    ``given`` (P, g, n): motion that closes the gaps; ``load`` (P, g, n): residual with it; ``payload`` (P, g, f): what
    it loads the payload with; ``E`` (P, g, f, m).
    """

    bases: LegBases
    given: Array
    load: Array
    payload: Array
    E: Array
    free: Array
    by_payload: Array
    by_force: Array


def arrow_solve(system: System, m: RestMatrices, r: Array, r_payload: Array, g: Array, gap: Array) -> ArrowStep:
    """Solve Eq. (T7.1) at P poses; NaN where the stiffness is singular.

    Parameters
    ----------
    system : System
    m : RestMatrices
    r, r_payload, g : ndarray, shapes (P, legs, n), (P, 6), (P, legs, rows)
        From `batch.residual_at_rest`.
    gap : ndarray, shape (P, legs, n)
        Of the held coordinates [m], [rad]; 0 for the others.

    Notes
    -----
    Where legs that cannot give way hold the payload more often than it needs, forces are those of least norm.
    """
    bases = leg_bases(system, m)
    A = reduce_stiffness(system, bases, m)
    groups = [_eliminated(system, b, A.B[k], A.C[k], m, r, g, gap) for k, b in enumerate(bases)]
    r_border = border_columns(system, r_payload)
    y, forces = _border(groups, A.S, r_border, gap, open_forces=system.has_self_stress)
    dq, dlam, balance, dy = np.zeros(r.shape), np.zeros(g.shape), np.zeros(r.shape), np.zeros((len(r), m.P.shape[-1]))
    dy[:, system.hub_free] = y[:, : system.hub_free.size]
    for group, f in zip(groups, forces, strict=True):
        b = group.bases
        z = group.free - group.by_payload @ y[:, None, :, None] + group.by_force @ f[..., None]
        moved = group.given + (b.N @ z + b.Y @ y[:, None, :, None])[..., 0]
        push = (m.K[:, b.legs] @ moved[..., None])[..., 0]
        if m.X is not None:
            push += (m.X[:, b.legs] @ dy[:, None, :, None])[..., 0]
        dq[:, b.legs], left = moved, r[:, b.legs] + push
        balance[:, b.legs] = left
        left[..., b.border] -= f
        dlam[:, b.legs] = -(b.inverse.swapaxes(-1, -2) @ left[..., b.pivot, None])[..., 0]
    force = balance + (m.J.swapaxes(-1, -2) @ dlam[..., None])[..., 0]  # (T6.9)  of what is held
    return ArrowStep(dq=dq, dy=dy, dlam=dlam, drive=np.where(system.held, force, 0.0)[..., system.ports])


def _eliminated(
    system: System, b: LegBases, B: Array, C: Array, m: RestMatrices, r: Array, g: Array, gap: Array
) -> _Group:
    given = _given(system, b, m, g, gap)
    load, Nt = r[:, b.legs] + (m.K[:, b.legs] @ given[..., None])[..., 0], b.N.swapaxes(-1, -2)
    payload = b.Y.swapaxes(-1, -2) @ load[..., None]
    if m.X is not None:
        payload = payload + border_columns(system, m.X[:, b.legs]).swapaxes(-1, -2) @ given[..., None]
    f = C.shape[-1]
    z = solve_each(B, np.concatenate([-Nt @ load[..., None], C, Nt[..., b.border]], axis=-1))
    return _Group(
        bases=b, given=given, load=load, payload=payload[..., 0], E=C.swapaxes(-1, -2),
        free=z[..., :1], by_payload=z[..., 1 : 1 + f], by_force=z[..., 1 + f :],
    )  # fmt: skip


def _given(system: System, b: LegBases, m: RestMatrices, g: Array, gap: Array) -> Array:
    """Motion of each leg that closes the gaps of the closure, and of what is held and no pivot, (P, g, n)."""
    q, held = np.zeros((len(g), b.legs.size, m.J.shape[-1])), system.held[b.legs[0]].copy()
    held[b.pivot] = False
    q[..., held] = -gap[:, b.legs][..., held]
    closure = g[:, b.legs, :, None] + m.J[:, b.legs] @ q[..., None]
    q[..., b.pivot] = -(b.inverse @ closure)[..., 0]
    return q


def _border(
    groups: list[_Group], S: Array, r_payload: Array, gap: Array, *, open_forces: bool
) -> tuple[Array, list[Array]]:
    """Payload step y (P, f) and the forces (P, g, h) on the held pivots of each group, Eq. (T6.8)."""
    f, at, places = S.shape[-1], S.shape[-1], []
    size = f + sum(group.bases.legs.size * group.bases.border.size for group in groups)
    full, side = np.zeros((len(S), size, size)), np.zeros((len(S), size))
    full[:, :f, :f], side[:, :f] = S, -r_payload
    for group in groups:
        b, h = group.bases, group.bases.border.size
        full[:, :f, :f] -= (group.E @ group.by_payload).sum(axis=1)
        side[:, :f] -= (group.payload + (group.E @ group.free)[..., 0]).sum(axis=1)
        rows = at + np.arange(b.legs.size * h).reshape(b.legs.size, h)
        places.append(rows)
        at += rows.size
        if not h:
            continue
        D, Y = b.N[..., b.border, :], b.Y[..., b.border, :]
        full[:, :f, rows] = (group.E @ group.by_force - Y.swapaxes(-1, -2)).swapaxes(1, 2)
        full[:, rows, :f] = Y - D @ group.by_payload
        full[:, rows[:, :, None], rows[:, None, :]] = D @ group.by_force
        side[:, rows] = -gap[:, b.legs][..., b.border] - group.given[..., b.border] - (D @ group.free)[..., 0]
    if open_forces:
        x = _least_forces(full, side[..., None], f)[..., 0]
    else:
        x = solve_each(full, side[..., None])[..., 0]
    return x[:, :f], [x[:, rows] for rows in places]


def _least_forces(full: Array, side: Array, f: int) -> Array:
    """Solve borders (P, f + h, f + h) whose forces are not determined; those of least norm."""
    compliance, stiffness = (np.abs(part).max(axis=(1, 2), initial=0.0) for part in (full[:, f:, f:], full[:, :f, :f]))
    unit = np.maximum(stiffness, np.divide(1.0, compliance, out=np.ones(len(full)), where=compliance > 0))
    scale = np.ones(full.shape[:2])
    scale[:, :f], scale[:, f:] = 1.0 / np.sqrt(unit)[:, None], np.sqrt(unit)[:, None]
    good = np.isfinite(full).all(axis=(1, 2))
    inverse = np.full(full.shape, np.nan)
    inverse[good] = np.linalg.pinv((scale[:, :, None] * full * scale[:, None, :])[good], rcond=1e-10)
    return np.asarray(scale[..., None] * (inverse @ (scale[..., None] * side)), dtype=np.float64)
