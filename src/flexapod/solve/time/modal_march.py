"""Steps of a linear model whose matrices change along a path, Eqs. (T22.12)-(T22.13), (T22.25)."""

from __future__ import annotations

from ctypes import Structure, byref, c_double, c_long, c_void_p

import numpy as np
from numpy.typing import NDArray

from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.solve.kernel import Kernel
from flexapod.solve.system import Index
from flexapod.solve.time.native import address, loops, memory

GAUSS: Array = np.array([[1 / 4, 1 / 4 - np.sqrt(3) / 6], [1 / 4 + np.sqrt(3) / 6, 1 / 4]])
STAGES = 0.5 + np.sqrt(3) / 6 * np.array([-1.0, 1.0])  # of a step, at which loads are taken
_ROOTS, _AXES = np.linalg.eig(GAUSS)
#: The eigenvalue of one stage, its row of the inverse eigenvectors and its weight; the other stage is its conjugate.
ROOT, TURN, WEIGHT = _ROOTS[0], np.linalg.inv(_AXES)[0], 0.5 * _AXES[:, 0].sum()


class _ModalPath(Structure):
    _fields_ = [
        *[(name, c_long) for name in ("size", "loads", "steps", "pieces", "entries")],
        *[(name, c_void_p) for name in ("first", "at", "edge", "series", "force")],
        ("h", c_double),
        ("turn", c_double * 4),
        ("weight", c_double * 2),
        ("root", c_double * 2),
        *[(name, c_void_p) for name in ("x", "memory")],
    ]


def cubic_pieces(time: Array, values: Array) -> Array:
    """Cubic splines through values (P, ...) as polynomials (P - 1, 4, ...), the highest power first."""
    from scipy.interpolate import CubicSpline

    flat = values.reshape(len(time), -1)
    there = np.flatnonzero(flat.any(axis=0))
    found = np.zeros((len(time) - 1, 4, flat.shape[1]))
    found[..., there] = CubicSpline(time, flat[:, there]).c.swapaxes(0, 1)
    return found.reshape(len(time) - 1, 4, *values.shape[1:])


def modal_march(kernel: Kernel, time: Array, matrices: tuple[Array, Array, Array], force: Array) -> Array:
    """Places and rates (T + 1, 2, d, c) of M z'' + D z' + K z = f from rest, after each of T even steps.

    Parameters
    ----------
    kernel : Kernel
        Whose compiler has compiled the steps; without one they are those of NumPy.
    time : ndarray, shape (P,)
        Instants [s] from 0 to the end, between which matrices follow cubic splines.
    matrices : tuple of ndarray, shape (P, d, d)
        M, D, K.
    force : ndarray, shape (T, 2, d, c)
        Of each of c loads at the `STAGES` of each step.

    Raises
    ------
    ComputationError
        The matrices are singular at an instant.
    """
    P, d, steps = len(time), force.shape[2], len(force)
    if any(part.shape != (P, d, d) for part in matrices) or force.shape[1] != 2 or not steps or P < 2:
        raise ValueError(f"matrices {[part.shape for part in matrices]}, loads {force.shape} at {P} instants")
    x = dense_march(time, matrices, force) if kernel.equations is None else _march(kernel, time, matrices, force)
    if not np.isfinite(x[-1]).all():
        raise ComputationError("the linear model along the path has singular matrices, or loads that are not finite")
    return x


def _march(kernel: Kernel, time: Array, matrices: tuple[Array, Array, Array], force: Array) -> Array:
    first, at, rows, columns = _envelope(matrices)
    x = np.zeros((len(force) + 1, *force.shape[1:]))
    edges, force = np.ascontiguousarray(time, dtype=float), np.ascontiguousarray(force, dtype=float)
    series = cubic_pieces(edges, np.stack([part[:, rows, columns] for part in matrices], axis=1))
    call = _ModalPath(
        force.shape[2], force.shape[3], len(force), len(time) - 1, rows.size,
        first.ctypes.data, at.ctypes.data, *[address(y) for y in (edges, series, force)], time[-1] / len(force),
        (c_double * 4)(*np.stack([TURN.real, TURN.imag], axis=1).ravel()), *[
            (c_double * 2)(float(y.real), float(y.imag)) for y in (WEIGHT, ROOT)
        ], address(x),
    )  # fmt: skip
    library = loops(kernel)
    library.modal_memory.restype, library.modal_march.restype = c_long, None
    room = memory(library.modal_memory(byref(call)))
    call.memory = address(room)
    library.modal_march(byref(call))
    return x


def _envelope(matrices: tuple[Array, Array, Array]) -> tuple[NDArray[np.int_], NDArray[np.int_], Index, Index]:
    """First column (d,) of each row, the place (d,) of its entries, and rows and columns (entries,) of all."""
    there = np.any([part.any(axis=0) for part in matrices], axis=0)
    there |= there.T | np.eye(len(there), dtype=bool)
    first = there.argmax(axis=1).astype(np.int_)
    before = [np.arange(f, i) for i, f in enumerate(first)]
    rows = [np.concatenate([np.full(k.size, i), k, [i]]) for i, k in enumerate(before)]
    columns = [np.concatenate([k, np.full(k.size, i), [i]]) for i, k in enumerate(before)]
    at = np.cumsum([0, *map(len, rows[:-1])]).astype(np.int_)
    return first, at, np.concatenate(rows).astype(np.intp), np.concatenate(columns).astype(np.intp)


def dense_march(time: Array, matrices: tuple[Array, Array, Array], force: Array) -> Array:
    """Steps of `modal_march` in NumPy, by (T22.13) as it is written, with whole matrices."""
    from scipy.interpolate import CubicSpline

    at, h, c = CubicSpline(time, np.stack(matrices, axis=1)), time[-1] / len(force), TURN.sum()
    way, x = h * ROOT, np.zeros((len(force) + 1, *force.shape[1:]))
    for k, f in enumerate(force):
        (M, D, K), (z, v) = at(h * (k + 0.5)), x[k]
        side = TURN[0] * f[0] + TURN[1] * f[1] - c * (D @ v + K @ z) - way * c * (K @ v)
        q = np.linalg.solve(M + way * D + way**2 * K, side)
        x[k + 1] = x[k] + 2 * h * np.real(WEIGHT * np.array([c * v + way * q, q]))
    return x
