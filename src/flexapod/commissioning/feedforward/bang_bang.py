"""Least time of a linear system with one bounded input: full force, switched, Eqs. (T22.14)-(T22.16)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from flexapod.common import arguments
from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError, InputError
from flexapod.common.quantities import number, text
from flexapod.control import StateSpace
from flexapod.control.discretization import held_step
from flexapod.control.norms import split_spectrum

PIECES = 200  # of constant input, by which the order of switches is found
CLOSE = 1e-6  # of the time, up to which pieces are made shorter
EXACT = 1e-9  # of the way: what may be missing at the end
OSCILLATES = 1e-9  # imaginary over absolute size of a pole
DOUBLINGS = 40


@dataclass(frozen=True, kw_only=True)
class Switched:
    """An input that is `limit` or its negative: of the sign ``first`` up to the first of the ``times`` (n,) [s].

    ``duration`` [s]: when the system is at rest; ``rigid`` [s]: the same without what oscillates, a time that no input
    falls below; ``missing``: what is left of the way, over the way; ``robust`` times each frequency is left alone.
    """

    times: Array
    duration: float
    limit: float
    first: int
    rigid: float
    missing: float
    robust: bool

    def __call__(self, t: ArrayLike) -> Array:
        """Input at instants (T,); zero before and after."""
        t = np.asarray(t, dtype=float)
        sign = self.first * (-1.0) ** np.searchsorted(self.times, t, side="right")
        return np.where((t >= 0) & (t < self.duration), self.limit * sign, 0.0)

    @property
    def sentence(self) -> str:
        """Benefit, cost and effect as text."""
        also = ", whatever small error its frequencies have" if self.robust else ""
        return (
            f"the input switches {len(self.times)} times and is over after {text(self.duration, 's', 5)}: then nothing "
            f"vibrates{also}. A rigid system of the same mass would take {text(self.rigid, 's', 5)}; vibration costs "
            f"{text(self.duration - self.rigid, 's')}. Left of the way are {number(self.missing, 2)}"
        )

    def __repr__(self) -> str:
        shown = ", ".join(number(x, 6) for x in self.times)
        return f"Switched({shown}, end {number(self.duration, 6)}: {self.sentence})"


def bang_bang_input(system: StateSpace, end: ArrayLike, limit: float = 1.0, *, robust: bool = False) -> Switched:
    """The least time from rest at 0 to rest where the outputs are `end`, of a system of one input within a limit.

    Parameters
    ----------
    system : StateSpace
        Continuous, of one input.
    end : array_like, shape (outputs,)
    limit : float
        Of the input, both ways.
    robust : bool
        Whether vibration shall be left by frequencies that are slightly wrong neither: its derivative by them is zero.

    Raises
    ------
    InputError
        Several inputs, sampled, or no state at rest has these outputs.
    ComputationError
        No input of that size gets there.
    """
    limit = arguments.number(limit, "limit", above=0.0)
    end = arguments.numbers(end, "end", "the outputs at the end, a number for each")
    if not end.any():
        raise InputError("is where the system starts", key="end", value=end.tolist(), allowed="other outputs than 0")
    A, B, target = _chain(system, end, robust)
    times, first, missing = _least(A, B * limit, target)
    rigid = _least(*_rigid(A, B * limit, target))[0]
    return Switched(
        times=times[:-1], duration=float(times[-1]), limit=limit, first=first, rigid=float(rigid[-1]),
        missing=missing, robust=robust,
    )  # fmt: skip


def _chain(system: StateSpace, end: Array, robust: bool) -> tuple[Array, Array, Array]:
    """A, B and the state to reach; for a robust input with how oscillations change with their poles, Eq. (T22.16)."""
    A, B, C = system.A, system.B, system.C
    if system.sample is not None or B.shape[1] != 1:
        raise InputError("is not a continuous system of one input", key="system", value=f"{B.shape[1]} inputs")
    rest = np.concatenate([A, C])
    aim = np.concatenate([np.zeros(len(A)), end]) if end.shape == (len(C),) else None
    x = None if aim is None else np.linalg.lstsq(rest, aim, rcond=None)[0]
    if x is None or aim is None or np.abs(rest @ x - aim).max() > EXACT * np.abs(aim).max():
        raise InputError(
            "are not outputs of a state at rest without an input",
            key="end",
            value=end.tolist(),
            allowed=f"{len(C)} numbers, of a system that stays where it is",
        )
    if not robust:
        return A, B[:, 0], x.astype(float)
    values = np.linalg.eigvals(A)
    turning = np.flatnonzero(values.imag > OSCILLATES * np.abs(values).max())
    n, m = len(A), turning.size
    of_rows, left = np.linalg.eig(A.T)  # a double pole at 0 has no second vector, so that V has no inverse
    rows = left[:, [int(np.argmin(np.abs(of_rows - values[k]))) for k in turning]].T
    whole, force = np.zeros((n + 2 * m, n + 2 * m)), np.zeros(n + 2 * m)
    whole[:n, :n], force[:n] = A, B[:, 0]
    for i, (k, row) in enumerate(zip(turning, rows, strict=True)):
        at, s = n + 2 * i, values[k]
        whole[at : at + 2, at : at + 2] = [[s.real, -s.imag], [s.imag, s.real]]
        whole[at : at + 2, :n] = [row.real, row.imag]
    return whole, force, np.concatenate([x, np.zeros(2 * m)]).astype(float)


def _rigid(A: Array, B: Array, target: Array) -> tuple[Array, Array, Array]:
    """The part of a system that does not oscillate."""
    scale = OSCILLATES * max(1.0, float(np.abs(A).max()))
    both, none = np.column_stack([B, target]), np.zeros((0, len(A)))
    still, _ = split_spectrum(A, lambda pole: abs(pole.imag) <= 1e3 * scale).subsystems(both, none)
    return still.A, still.B[:, 0], still.B[:, 1]


def _least(A: Array, B: Array, target: Array) -> tuple[Array, int, float]:
    """Switches with the end, sign at first, and what is missing; first by pieces, then exactly."""
    low, high = 0.0, 1.0 / max(float(np.abs(np.linalg.eigvals(A)).max()), 1e-3)
    for _ in range(DOUBLINGS):
        if _pieces(A, B, target, high) is not None:
            break
        low, high = high, 2 * high
    else:
        raise ComputationError(
            "no input of this size brings the system there", next_step="Raise the limit, or see what the input moves."
        )
    while high - low > CLOSE * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if _pieces(A, B, target, middle) is not None else (middle, high)
    u = _pieces(A, B, target, high)
    signs = np.sign(u if u is not None else 0)
    places = np.flatnonzero(np.diff(signs) != 0)
    h = high / PIECES
    start = np.array([(k + 1) * h + _inside(u, int(k), h) for k in places])
    return _exact(A, B, target, np.append(start, high), int(signs[0]))


def _inside(u: Array | None, k: int, h: float) -> float:
    """Offset of a sign change from the boundary of its two pieces, by their distance from full input [s]."""
    if u is None:
        return 0.0
    left, right = abs(u[k]), abs(u[k + 1])
    return 0.5 * h * ((1 - right) - (1 - left))


def _pieces(A: Array, B: Array, target: Array, T: float) -> Array | None:
    """Sizes within 1 of pieces of constant input that reach the target at T, if there are any."""
    from scipy.optimize import linprog

    step, push = held_step(A, B[:, None], T / PIECES)
    column, effects = push[:, 0], []
    for _ in range(PIECES):
        effects.append(column)
        column = step @ column
    G = np.array(effects[::-1]).T
    size = np.abs(G).max(axis=1)
    found = linprog(np.zeros(PIECES), A_eq=G / size[:, None], b_eq=target / size, bounds=(-1, 1), method="highs-ds")
    return found.x if found.status == 0 else None


def _exact(A: Array, B: Array, target: Array, start: Array, first: int) -> tuple[Array, int, float]:
    """Switches and end that reach the target exactly, Eq. (T22.15), from near ones."""
    from scipy.optimize import least_squares

    scale = np.abs(target).max()

    def missing(times: Array) -> Array:
        x, sign, before = np.zeros(len(A)), first, 0.0
        for t in times:
            step, push = held_step(A, B[:, None], t - before)
            x, sign, before = step @ x + sign * push[:, 0], -sign, t
        return (x - target) / scale

    found = least_squares(missing, start, xtol=1e-15, ftol=1e-15, gtol=1e-15)
    left = float(np.abs(found.fun).max())
    if left > EXACT or (np.diff(found.x, prepend=0.0) <= 0).any():
        raise ComputationError(
            f"the order of switches was not found: {left:.2g} of the way are missing",
            next_step="Scale the system so that its slowest and fastest motions are nearer to each other.",
        )
    return found.x, first, left
