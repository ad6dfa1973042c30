"""Frequency response of a state space, its poles and its integrators, (T21.2)-(T21.4), (T21.33)-(T21.34).

The response is a sum over poles and residues, checked against direct solutions. Integrators are found by the
zeros in the matrices, and separated exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from flexapod.common.arrays import Array, Complex, Mask
from flexapod.common.errors import ComputationError


@dataclass(frozen=True, kw_only=True)
class IntegratorSplit:
    """A system as A (n, n), B (n, m), C (p, n) beside powers (k, p, m) of 1/s, 1/s^2, ..., Eq. (T21.34).

    ``kept`` (n,): which states A is of; ``most`` (k, p, m): what the powers could add up to without cancelling.
    """

    kept: NDArray[np.int_]
    A: Array
    B: Array
    C: Array
    powers: Array
    most: Array

    def integrator_response(self, s: Complex) -> Complex:
        """Response of the integrators at points s (f,), (p, m, f)."""
        found = np.zeros((*self.powers.shape[1:], len(s)), dtype=complex)
        for k, power in enumerate(self.powers, start=1):
            found += power[:, :, None] * s**-k
        return found


def reachable_observable(A: Array, B: Array, C: Array) -> tuple[Array, Array, Array]:
    """The states that some input moves and some output shows, by what is 0 in the matrices."""
    links = A != 0
    kept = np.flatnonzero(reachable(links, (B != 0).any(axis=1)) & reachable(links.T, (C != 0).any(axis=0)))
    return A[kept][:, kept], B[kept], C[:, kept]


def reachable(links: Mask, start: Mask) -> Mask:
    """States that lie behind those of the start, which are among them."""
    while True:
        further = start | (links @ start)
        if (further == start).all():
            return start
        start = further


def integrators(A: Array) -> Mask:
    """States that nothing but others moves and that no circle of states holds."""
    _, circle = connected_components(A != 0, directed=True, connection="strong")
    return (np.bincount(circle, minlength=1)[circle] == 1) & (np.diag(A) == 0)


def without_integrators(A: Array, B: Array, C: Array) -> IntegratorSplit:
    """Integrators that only drive all else, and those that all else only drives, apart from it, Eq. (T21.33)."""
    links, drift = A != 0, integrators(A)
    others = ~drift
    drives, driven = reachable(links.T, others) & drift, reachable(links, others) & drift
    between = drives & driven
    main = np.flatnonzero(others | between)
    up, down = np.flatnonzero(drives & ~between), np.flatnonzero(drift & ~drives)
    N = np.concatenate([down, up])
    part = lambda rows, columns: A[rows][:, columns]  # noqa: E731
    if not len(N) or not len(main):
        return _as_powers(A, B, C, N, main, (np.abs(B), np.abs(C)))
    # (T21.33)  x_main + X x_up and x_down + Y x_main are apart
    form: Any = scipy.linalg.schur(part(main, main))
    change, back = np.eye(len(A)), np.eye(len(A))
    if len(up):
        X = _decoupled(form, scipy.linalg.schur(part(up, up)), part(main, up))
        change[main[:, None], up], back[main[:, None], up] = X, -X
    if len(down):
        Y = _decoupled(scipy.linalg.schur(part(down, down)), form, part(down, main))
        second, undone = np.eye(len(A)), np.eye(len(A))
        second[down[:, None], main], undone[down[:, None], main] = Y, -Y
        change, back = change @ second, undone @ back
    if not (np.isfinite(change).all() and np.isfinite(back).all()):
        none = np.zeros((0, len(C), B.shape[1]))
        return IntegratorSplit(kept=np.arange(len(A)), A=A, B=B, C=C, powers=none, most=none)
    most = np.abs(back) @ np.abs(B), np.abs(C) @ np.abs(change)
    return _as_powers(back @ A @ change, back @ B, C @ change, N, main, most)


def _decoupled(first: Any, second: Any, coupling: Array) -> Array:
    """X of A X - X B = -coupling by the real Schur forms (T, Z) of A and B."""
    (S, U), (T, V) = first, second
    return U @ sylvester(S, T, -U.T @ coupling @ V, isgn=-1) @ V.T


def sylvester(S: Array, T: Array, Q: Array, **form: Any) -> Array:
    """Solution X of S X + X T = Q of matrices in real Schur form; as `form` asks of S X - X T or S X + X T'."""
    if not Q.size:
        return Q
    lapack: Any = scipy.linalg.lapack
    found, scale, _ = lapack.dtrsyl(S, T, Q, **form)
    return np.asarray(found / scale, dtype=float)


def _as_powers(
    A: Array, B: Array, C: Array, N: NDArray[np.int_], main: NDArray[np.int_], sizes: tuple[Array, Array]
) -> IntegratorSplit:
    """Integrators as powers of 1/s: their matrix to some power is 0; ``sizes``: of B and C without cancelling."""
    inner, shape = A[N][:, N], (len(C), B.shape[1])
    powers, most = [], []
    power, size = B[N], sizes[0][N]
    while power.any():
        powers.append(C[:, N] @ power)
        most.append(sizes[1][:, N] @ size)
        power, size = inner @ power, np.abs(inner) @ size
    return IntegratorSplit(
        kept=main, A=A[main][:, main], B=B[main], C=C[:, main], powers=np.array(powers).reshape(len(powers), *shape),
        most=np.array(most).reshape(len(powers), *shape),
    )  # fmt: skip


UPON = 1e-15  # distance from a pole over its size at which a point lies upon it
FAR = 1e-14  # relative difference of their distances from 0 above which it does not, rounding included
CHECKED = 12  # frequencies at which poles and residues are compared with solving
ALIKE = 1e5  # condition of the shapes of poles above which residues cancel
NEAR = 1e-4  # distance of two poles over their size below which they may be one of which rounding makes two
PARALLEL = 1e-9  # and what 1 - cosine of their shapes is then
AGREES = 1e-9  # of the response, or a tenth of
CANCELS = 0.1  # what its poles could add up to
SHIFTED = 2**0.5  # from the middle of the points, which may lie upon a pole
ADVICE = "Choose other frequencies, or give damping to what vibrates there"
BLOCK = 64  # frequencies solved for side by side
SPAN = 512  # frequencies at which all poles are summed side by side: in the cache of the processor
BAND, MANY = 4.0, 100  # span, and number of frequencies, with less of which they are solved for and not taken in halves


def response(A: Array, B: Array, C: Array, D: Array, s: Complex) -> Complex:
    """C (s - A)^-1 B + D at points s (f,): (outputs, inputs, f), Eq. (T21.1).

    Of the states that inputs move and outputs show. By poles and residues where that agrees with solving at some of
    the points, else of slower and faster ones by themselves, at last by solving.

    Raises
    ------
    ComputationError
        A point upon a pole.
    """
    apart = without_integrators(*reachable_observable(A, B, C))
    if len(apart.powers):
        _refuse_poles(np.zeros(1), s)
    found = _regular(apart.A, apart.B, apart.C, s)
    if len(apart.powers):
        found += apart.integrator_response(s)
    found += D[:, :, None]
    return found


def _regular(A: Array, B: Array, C: Array, s: Complex) -> Complex:
    """C (s - A)^-1 B."""
    if A.shape[0] == 0 or s.size == 0 or B.shape[1] == 0 or C.shape[0] == 0:
        return np.zeros((len(C), B.shape[1], s.size), dtype=complex)
    middle = SHIFTED * np.exp(np.log(np.abs(s[s != 0])).mean()) if s.any() else 1.0
    inverse, shapes = (x.astype(complex) for x in np.linalg.eig(np.linalg.inv(A - middle * np.eye(len(A)))))
    values = np.asarray(
        middle + 1.0 / inverse, dtype=complex
    )  # (T21.35): those amid the points to rounding, however fast others are
    _refuse_poles(values, s)
    sizes = np.linalg.norm(shapes, axis=1, keepdims=True)  # of states: their units are no matter
    if np.linalg.cond(shapes / np.where(sizes > 0, sizes, 1.0)) > ALIKE or _repeated(values, shapes):
        return _in_halves(A, B, C, s)
    left, right = np.linalg.solve(shapes, B.astype(complex)).astype(complex), (C @ shapes).astype(complex)
    some = _where_it_matters(values, s)
    known = _solved(A, B, C, s[some])
    by_poles = _by_residues(values, left, right, s[some])
    most = _most(values, left, right, s[some])
    if (np.abs(by_poles - known) <= AGREES * np.maximum(np.abs(known), CANCELS * most)).all():
        return _by_residues(values, left, right, s)
    return _in_halves(A, B, C, s)


def _repeated(values: Complex, shapes: Complex) -> bool:
    """Test whether a multiple pole has fewer shapes than its multiplicity, as that of two equal filters in a row.

    Sizes of states hide it, for which the second shape is the first and next to nothing of another state.
    """
    close = np.abs(values[:, None] - values) <= NEAR * np.abs(values)
    np.fill_diagonal(close, False)
    i, j = np.nonzero(np.triu(close | close.T))
    unit = shapes / np.linalg.norm(shapes, axis=0)
    return bool((np.abs((unit[:, i].conj() * unit[:, j]).sum(axis=0)) > 1 - PARALLEL).any())


def _in_halves(A: Array, B: Array, C: Array, s: Complex) -> Complex:
    """The slower and the faster points by themselves, amid which poles are known better; few or close ones solved."""
    size = np.abs(s)
    low, high = float(size[size > 0].min(initial=np.inf)), float(size.max())
    if s.size < MANY or high < BAND * low:
        return _solved(A, B, C, s)
    slow, found = size < np.sqrt(low * high), np.empty((len(C), B.shape[1], s.size), dtype=complex)
    for part in (slow, ~slow):
        found[..., part] = _regular(A, B, C, s[part])
    return found


def _most(values: Complex, left: Complex, right: Complex, s: Complex) -> Array:
    """Upper bound of the sum over all poles in each channel, by the inequality of Cauchy and Schwarz, (p, m, f)."""
    shown, moved = np.abs(right), np.abs(left)[None] / np.abs(s[:, None] - values)[..., None]
    w = np.linalg.norm(moved, axis=2) / np.maximum(np.linalg.norm(shown, axis=0), 1e-300)  # poles of one size
    w = np.maximum(w, 1e-300)
    rows, columns = np.sqrt(shown**2 @ w.T), np.sqrt((moved**2 / w[..., None]).sum(axis=1))
    return rows[:, None] * columns.T[None]


def _refuse_poles(values: Complex | Array, s: Complex) -> None:
    """Refuse points upon a pole; a pole is compared with the points as far from 0 as itself."""
    order = np.argsort(np.abs(s), kind="stable")
    sizes, size = np.abs(s)[order], np.abs(values)
    first, end = np.searchsorted(sizes, size * (1 - FAR), "left"), np.searchsorted(sizes, size * (1 + FAR), "right")
    alike = [order[i:k] for i, k in zip(first, end, strict=True)]
    upon = [at[np.abs(s[at] - value) <= UPON * abs(value)] for value, at in zip(values, alike, strict=True)]
    if any(at.size for at in upon):
        raise ComputationError(
            f"the response has no finite size at {abs(s[np.concatenate(upon).min()].imag) / (2 * np.pi):.6g} Hz: "
            "a pole lies there",
            next_step=ADVICE,
        )


def _where_it_matters(values: Complex, s: Complex) -> NDArray[np.int_]:
    """Points spread over all of them, and those nearest to poles."""
    spread = np.linspace(0, s.size - 1, min(CHECKED, s.size)).round().astype(int)
    lasting = values[np.argsort(np.abs(values.real) / np.maximum(np.abs(values), 1e-300), kind="stable")[:CHECKED]]
    near = np.abs(s - lasting[:, None]).argmin(axis=1)
    return np.unique(np.concatenate([spread, near]))


def _by_residues(values: Complex, left: Complex, right: Complex, s: Complex) -> Complex:
    """Sum of residues over s minus poles, Eq. (T21.2); pairs of complex poles in real arithmetic, Eq. (T21.3)."""
    upper = values.imag >= 0
    pole, twice = values[upper], np.where(values[upper].imag > 0, 2.0, 1.0)
    residues = np.einsum("pn,nm->pmn", right[:, upper], left[upper]) * twice
    flat = residues.reshape(-1, len(pole))
    real = np.concatenate([flat.real, flat.imag], axis=1)
    found = np.empty((len(flat), s.size), dtype=complex)
    for i in range(0, s.size, SPAN):
        part = s[i : i + SPAN]
        minus, plus = 1.0 / (part - pole[:, None]), 1.0 / (part - np.conj(pole)[:, None])
        basis = np.concatenate([0.5 * (minus + plus), 0.5j * (minus - plus)])
        found[:, i : i + SPAN] = (real @ basis.view(float)).view(complex)
    return found.reshape(*residues.shape[:2], s.size)


def _solved(A: Array, B: Array, C: Array, s: Complex) -> Complex:
    """Response at points s by solving at each of them, (p, m, f)."""
    each = np.eye(len(A))
    parts = (s[i : i + BLOCK, None, None] * each - A for i in range(0, s.size, BLOCK))
    return np.concatenate([C @ solve_stacked(part, B.astype(complex)) for part in parts]).transpose(1, 2, 0)


def solve_stacked(matrices: NDArray[Any], B: NDArray[Any]) -> Complex:
    """Matrices' inverses times B; a ComputationError where one has none."""
    try:
        return np.asarray(np.linalg.solve(matrices, B), dtype=np.complex128)
    except np.linalg.LinAlgError:
        raise ComputationError(
            "the response has no finite size at a frequency: a pole lies there", next_step=ADVICE
        ) from None


INTEGRATES = 1e-7  # of the largest pole: a double pole at 0 splits that far
SWINGS = 1e-6  # imaginary part over the size of a pole that oscillates


def poles_of(A: Array) -> Complex:
    """Eigenvalues, the slowest first; of a pair the one below the real axis first, (n,)."""
    values = np.linalg.eigvals(A).astype(complex)
    return values[np.lexsort((np.imag(values), np.real(values), np.abs(values)))]


def oscillating_poles(poles: Complex, sample: float | None) -> tuple[Complex, Array, Array]:
    """Poles [1/s] with no negative imaginary part, frequencies [Hz] and damping ratios, sorted by frequency."""
    s, frequency, ratio = pole_properties(poles, sample)
    upper = np.flatnonzero(s.imag >= 0)
    order = upper[np.lexsort((s.real[upper], frequency[upper]))]
    return s[order], frequency[order], ratio[order]


def pole_properties(poles: Complex, sample: float | None) -> tuple[Complex, Array, Array]:
    """Poles [1/s], their frequencies [Hz] and damping ratios, arrays of one shape, Eq. (T21.4).

    Of a sampled system the poles log(z) / T of the continuous one behind it.
    """
    if sample is not None:
        with np.errstate(divide="ignore"):
            behind = np.log(np.asarray(poles, dtype=complex))
        poles = np.real(behind) / sample + 1j * (np.imag(behind) / sample)  # by parts: of a pole at 0 it is -inf
    size = np.abs(poles)
    ratio = np.divide(-poles.real, size, out=np.zeros(poles.shape), where=(size > 0) & np.isfinite(size))
    return poles, size / (2 * np.pi), np.where(np.isinf(size), 1.0, ratio)


def mean_rate(poles: Complex) -> float:
    """A rate amid those of the poles [1/s], so that numbers of the equations are of one size."""
    size = np.abs(poles)
    size = size[size > INTEGRATES * size.max(initial=0.0)]
    return float(np.exp(np.log(size).mean())) if size.size else 1.0
