"""Closure forces where statics leaves some open: those of least strain energy in the legs, Eqs. (T7.24)-(T7.26)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flexapod.common.arrays import Array
from flexapod.kinematics.rotations import matrix
from flexapod.mechanics.leg.layout import columns, leg_parameters
from flexapod.solve.batch import RestMatrices, RestStates
from flexapod.solve.saddle_point import solve_each
from flexapod.solve.system import System

SAME = 1e-6  # sine of an angle below which two balances count as one


def open_forces(system: System) -> int:
    """Number of closure forces undetermined by the balance of free coordinates in a robot without compliance."""
    return max(system.legs * system.rows - _balances(system), 0)


def _balances(system: System) -> int:
    return int((~system.held).sum()) - (system.legs - 1) * system.shared_coordinates.size + system.hub_free.size


def closure_forces(system: System, x: RestStates, m: RestMatrices, r: Array, r_payload: Array) -> Array:
    """Forces of the closures that balance free coordinates, of least energy where some are open, (T, legs, rows).

    Parameters
    ----------
    system : System
        With no more free coordinates than closure rows: without shapes.
    x : RestStates
        Configurations; their forces do not matter.
    m : RestMatrices
        Of the same; of them the closures' J and P.
    r, r_payload : ndarray, shapes (T, legs, n, k), (T, 6, k)
        Balances without closure forces, k right-hand sides.

    Returns
    -------
    ndarray, shape (T, legs, rows, k)
        NaN where the configuration is singular.
    """
    A, inverse = _rows(system, m), _inverse_root(system, x, m)
    of_legs = [-r[:, i, ~held] for i, held in enumerate(system.held)]
    b = np.concatenate([*of_legs, r_payload[:, system.hub_free]], axis=1)
    Q, R = np.linalg.qr(_in_legs(inverse, A.swapaxes(1, 2)))
    lam = _in_legs(inverse.swapaxes(-1, -2), Q @ solve_each(R.swapaxes(1, 2), b))  # (T7.26)
    return lam.reshape(len(x), system.legs, system.rows, -1)


def least_energy(system: System, x: RestStates, m: RestMatrices) -> RestStates:
    """The same equilibria without what the legs do to each other where nothing elastic asks for it, Eq. (T7.26)."""
    A, inverse = _rows(system, m), _inverse_root(system, x, m)
    A = A / np.maximum(np.linalg.norm(A, axis=-1, keepdims=True), 1e-300)
    U, size, _ = np.linalg.svd(_in_legs(inverse, A.swapaxes(1, 2)), full_matrices=False)
    U = U * (size > SAME * size[:, :1])[:, None]
    scaled = solve_each(inverse.swapaxes(-1, -2), x.lam[..., None]).reshape(len(x), -1, 1)
    lam = _in_legs(inverse.swapaxes(-1, -2), U @ (U.swapaxes(1, 2) @ scaled)).reshape(x.lam.shape)
    change = (m.J.swapaxes(-1, -2) @ (lam - x.lam)[..., None])[..., 0]
    return replace(x, lam=lam, drive=x.drive + np.where(system.held, change, 0.0)[..., system.ports])


def _rows(system: System, m: RestMatrices) -> Array:
    """Balances of free coordinates as rows over all closure forces, (T, balances, legs * rows), Eq. (T7.24)."""
    T, legs, rows, _ = m.J.shape
    A, at = np.zeros((T, _balances(system), legs, rows)), 0
    for i, held in enumerate(system.held):
        free = np.setdiff1d(np.flatnonzero(~held), system.shared_coordinates)
        A[:, at : at + free.size, i] = m.J[:, i][..., free].swapaxes(-1, -2)
        at += free.size
    A[:, at : at + system.shared_coordinates.size] = np.moveaxis(m.J[..., system.shared_coordinates], -1, 1)
    at += system.shared_coordinates.size
    A[:, at:] = np.moveaxis(m.P[..., system.hub_free], -1, 1)
    return A.reshape(T, -1, legs * rows)


def _in_legs(blocks: Array, columns_: Array) -> Array:
    """Blocks (T, legs, rows, rows) times columns (T, legs * rows, k)."""
    T, legs, rows, _ = blocks.shape
    return (blocks @ columns_.reshape(T, legs, rows, -1)).reshape(T, legs * rows, -1)


def _inverse_root(system: System, x: RestStates, m: RestMatrices) -> Array:
    """Inverse of the lower factor of each leg's compliance, (T, legs, rows, rows)."""
    return np.asarray(np.linalg.inv(np.linalg.cholesky(_compliance(system, x, m))), dtype=np.float64)


def _compliance(system: System, x: RestStates, m: RestMatrices) -> Array:
    """Compliance of the legs' tips to closure forces, stroke and joints held, (T, legs, rows, rows), Eq. (T7.25)."""
    layout = leg_parameters(system.kernel.shapes)
    EA, EI, Lp, mouth = (system.leg_p[:, columns(layout, name)][..., 0] for name in ("EA", "EI", "Lp", "mouth"))
    GJ = system.leg_p[:, columns(layout, "GJ")][..., 0] if system.kernel.shapes.has("t") else EI / 1.3
    l_index = system.kernel.shapes.l_index
    s = np.maximum(x.q[..., l_index] - mouth, 1e-3 * Lp)[..., None, None]
    z = m.J[..., :3, l_index]
    z = z / np.linalg.norm(z, axis=-1, keepdims=True)
    along = z[..., :, None] * z[..., None, :]
    across, EI = np.eye(3) - along, EI[:, None, None]
    C = np.zeros((*x.lam.shape, system.rows))
    C[..., :3, :3] = along * (Lp / EA)[:, None, None] + across * s**3 / (3 * EI)
    if system.rows == 6:
        turn = matrix(x.pose[:, 3:])[:, None] @ m.P[..., 3:, 3:].swapaxes(-1, -2)  # closure forces to moments, world
        tilt = np.cross(np.eye(3), z[..., None, :]).swapaxes(-1, -2) * s**2 / (2 * EI)  # M x z
        C[..., :3, 3:] = tilt @ turn
        C[..., 3:, :3] = C[..., :3, 3:].swapaxes(-1, -2)
        C[..., 3:, 3:] = turn.swapaxes(-1, -2) @ (across * s / EI + along * s / GJ[:, None, None]) @ turn
    return C
