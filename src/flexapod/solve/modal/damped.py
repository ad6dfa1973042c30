"""Damped modes without what has neither mass nor damper: damping ratios and poles, Eqs. (T7.4)-(T7.5), (T7.23)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from flexapod.common.arrays import Array
from flexapod.mechanics.shapes.eigen import finite

__all__ = ["OSCILLATES", "Reacting", "damping_ratios", "poles", "reacting"]

OSCILLATES = 1e-9  # imaginary part over size of an eigenvalue: less is a pair of real ones, split by rounding


@dataclass(frozen=True, kw_only=True)
class Reacting:
    """What of m modes of unit stiffness takes time to move: r modes with mass, and d motions with a damper alone.

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


def reacting(omega: Array, D: Array) -> Reacting:
    """Modes without what has neither mass nor damper: that is at rest, whatever the others do, Eq. (T7.23).

    ``omega``, ``D``: as of `damping_ratios`.

    Raises
    ------
    ComputationError
        A number in it is not finite.
    """
    finite(D)
    mass = np.isfinite(omega)
    damper, shapes = np.linalg.eigh(D[np.ix_(~mass, ~mass)])
    shapes = shapes[:, damper > np.finfo(float).eps * len(omega) * np.linalg.norm(D)]
    count = int(mass.sum())
    basis = np.zeros((len(omega), count + shapes.shape[1]))
    basis[mass, np.arange(count)], basis[~mass, count:] = 1.0, shapes
    rate = float(omega[mass].min(initial=np.inf)) if count else 1.0
    slowness = np.zeros((basis.shape[1], count))
    slowness[:count] = np.diag(rate / omega[mass])
    return Reacting(basis=basis, D=basis.T @ D @ basis, slowness=slowness, rate=rate)


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
    modes, mass = reacting(omega, D), np.isfinite(omega)
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


def poles(omega: Array, D: Array) -> NDArray[np.complex128]:
    """Eigenvalues [1/s] of damped modes as of `damping_ratios`: two of each mass, one of each damper beside them."""
    modes = reacting(omega, D)
    return (modes.rate / np.linalg.eigvals(modes.matrix)).astype(np.complex128)
