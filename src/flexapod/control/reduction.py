"""Systems apart: slow from fast ones, steady from passing ones, by their poles; fewer states, (T21.23)-(T21.24)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.linalg

from flexapod.common.arguments import flag, number
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError, InputError
from flexapod.control.poles import damping_of

if TYPE_CHECKING:
    from flexapod.control.state_space import StateSpace

__all__ = ["Subsystem", "apart", "reduced"]

EQUAL = 1e-6  # relative distance of frequencies that stay together
STATIC = 1e-9  # size of a pole over the largest below which it has no static response


@dataclass(frozen=True, kw_only=True)
class Subsystem:
    """A system whose poles are some of another's: A (n, n), B (n, m), C (p, n)."""

    A: Array
    B: Array
    C: Array


def apart(A: Array, B: Array, C: Array, first: Callable[[complex], bool]) -> tuple[Subsystem, Subsystem]:
    """Two systems side by side that add up to one: poles for which `first` holds, and the others, Eq. (T21.23)."""
    if not len(A):
        return Subsystem(A=A, B=B, C=C), Subsystem(A=A, B=B, C=C)
    A, change = scipy.linalg.matrix_balance(A)
    B, C = np.asarray(np.linalg.solve(change, B), dtype=float), C @ change
    ordered: Any = scipy.linalg.schur(A, output="real", sort=lambda re, im: first(complex(re, im)))
    T, Z, k = ordered
    B, C = Z.T @ B, C @ Z
    # (T21.23)  [1 X; 0 1] takes the coupling away: T11 X - X T22 = -T12
    X = scipy.linalg.solve_sylvester(T[:k, :k], -T[k:, k:], -T[:k, k:])
    near = Subsystem(A=T[:k, :k], B=B[:k] - X @ B[k:], C=C[:, :k])
    return near, Subsystem(A=T[k:, k:], B=B[k:], C=C[:, k:] + C[:, :k] @ X)


def reduced(system: StateSpace, modes: int | None, below: float | str | None, residual: bool) -> StateSpace:
    """See `StateSpace.reduce`."""
    if (modes is None) == (below is None) or modes is None is below:
        raise InputError("one of the two says what stays", key="modes", allowed='modes=20, or below="500 Hz"')
    flag(residual, "residual")
    if system.sample is not None:
        raise InputError("is of samples: its fast modes have no static response", key="sample", value=system.sample)
    poles, frequency, _ = damping_of(system.poles(), None)
    edge = _edge(frequency, modes) if modes is not None else number(below, "below", "frequency", least=0.0)
    slow, fast = apart(system.A, system.B, system.C, lambda pole: abs(pole) < 2 * np.pi * edge)
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
