"""Frequency response of a state space from its poles and residues, checked against solving, (T21.2)-(T21.3)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from flexapod.arrays import Array, Mask
from flexapod.errors import ComputationError

__all__ = ["response"]

Complex = NDArray[np.complex128]

UPON = 1e-15  # distance from a pole over its size at which a point lies upon it
CHECKED = 12  # frequencies at which poles and residues are compared with solving
ALIKE = 1e5  # condition of the shapes of poles above which residues cancel
AGREES = 1e-10  # of the response, with
CANCELS = 1e-13  # of the sum of sizes of its terms
BLOCK = 64  # frequencies solved for side by side


def response(A: Array, B: Array, C: Array, D: Array, s: Complex) -> Complex:
    """C (s - A)^-1 B + D at points s (f,): (outputs, inputs, f), Eq. (T21.1).

    Of the states that inputs move and outputs show. By poles and residues where that agrees with solving at some of the points, else by
    solving at all of them.

    Raises
    ------
    ComputationError
        A point upon a pole.
    """
    A, B, C = moved_and_shown(A, B, C)
    if A.shape[0] == 0 or s.size == 0 or B.shape[1] == 0 or C.shape[0] == 0:
        return np.repeat(D[:, :, None].astype(complex), s.size, axis=2)
    values, shapes = np.linalg.eig(A)
    _refuse_poles(values, s)
    sizes = np.linalg.norm(shapes, axis=1, keepdims=True)  # of states: their units are no matter
    if np.linalg.cond(shapes / np.where(sizes > 0, sizes, 1.0)) > ALIKE:
        return _solved(A, B, C, s) + D[:, :, None]
    left, right = np.linalg.solve(shapes, B.astype(complex)), C @ shapes
    some = _where_it_matters(values, s)
    known = _solved(A, B, C, s[some])
    terms = np.abs(1.0 / (s[some, None] - values))
    floor = np.einsum("pn,fn,nm->pmf", np.abs(right), terms, np.abs(left), optimize=True)
    by_poles = _by_residues(values, left, right, s[some])
    if (np.abs(by_poles - known) <= AGREES * np.abs(known) + CANCELS * floor).all():
        return _by_residues(values, left, right, s) + D[:, :, None]
    return _solved(A, B, C, s) + D[:, :, None]


def moved_and_shown(A: Array, B: Array, C: Array) -> tuple[Array, Array, Array]:
    """The states that some input moves and some output shows, by what is 0 in the matrices."""
    links = A != 0
    kept = np.flatnonzero(_reached(links, (B != 0).any(axis=1)) & _reached(links.T, (C != 0).any(axis=0)))
    return A[np.ix_(kept, kept)], B[kept], C[:, kept]


def _reached(links: Mask, start: Mask) -> Mask:
    """States that lie behind those of the start, which are among them."""
    while True:
        further = start | (links @ start)
        if (further == start).all():
            return start
        start = further


def _refuse_poles(values: Complex, s: Complex) -> None:
    away = np.abs(s[:, None] - values)
    if (away <= UPON * np.abs(values)).any():
        at = s[(away <= UPON * np.abs(values)).any(axis=1)][0]
        raise ComputationError(
            f"the response has no finite size at {abs(at.imag) / (2 * np.pi):.6g} Hz: a pole lies there",
            next_step="Choose other frequencies, or give damping to what vibrates there",
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
    found = [
        C @ np.linalg.solve(s[i : i + BLOCK, None, None] * each - A, B.astype(complex)) for i in range(0, s.size, BLOCK)
    ]
    return np.concatenate(found).transpose(1, 2, 0)
