"""Frequency response of a state space from its poles and residues, checked against solving, (T21.2)-(T21.3)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.control.integrators import moved_and_shown, without_integrators

__all__ = ["divided", "response"]

Complex = NDArray[np.complex128]

UPON = 1e-15  # distance from a pole over its size at which a point lies upon it
CHECKED = 12  # frequencies at which poles and residues are compared with solving
ALIKE = 1e5  # condition of the shapes of poles above which residues cancel
NEAR = 1e-4  # distance of two poles over their size below which they may be one of which rounding makes two
PARALLEL = 1e-9  # and what 1 - cosine of their shapes is then
AGREES = 1e-9  # of the response, or a tenth of
CANCELS = 0.1  # what its poles could add up to
SHIFTED = 2**0.5  # from the middle of the points, which may lie upon a pole
ADVICE = "Choose other frequencies, or give damping to what vibrates there"
BLOCK = 64  # frequencies solved for side by side
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
    apart = without_integrators(*moved_and_shown(A, B, C))
    if len(apart.powers):
        _refuse_poles(np.zeros(1), s)
    return _regular(apart.A, apart.B, apart.C, s) + apart.drifting(s) + D[:, :, None]


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
    """Whether a pole has fewer shapes than it is often there, as that of two equal filters in a row.

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
    """What all poles could add up to in each channel, by the inequality of Cauchy and Schwarz, (p, m, f)."""
    shown, moved = np.abs(right), np.abs(left)[None] / np.abs(s[:, None] - values)[..., None]
    w = np.linalg.norm(moved, axis=2) / np.maximum(np.linalg.norm(shown, axis=0), 1e-300)  # poles of one size
    w = np.maximum(w, 1e-300)
    rows, columns = np.sqrt(shown**2 @ w.T), np.sqrt((moved**2 / w[..., None]).sum(axis=1))
    return rows[:, None] * columns.T[None]


def _refuse_poles(values: Complex | Array, s: Complex) -> None:
    away = np.abs(s[:, None] - values)
    if (away <= UPON * np.abs(values)).any():
        at = s[(away <= UPON * np.abs(values)).any(axis=1)][0]
        raise ComputationError(
            f"the response has no finite size at {abs(at.imag) / (2 * np.pi):.6g} Hz: a pole lies there",
            next_step=ADVICE,
        )


def _where_it_matters(values: Complex, s: Complex) -> NDArray[np.int_]:
    """Points spread over all of them, and those nearest to poles."""
    spread = np.linspace(0, s.size - 1, min(CHECKED, s.size)).round().astype(int)
    lasting = values[np.argsort(np.abs(values.real) / np.maximum(np.abs(values), 1e-300), kind="stable")[:CHECKED]]
    near = np.abs(s[:, None] - lasting).argmin(axis=0)
    return np.unique(np.concatenate([spread, near]))


def _by_residues(values: Complex, left: Complex, right: Complex, s: Complex) -> Complex:
    """Sum of residues over s minus poles, Eq. (T21.2); pairs of complex poles in real arithmetic, Eq. (T21.3)."""
    upper = values.imag >= 0
    pole, twice = values[upper], np.where(values[upper].imag > 0, 2.0, 1.0)
    residues = np.einsum("pn,nm->pmn", right[:, upper], left[upper]) * twice
    minus, plus = 1.0 / (s[None] - pole[:, None]), 1.0 / (s[None] - np.conj(pole)[:, None])
    even, odd = 0.5 * (minus + plus), 0.5j * (minus - plus)
    flat = residues.reshape(-1, len(pole))
    real = np.concatenate([flat.real, flat.imag], axis=1)
    basis = np.concatenate([even, odd])
    found = np.empty((len(flat), s.size), dtype=complex)
    found.real, found.imag = real @ basis.real, real @ basis.imag
    return found.reshape(*residues.shape[:2], s.size)


def _solved(A: Array, B: Array, C: Array, s: Complex) -> Complex:
    """The same by solving at each point."""
    each = np.eye(len(A))
    parts = (s[i : i + BLOCK, None, None] * each - A for i in range(0, s.size, BLOCK))
    return np.concatenate([C @ divided(part, B.astype(complex)) for part in parts]).transpose(1, 2, 0)


def divided(matrices: NDArray[Any], B: NDArray[Any]) -> Complex:
    """Matrices' inverses times B; a ComputationError where one has none."""
    try:
        return np.asarray(np.linalg.solve(matrices, B), dtype=np.complex128)
    except np.linalg.LinAlgError:
        raise ComputationError(
            "the response has no finite size at a frequency: a pole lies there", next_step=ADVICE
        ) from None
