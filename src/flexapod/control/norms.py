"""Norms of a linear system, relative gains, and systems split and reduced by their poles, (T21.23)-(T21.29).

H2 and H-infinity norms come with the reason of infinite ones.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from flexapod.common.arguments import flag, number
from flexapod.common.arrays import Array, Complex, Mask
from flexapod.common.errors import ComputationError, InputError
from flexapod.control.frequency_response import (
    INTEGRATES,
    IntegratorSplit,
    integrators,
    oscillating_poles,
    pole_properties,
    reachable,
    reachable_observable,
    sylvester,
    without_integrators,
)

if TYPE_CHECKING:
    from flexapod.control.state_space import StateSpace

EQUAL = 1e-6  # relative distance of frequencies that stay together
STATIC = 1e-9  # size of a pole over the largest below which it has no static response


@dataclass(frozen=True, kw_only=True)
class Subsystem:
    """A system whose poles are some of another's: A (n, n), B (n, m), C (p, n)."""

    A: Array
    B: Array
    C: Array


@dataclass(frozen=True, kw_only=True)
class PoleSplit:
    """Coordinates in which some poles of a matrix stand apart from its others, Eq. (T21.23).

    ``near`` (k, k), ``far`` (n - k, n - k): both blocks, in real Schur form. ``change``, ``Z`` (n, n): to the states
    balanced, and to those of the Schur form. ``X`` (k, n - k): the coupling of the blocks.
    """

    near: Array
    far: Array
    change: Array
    Z: Array
    X: Array

    def subsystems(self, B: Array, C: Array) -> tuple[Subsystem, Subsystem]:
        """Two systems side by side that add up to the one of the matrix, B (n, m) and C (p, n)."""
        k = len(self.near)
        B, C = self.Z.T @ np.linalg.solve(self.change, B), C @ self.change @ self.Z
        near = Subsystem(A=self.near, B=B[:k] - self.X @ B[k:], C=C[:, :k])
        return near, Subsystem(A=self.far, B=B[k:], C=C[:, k:] + C[:, :k] @ self.X)


def split_spectrum(A: Array, first: Callable[[complex], bool]) -> PoleSplit:
    """Poles for which `first` holds apart from the others, Eq. (T21.23)."""
    if not len(A):
        return PoleSplit(near=A, far=A, change=A, Z=A, X=A)
    balanced: Any = scipy.linalg.matrix_balance(A)
    A, change = balanced
    ordered: Any = scipy.linalg.schur(A, output="real", sort=lambda re, im: first(complex(re, im)))
    T, Z, k = ordered
    # (T21.23)  [1 X; 0 1] takes the coupling away: T11 X - X T22 = -T12
    X = sylvester(T[:k, :k], T[k:, k:], -T[:k, k:], isgn=-1)
    return PoleSplit(near=T[:k, :k], far=T[k:, k:], change=change, Z=Z, X=X)


def truncate_modes(system: StateSpace, modes: int | None, below: float | str | None, residual: bool) -> StateSpace:
    """See `StateSpace.reduce`."""
    if (modes is None) == (below is None) or modes is None is below:
        raise InputError("one of the two says what stays", key="modes", allowed='modes=20, or below="500 Hz"')
    flag(residual, "residual")
    if system.sample is not None:
        raise InputError("is of samples: its fast modes have no static response", key="sample", value=system.sample)
    poles, frequency, _ = oscillating_poles(system.poles(), None)
    edge = _edge(frequency, modes) if modes is not None else number(below, "below", "frequency", least=0.0)
    slow, fast = split_spectrum(system.A, lambda pole: abs(pole) < 2 * np.pi * edge).subsystems(system.B, system.C)
    D = np.array(system.D)
    if residual and len(fast.A):
        if np.abs(np.linalg.eigvals(fast.A)).min() <= STATIC * np.abs(poles).max():
            raise ComputationError("what is left out has no static response: it drifts", next_step="residual=False")
        D -= fast.C @ np.linalg.solve(fast.A, fast.B)  # (T21.24)
    return replace(
        system.select(),
        A=slow.A,
        B=slow.B,
        C=slow.C,
        D=D,
        states=tuple(f"slow {i + 1}" for i in range(len(slow.A))),
    )


def _edge(frequency: Array, modes: int) -> float:
    """Frequency [Hz] between the modes that stay and the others; those of one frequency stay together."""
    if not isinstance(modes, int | np.integer) or modes < 0:
        raise InputError("is no number of modes", key="modes", value=modes, allowed="0, 1, 2, ...")
    while 0 < modes < len(frequency) and frequency[modes] <= (1 + EQUAL) * frequency[modes - 1]:
        modes += 1
    if modes >= len(frequency):
        return float("inf")
    return float(0.5 * (frequency[modes] + (frequency[modes - 1] if modes else 0.0)))


LASTS = 1e-9  # damping ratio, and size of a pole over the middle one, below which nothing decays
OPPOSITE = 0.1  # of the size of two poles beside 0: so near their sum is to it
SHOWN = 1e-9  # of the product of all sizes: a response of what lasts that counts
PEAK = 1e-10  # relative accuracy of H-infinity
COARSE = (1e-3, 1e-6)  # above what no end of frequencies has: next to that, crossings lie near no end and are not found
ROUNDS = 40
ON_AXIS = 1e-8  # real part of an eigenvalue over its size that lies on the imaginary axis


def rate_scale(poles: Complex) -> tuple[float, float]:
    """The middle one [rad/s] of the sizes of poles, and the size up to which they are 0.

    Rounding splits a double pole at 0, of what nothing holds, into two on opposite sides of it.
    """
    size = np.abs(poles)
    if not size.any():
        return 1.0, 0.0
    rate = float(np.exp(np.log(size[size > LASTS * size.max()]).mean()))
    few = poles[size <= INTEGRATES * size.max()]
    across = np.abs(few[:, None] + few) + np.where(np.eye(len(few)), np.inf, 0.0)
    split = np.abs(few)[across.min(axis=1, initial=np.inf) <= OPPOSITE * np.abs(few)]
    return rate, max(LASTS * rate, 2 * float(split.max(initial=0.0)))


def is_marginal(pole: complex, rate: float, rest: float) -> bool:
    """Test whether the motion of a pole [1/s] never decays, relative to a `rate`; up to `rest` [rad/s] it is 0."""
    return pole.real >= -max(LASTS * abs(pole), LASTS * LASTS * rate) or abs(pole) <= rest


def h2_norms(system: StateSpace) -> tuple[Array, dict[tuple[int, int], str]]:
    """H2 norm of each channel (outputs, inputs), Eq. (T21.25), and why some are infinite by (output, input)."""
    A, B, C, D = system.A, system.B, system.C, system.D
    found, why = np.zeros(D.shape), {}
    rates = np.zeros(D.shape) if system.D_rate is None else system.D_rate
    links = A != 0
    shown = np.array([reachable(links.T, row != 0) for row in C], dtype=bool).reshape(C.shape)
    moved = np.array([reachable(links, column != 0) for column in B.T], dtype=bool).reshape(B.T.shape)
    drifting = integrators(A) if system.sample is None else np.zeros(len(A), dtype=bool)
    splits: dict[bytes, PoleSplit] = {}
    apart: dict[bytes, IntegratorSplit] = {}

    def of_states(kept: NDArray[np.int_], b: Array, C: Array, d: Array) -> tuple[Array, list[str]]:
        if (key := kept.tobytes()) not in splits:
            splits[key] = _split_lasting(A[kept][:, kept], system.sample)
        return _h2_of(splits[key], b, C, d, system.sample)

    def beside_drift(j: int) -> IntegratorSplit:
        if (key := (moved[j] & ~drifting).tobytes()) not in apart:
            apart[key] = _without_drift(system, moved, drifting, j)
        return apart[key]

    for j in range(B.shape[1]):
        may = (shown & drifting & moved[j]).any(axis=1)
        of = beside_drift(j) if may.any() else None
        still = may & _cancels(of)[:, j] if of is not None else may
        for i in np.flatnonzero(may & ~still):
            why[int(i), j] = "an integrator: a pole at 0 Hz"
        if system.sample is None:
            for i in np.flatnonzero(rates[:, j]):
                why.setdefault((int(i), j), "it follows the rate of the input, which grows with frequency without end")
            for i in np.flatnonzero(D[:, j]):
                why.setdefault((int(i), j), "feed-through: it follows what has no end of frequencies")
        ends = np.array([(i, j) not in why for i in range(len(C))], dtype=bool)
        if of is not None and (rows := np.flatnonzero(still & ends)).size:
            found[rows, j], lasting = of_states(of.kept, of.B[:, j], of.C[rows], D[rows, j])
            why |= {(int(i), j): words for i, words in zip(rows, lasting, strict=True) if words}
            ends[rows] = False
        kept, rows = np.flatnonzero(moved[j] & shown[ends].any(axis=0)), np.flatnonzero(ends)
        found[rows, j], lasting = of_states(kept, B[kept, j], C[rows][:, kept], D[rows, j])
        why |= {(int(i), j): words for i, words in zip(rows, lasting, strict=True) if words}
    for at in why:
        found[at] = np.inf
    return found, why


def _without_drift(system: StateSpace, moved: Mask, drifting: Mask, j: int) -> IntegratorSplit:
    """The states that an input moves beside its integrators, Eq. (T21.34), by their places among all.

    With those of all inputs that move the same other states: all have their integrators apart from these at once.
    """
    alike = ((moved == moved[j]) | drifting).all(axis=1)
    at = np.flatnonzero(moved[alike].any(axis=0))
    of = without_integrators(system.A[at][:, at], system.B[at], system.C[:, at])
    return replace(of, kept=at[of.kept])


def _cancels(of: IntegratorSplit) -> Mask:
    """Channels (p, m) in which powers of 1/s add up to rounding."""
    return np.asarray((np.abs(of.powers) <= SHOWN * of.most).all(axis=0))


def _split_lasting(A: Array, sample: float | None) -> PoleSplit:
    """Poles whose motion decays apart from those whose motion lasts."""
    if sample is not None:
        return split_spectrum(A, lambda pole: abs(pole) < 1 - LASTS)
    rate, rest = rate_scale(np.linalg.eigvals(A).astype(complex))
    return split_spectrum(A, lambda pole: not is_marginal(pole, rate, rest))


def _h2_of(split: PoleSplit, b: Array, C: Array, d: Array, sample: float | None) -> tuple[Array, list[str]]:
    """H2 norms of one input by outputs (p,), and of each what lasts in it, "" of those that end."""
    ends, lasts = split.subsystems(b[:, None], C)
    words = _lasting(lasts, ends, sample)
    if not len(ends.A):
        return np.abs(d), words
    if sample is None:
        P = sylvester(ends.A, ends.A, -ends.B @ ends.B.T, tranb="T")  # (T21.26)
    else:
        P = scipy.linalg.solve_discrete_lyapunov(ends.A, ends.B @ ends.B.T)
    power = ((ends.C @ P) * ends.C).sum(axis=1) + (d**2 if sample is not None else 0.0)
    return np.sqrt(np.maximum(power, 0.0)), words


def _lasting(part: Subsystem, ends: Subsystem, sample: float | None) -> list[str]:
    """Text on the motion of each output that never decays; "" where the decaying part hides it.

    Poles of samples are those behind them.
    """
    words = [""] * len(part.C)
    if not len(part.A):
        return words
    scale = np.linalg.norm(np.hstack([part.C, ends.C]), axis=1) * np.linalg.norm(np.vstack([part.B, ends.B]))
    power, seen = part.B[:, 0], np.zeros(len(part.C), dtype=bool)
    for _ in range(len(part.A)):
        seen |= np.abs(part.C @ power) > SHOWN * scale * (np.linalg.norm(power) / np.linalg.norm(part.B))
        power = part.A @ power
        if not power.any():
            break
    worst = max(pole_properties(np.linalg.eigvals(part.A).astype(complex), sample)[0], key=lambda pole: pole.real)
    at = f"a pole at {abs(worst) / (2 * np.pi):.4g} Hz"
    kind = "an unstable motion" if worst.real > LASTS * abs(worst) else "a motion that never decays"
    return [f"{kind}: {at}" if one else "" for one in seen]


def hinf_norm(system: StateSpace) -> tuple[float, float]:
    """Largest singular value of the response over all frequencies, and where it is [Hz], Eq. (T21.27).

    Bruinsma & Steinbuch, Systems & Control Letters 14, 1990: levels which no frequency reaches have Hamiltonian
    matrices without eigenvalues on the imaginary axis. Infinite, at its pole, of what never decays.
    """
    if system.D_rate is not None:
        return np.inf, np.inf
    A, B, C = reachable_observable(system.A, system.B, system.C)
    if system.sample is None and len((of := without_integrators(A, B, C)).A) < len(A) and _cancels(of).all():
        A, B, C = of.A, of.B, of.C
    D, poles = system.D, np.linalg.eigvals(A).astype(complex)
    if not len(A):
        return float(np.linalg.norm(D, 2)) if D.size else 0.0, 0.0
    if system.sample is not None:
        if len(lasting := poles[np.abs(poles) >= 1 - LASTS]):
            return np.inf, float(np.abs(np.angle(lasting[0])) / (2 * np.pi * system.sample))
        A, B, C, D, poles = _continuous(A, B, C, D)
    rate, rest = rate_scale(poles)
    if lasting := [pole for pole in poles if is_marginal(pole, rate, rest)]:
        return np.inf, _hertz(abs(lasting[0]), system.sample)
    A, change = scipy.linalg.matrix_balance(A / rate)  # time in units of 1 / rate
    B, C = np.asarray(np.linalg.solve(change, B), dtype=float), C @ change / rate
    level, at = max((float(np.linalg.norm(_at(A, B, C, D, w), 2)), w) for w in [0.0, *np.abs(poles) / rate])
    far = float(np.linalg.norm(D, 2))
    level, at = max((level, at), (far, np.inf))
    for _ in range(ROUNDS):
        steps = (PEAK,) if np.isfinite(at) else (*COARSE, PEAK)
        every = (_crossings(A, B, C, D, level * (1 + step)) for step in steps if level)
        crossings = next((found for found in every if len(found)), np.zeros(0))
        if not len(crossings):
            break
        middles = [0.5 * crossings[0], *0.5 * (crossings[1:] + crossings[:-1]), 2 * crossings[-1]]
        most, where = max((float(np.linalg.norm(_at(A, B, C, D, w), 2)), w) for w in middles)
        if most <= level * (1 + PEAK):
            break
        level, at = most, where
    return level, _hertz(at * rate, system.sample)


def _hertz(omega: float, sample: float | None) -> float:
    """Frequency [Hz] of an angular one [rad/s], or of that behind the bilinear transform of samples."""
    return float(omega / (2 * np.pi) if sample is None else np.arctan(omega) / (np.pi * sample))


def _at(A: Array, B: Array, C: Array, D: Array, omega: float) -> Complex:
    return D + C @ np.linalg.solve(1j * omega * np.eye(len(A)) - A, B)


def _continuous(A: Array, B: Array, C: Array, D: Array) -> tuple[Array, Array, Array, Array, Complex]:
    """Continuous system with the sizes on the imaginary axis of a sampled one on the circle: s = (z - 1) / (z + 1)."""
    inverse = np.asarray(np.linalg.inv(np.eye(len(A)) + A), dtype=float)
    found = inverse @ (A - np.eye(len(A)))
    poles = np.linalg.eigvals(found).astype(complex)
    return found, np.sqrt(2) * inverse @ B, np.sqrt(2) * C @ inverse, D - C @ inverse @ B, poles


def _crossings(A: Array, B: Array, C: Array, D: Array, level: float) -> Array:
    """Frequencies at which a singular value is `level`: eigenvalues of the Hamiltonian on the axis, Eq. (T21.28)."""
    R, S = D.T @ D - level**2 * np.eye(D.shape[1]), D @ D.T - level**2 * np.eye(D.shape[0])
    if min(np.linalg.cond(R), np.linalg.cond(S)) > 1 / PEAK**1.5:
        return np.zeros(0)
    inner = A - B @ np.linalg.solve(R, D.T @ C)
    size = np.sqrt(np.linalg.norm(B) / np.linalg.norm(C))  # both blocks of one size
    values = np.linalg.eigvals(
        np.block(
            [
                [inner, -level / size**2 * B @ np.linalg.solve(R, B.T)],
                [level * size**2 * C.T @ np.linalg.solve(S, C), -inner.T],
            ]
        )
    )
    return np.unique(np.abs(values[np.abs(values.real) <= ON_AXIS * np.maximum(np.abs(values), 1.0)].imag))


def relative_gains(response: Complex) -> Complex:
    """G times the transposed inverse of G, number by number, (n, n, f), Eq. (T21.29): 1 where loops do not couple.

    Raises
    ------
    ComputationError
        A matrix without an inverse.
    """
    G = np.moveaxis(response, 2, 0)
    try:
        inverse = np.linalg.inv(G)
    except np.linalg.LinAlgError:
        raise ComputationError("the response has no inverse: some outputs move together") from None
    return np.moveaxis(G * inverse.transpose(0, 2, 1), 0, 2)
