"""Undamped and damped modes from factors of stiffness and mass, Eqs. (T7.4)-(T7.5), (T7.21)-(T7.23).

Frequencies and shapes are right however light a part is, Eqs. (T7.21)-(T7.22). Damping ratios and poles leave
out what has neither mass nor damper, Eq. (T7.23).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexapod.common.arrays import Array, Mask
from flexapod.mechanics.shapes.beam_functions import check_finite
from flexapod.solve.saddle_point import cholesky_each

ROUNDED = 1e-10  # eigenvalue of a mass matrix with a unit diagonal that may be rounding
NO_MASS = 1e-12  # share of its mass that what others do leaves of a coordinate: less is rounding
PIVOT = 4 * np.finfo(float).eps  # share of a mass, times the size, that a factor leaves of what has none of its own
LIGHTEST = 1e-10  # root of a mass over that of what moves with it: less is rounding
SLOW = 1e-6  # lowest frequency over the highest: above, all modes have mass


def mass_factor(M: Array, *, carried: bool = False) -> tuple[Array, Mask]:
    """Factors U, M = U^T U, of mass matrices (..., n, n), and which of these no mass or a real one has.

    A coordinate without mass has a row of zeros. Taken of one body by itself, each row is right to rounding of its own
    size, however much heavier other bodies are. Where coordinates move the same mass, as those of a base joint and a
    stroke with nothing but the piston, the matrix is singular; `carried`: it is, as a base moves the body in ways in
    which it moves by itself.
    """
    if carried:
        return _by_pivots(M)
    whole = np.diagonal(M, axis1=-2, axis2=-1)
    massless = whole == 0
    root, positive = cholesky_each(M + massless[..., None] * np.eye(M.shape[-1]))
    U, left = root.swapaxes(-1, -2) * ~massless[..., None], np.diagonal(root, axis1=-2, axis2=-1) ** 2
    alike = ~positive | ((left <= M.shape[-1] * PIVOT * whole) & ~massless).any(axis=-1)
    if alike.any():
        U[alike], positive[alike] = _by_pivots(M[alike])
    return U, positive


def _by_pivots(M: Array) -> tuple[Array, Mask]:
    """Factors of singular mass matrices, the coordinates that keep most of their mass first, zeros from the rank on."""
    left, U = M.copy(), np.zeros(M.shape)
    whole = np.abs(np.diagonal(M, axis1=-2, axis2=-1))
    per_whole = np.divide(1.0, whole, out=np.zeros(whole.shape), where=whole > 0)
    for k in range(M.shape[-1]):
        share = np.diagonal(left, axis1=-2, axis2=-1) * per_whole
        at = share.argmax(axis=-1)[..., None]
        real = np.take_along_axis(share, at, axis=-1) > NO_MASS
        row = np.take_along_axis(left, at[..., None], axis=-2)[..., 0, :]
        pivot = np.where(real, np.take_along_axis(row, at, axis=-1), 1.0)
        U[..., k, :] = np.where(real, row, 0.0) / np.sqrt(pivot)
        left -= U[..., k, :, None] * U[..., k, None, :]
    return U, (np.diagonal(left, axis1=-2, axis2=-1) * per_whole).min(axis=-1, initial=0.0) > -ROUNDED


def mass_rank(U: Array) -> Array:
    """Rank (p,) of mass matrices U^T U, (p, rows, r): how many motions have mass, Eq. (T7.22)."""
    size = np.linalg.norm(U, axis=1, keepdims=True)
    moving = size > np.finfo(float).eps * U.shape[1] * size.max(axis=-1, keepdims=True, initial=0.0)
    alike = np.divide(U, size, out=np.zeros(U.shape), where=moving)
    return np.asarray((np.linalg.svd(alike, compute_uv=False) > LIGHTEST).sum(axis=-1))


def natural_modes(U: Array, K: Array, *, shapes: bool) -> tuple[Array, Array, Mask]:
    """Angular frequencies (p, r) [rad/s] ascending, shapes (p, r, r) of unit stiffness, and where K is positive.

    Parameters
    ----------
    U : ndarray, shape (p, rows, r)
        Factor of the mass matrix, M = U^T U, with r rows or more; its rank may be lower than r.
    K : ndarray, shape (p, r, r)
        Stiffness, symmetric.
    shapes : bool
        Whether shapes are wanted; else (p, r, 0).

    Raises
    ------
    ComputationError
        A number is not finite.

    Notes
    -----
    With K = L L^T and the singular values s of U L^-T (T7.21) the frequencies are 1 / s: the lowest ones are right to
    rounding, the others to rounding times their multiple of it. There are as many as the rank of the mass matrix
    (T7.22); the others are inf, and all NaN where K is not positive. Times its frequency a shape has unit mass.
    """
    L, positive = cholesky_each(K)
    L = np.where(positive[:, None, None], L, np.eye(K.shape[-1]))
    X = np.asarray(np.linalg.solve(L, U.swapaxes(1, 2)), dtype=np.float64)  # (T7.21), transposed
    check_finite(X)
    if shapes:
        left, sizes, _ = np.linalg.svd(X, full_matrices=False)
    else:
        left, sizes = np.zeros((*K.shape[:2], 0)), np.linalg.svd(X, compute_uv=False)
    real = sizes > SLOW * sizes[:, :1]
    if (light := ~real.all(axis=1)).any():
        real[light] = np.arange(sizes.shape[1]) < mass_rank(U[light])[:, None]  # (T7.22)
    real &= sizes > 0
    omega = np.divide(1.0, sizes, out=np.full(sizes.shape, np.inf), where=real)
    omega[~positive] = np.nan
    z = np.asarray(np.linalg.solve(L.swapaxes(1, 2), left), dtype=np.float64)
    return omega, z, positive


def count_real(frequency: Array) -> int:
    """Number of modes that any pose has, of frequencies (..., m) that are NaN last; all where no pose has any."""
    width = frequency.shape[-1]
    real = np.isfinite(frequency).reshape(-1, width).any(axis=0)
    return int(real.sum()) or width


SWEEPS, SETTLED = 100, 4 * np.finfo(float).eps  # of a mode and its neighbours; change of an eigenvalue that is rounding
CLEAR = 0.9  # share of an undamped shape in a damped one, above which no other can have half of either
OSCILLATES = 1e-9  # imaginary part over size of an eigenvalue: less is a pair of real ones, split by rounding


@dataclass(frozen=True, kw_only=True)
class ReactingModes:
    """Motions, of m modes of unit stiffness, that take time: r modes with mass, and d motions with dampers alone.

    ``basis`` (m, r + d): these by the modes, those with mass first; ``D`` (r + d, r + d): damping [s];
    ``slowness`` (r + d, r): one over the frequencies, by the ``rate`` [rad/s] of the lowest of them; 0 without mass.
    """

    basis: Array
    D: Array
    slowness: Array
    rate: float

    @property
    def matrix(self) -> Array:
        """Matrix of order 2 r + d, regular, with the eigenvalues rate/mu, Eq. (T7.23)."""
        count = self.slowness.shape[1]
        return np.block([[-self.rate * self.D, -self.slowness], [self.slowness.T, np.zeros((count, count))]])


def reacting_modes(omega: Array, D: Array) -> ReactingModes:
    """Modes without what has neither mass nor damper: that is at rest, whatever the others do, Eq. (T7.23).

    ``omega``, ``D``: as of `damping_ratios`.

    Raises
    ------
    ComputationError
        A number in it is not finite.
    """
    check_finite(D)
    mass = np.isfinite(omega)
    damper, shapes = np.linalg.eigh(D[np.ix_(~mass, ~mass)])
    shapes = shapes[:, damper > np.finfo(float).eps * len(omega) * np.linalg.norm(D)]
    count = int(mass.sum())
    basis = np.zeros((len(omega), count + shapes.shape[1]))
    basis[mass, np.arange(count)], basis[~mass, count:] = 1.0, shapes
    rate = float(omega[mass].min(initial=np.inf)) if count else 1.0
    slowness = np.zeros((basis.shape[1], count))
    slowness[:count] = np.diag(rate / omega[mass])
    return ReactingModes(basis=basis, D=basis.T @ D @ basis, slowness=slowness, rate=rate)


def damping_ratios(omega: Array, D: Array) -> Array:
    """-Re/|.| of the damped eigenvalue that shares most of each undamped shape, Eqs. (T7.4)-(T7.5), (m,).

    D_jj omega_j / 2 for a mode of which no oscillating eigenvalue has at least half (overdamped or evenly mixed), 0 of
    what has no mass.

    Parameters
    ----------
    omega : ndarray, shape (m,)
        Undamped angular frequencies [rad/s], above 0; inf for what has no mass.
    D : ndarray, shape (m, m)
        Damping matrix in modal coordinates of unit stiffness [s].

    Raises
    ------
    ComputationError
        A number in it is not finite.
    """
    modes, mass = reacting_modes(omega, D), np.isfinite(omega)
    ratio = 0.5 * np.diag(D) * np.where(mass, omega, 0.0)
    if not D.any() or not mass.any():
        return ratio
    # (T7.23)  Eigenvalues 1/mu: the slow modes come out right however fast a light part is.
    values, shapes = np.linalg.eig(modes.matrix)
    oscillating = np.imag(values) < -OSCILLATES * np.abs(values)
    values, share = values[oscillating], modes.slowness.T @ np.abs(shapes[: len(modes.D), oscillating])
    share /= np.linalg.norm(share, axis=0)
    at, named, taken = np.flatnonzero(mass), set(), set()
    pairs = np.argwhere(share > 0.5)
    for mode, column in pairs[np.argsort(-share[tuple(pairs.T)], kind="stable")].tolist():  # the clearest pair first
        if mode not in named and column not in taken:
            ratio[at[mode]] = -np.real(values[column]) / np.abs(values[column])
            named.add(mode)
            taken.add(column)
    return ratio


def damping_ratios_of(mode: int, omega: Array, D: Array) -> Array:
    """Damping ratios (p,) of one mode, as of `damping_ratios`, by its own eigenvalue alone, Eq. (T7.29).

    ``omega``, ``D``: (p, m) and (p, m, m), as there.

    Raises
    ------
    ComputationError
        A number in D is not finite.
    """
    check_finite(D)
    x, slow = np.zeros(omega.shape, dtype=complex), 1 / omega
    x[:, mode], own, settled = 1.0, np.diagonal(D, axis1=1, axis2=2), np.zeros(len(omega), dtype=bool)
    value: NDArray[np.complex128] = np.zeros(len(omega), dtype=complex)
    with np.errstate(all="ignore"):  # what does not settle is left to all modes at once
        for _ in range(SWEEPS):
            before, push = value, (D @ x[..., None])[..., 0]
            s = 0.5 * omega[:, mode] * push[:, mode]
            value = np.asarray(omega[:, mode] * (1j * np.sqrt(1 - s**2) - s), dtype=complex)
            x = (own * x - push) * value[:, None] / (1 + value[:, None] * (own + value[:, None] * slow**2))
            x[:, mode] = 1.0
            settled = np.abs(value - before) <= SETTLED * np.abs(value)
            if settled.all():
                break
        share = 1 / (omega[:, mode] * np.linalg.norm(np.abs(x) * slow, axis=1))
        ratio = -value.real / np.abs(value)
    for k in np.flatnonzero(~(settled & (share > CLEAR) & (value.imag > OSCILLATES * np.abs(value)))):
        ratio[k] = damping_ratios(omega[k], D[k])[mode]
    return ratio


def poles(omega: Array, D: Array) -> NDArray[np.complex128]:
    """Eigenvalues [1/s] of damped modes as of `damping_ratios`: two of each mass, one of each damper beside them."""
    modes = reacting_modes(omega, D)
    return (modes.rate / np.linalg.eigvals(modes.matrix)).astype(np.complex128)
