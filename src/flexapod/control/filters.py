"""Laws of one channel, from a reading and its rate to an output: integrators, filters, leads, (T21.6)-(T21.11)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import comb

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexapod.common.arguments import frequencies, number, numbers
from flexapod.common.arrays import Array, floats
from flexapod.common.errors import InputError
from flexapod.common.units import DIMENSIONS
from flexapod.control.frequency_response import solve_stacked

Number = float | str


@dataclass(frozen=True, kw_only=True)
class ControlLaw:
    """x' = A x + B (y, y'), out = C x + D (y, y') of one reading y with its rate y', Eq. (T21.6).

    The rate stands beside the reading, so that laws with a pure derivative have a state space: of a linear system the
    rate is exact, of a sampled reading it is the last difference over the period. ``A`` (n, n), ``B`` (n, 2),
    ``C`` (n,), ``D`` (2,).
    """

    A: Array
    B: Array
    C: Array
    D: Array

    def __post_init__(self) -> None:
        """Finite arrays whose shapes fit."""
        try:
            A = floats(self.A)
        except ValueError:
            A = np.zeros(0)  # refused below
        n = len(A) if A.ndim == 2 else 0
        for name, shape in (("A", (n, n)), ("B", (n, 2)), ("C", (n,)), ("D", (2,))):
            try:
                value = floats(getattr(self, name))
            except ValueError:
                value = np.full(1, np.nan)
            if value.shape != shape or not np.isfinite(value).all():
                allowed = f"finite numbers of the shape {shape}, of {n} states"
                raise InputError("is no array of a law", key=name, value=getattr(self, name), allowed=allowed)
            object.__setattr__(self, name, value)

    @classmethod
    def of(cls, numerator: Sequence[float], denominator: Sequence[float] = (1.0,)) -> ControlLaw:
        """Numerator over denominator, powers of s with the highest first; at most one zero more than poles."""
        top, bottom = (
            np.trim_zeros(numbers(numerator, "numerator", "finite numbers"), "f"),
            np.trim_zeros(numbers(denominator, "denominator", "finite numbers"), "f"),
        )
        n = len(bottom) - 1
        if n < 0 or len(top) > n + 2:
            raise InputError(
                "has more than one zero more than poles",
                key="numerator",
                value=f"{list(top)} over {list(bottom)}",
                allowed="a degree of at most that of the denominator and one",
                next_step="Multiply it by a low_pass",
            )
        top = np.concatenate([np.zeros(n + 2 - len(top)), top]) / bottom[0]
        bottom = bottom / bottom[0]
        derivative = top[0]
        top = top[1:] - derivative * np.append(bottom[1:], 0.0)
        direct = top[0]
        A = np.vstack([-bottom[1:], np.eye(n)[:-1]]) if n else np.zeros((0, 0))
        B = np.zeros((n, 2))
        B[:1, 0] = 1.0
        return cls(A=A, B=B, C=top[1:] - direct * bottom[1:], D=np.array([direct, derivative]))

    @property
    def uses_rate(self) -> bool:
        """Test whether the law depends on the rate of its reading."""
        return bool(self.B[:, 1].any() or self.D[1])

    def __mul__(self, other: ControlLaw | float) -> ControlLaw:
        """A number of times the law, or one law behind the other: their transfers multiply, Eq. (T21.7)."""
        if not isinstance(other, ControlLaw):
            factor = number(other, "factor")
            return ControlLaw(A=self.A, B=self.B, C=factor * self.C, D=factor * self.D)
        first, second = (self, other) if not other.uses_rate else (other, self)
        if second.uses_rate:
            raise InputError("both take rates: their product needs a rate of a rate", key="law")
        n, m = len(first.A), len(second.A)
        return ControlLaw(
            A=np.block([[first.A, np.zeros((n, m))], [np.outer(second.B[:, 0], first.C), second.A]]),
            B=np.vstack([first.B, np.outer(second.B[:, 0], first.D)]),
            C=np.concatenate([second.D[0] * first.C, second.C]),
            D=second.D[0] * first.D,
        )

    __rmul__ = __mul__

    def __add__(self, other: ControlLaw) -> ControlLaw:
        """Two laws side by side: their outputs add."""
        check_law(other)
        n, m = len(self.A), len(other.A)
        return ControlLaw(
            A=np.block([[self.A, np.zeros((n, m))], [np.zeros((m, n)), other.A]]),
            B=np.vstack([self.B, other.B]),
            C=np.concatenate([self.C, other.C]),
            D=self.D + other.D,
        )

    def at(self, hz: ArrayLike) -> NDArray[np.complex128]:
        """Complex response (f,) at frequencies [Hz], the rate that of the reading."""
        s = 2j * np.pi * frequencies(hz)
        given = np.stack([np.ones_like(s), s])
        moved = solve_stacked(s[:, None, None] * np.eye(len(self.A)) - self.A, (self.B @ given).T[..., None])
        return (moved[..., 0] @ self.C) + self.D @ given


def check_law(law: ControlLaw) -> ControlLaw:
    """The law, where it is one."""
    if not isinstance(law, ControlLaw):
        raise InputError("is no law", key="law", value=law, allowed="of flexapod.control, as gain(2.0)")
    return law


def gain(value: float) -> ControlLaw:
    """A number."""
    return ControlLaw.of([value])


def rate(value: float, low_pass: Number | None = None) -> ControlLaw:
    """A number times the rate; `low_pass` [Hz]: corner above which it is the reading's."""
    return (
        ControlLaw.of([value, 0.0])
        if low_pass is None
        else ControlLaw.of([value, 0.0], [1 / _omega(low_pass, "low_pass"), 1.0])
    )


def integrator(value: float, high_pass: Number = 0.0) -> ControlLaw:
    """Integral above the corner `high_pass` [Hz], below it a number: value / (s + w), Eq. (T21.8)."""
    return ControlLaw.of([value], [1.0, _omega(high_pass, "high_pass", least=0.0)])


def low_pass(corner: Number, order: int = 1, damping: float = 0.5**0.5) -> ControlLaw:
    """1 at rest, above the corner [Hz] falling with a power of one or two; of order 2 with a damping ratio."""
    w, damping = _omega(corner, "corner"), number(damping, "damping", above=0.0)
    return ControlLaw.of([1.0], _of_order(order, [1 / w, 1.0], [1 / w**2, 2 * damping / w, 1.0]))


def high_pass(corner: Number, order: int = 1, damping: float = 0.5**0.5) -> ControlLaw:
    """1 far above the corner [Hz], below it falling with a power of one or two."""
    w, damping = _omega(corner, "corner"), number(damping, "damping", above=0.0)
    top = _of_order(order, [1 / w, 0.0], [1 / w**2, 0.0, 0.0])
    return ControlLaw.of(top, _of_order(order, [1 / w, 1.0], [1 / w**2, 2 * damping / w, 1.0]))


def lead(crossing: Number, ratio: float) -> ControlLaw:
    """(1 + s h / w) / (1 + s / (h w)) / h: size 1 at the crossing [Hz], phase most there, Eq. (T21.9)."""
    w, ratio = _omega(crossing, "crossing"), number(ratio, "ratio", above=0.0)
    return ControlLaw.of([1 / w, 1 / ratio], [1 / (ratio * w), 1.0])


def notch(frequency: Number, damping: float = 0.5, depth: float = 0.0) -> ControlLaw:
    """1 but about a frequency [Hz], where it is `depth`; `damping`: how broad, Eq. (T21.10)."""
    w, damping, depth = _omega(frequency, "frequency"), number(damping, "damping", above=0.0), number(depth, "depth")
    return ControlLaw.of([1.0, 2 * depth * damping * w, w**2], [1.0, 2 * damping * w, w**2])


def pid(
    proportional: float, integral: float = 0.0, derivative: float = 0.0, low_pass: Number | None = None
) -> ControlLaw:
    """Reading, integral and rate, each times a number; `low_pass` [Hz] of the rate alone."""
    law, integral, derivative = gain(proportional), number(integral, "integral"), number(derivative, "derivative")
    if low_pass is not None:
        _omega(low_pass, "low_pass")
    law = law + integrator(integral) if integral else law
    return law + rate(derivative, low_pass) if derivative else law


def positive_feedback(frequency: Number, damping: float, value: float) -> ControlLaw:
    """Law of positive position feedback: value w^2 / (s^2 + 2 zeta w s + w^2)."""
    w, damping, value = _omega(frequency, "frequency"), number(damping, "damping", above=0.0), number(value, "value")
    return ControlLaw.of([value * w**2], [1.0, 2 * damping * w, w**2])


def complementary(corner: Number, order: int = 1) -> tuple[ControlLaw, ControlLaw]:
    """Low-pass and high-pass that add up to 1 and fall with the power `order` outside of their bands, Eq. (T21.11)."""
    if not isinstance(order, int) or order not in (1, 2, 3):
        raise InputError("is not an order of complementary filters", key="order", value=order, allowed="1, 2, 3")
    w, n = _omega(corner, "corner"), 2 * order - 1
    terms = [comb(n, k) * w**k for k in range(n + 1)]  # of (s + w)^n
    above = [*terms[:order], *[0.0] * (n + 1 - order)]
    return ControlLaw.of(terms[order:], terms), ControlLaw.of(above, terms)


def _of_order(order: int, one: list[float], two: list[float]) -> list[float]:
    if not isinstance(order, int) or order not in (1, 2):
        raise InputError("is not an order of this filter", key="order", value=order, allowed="1, 2")
    return one if order == 1 else two


def _omega(frequency: Number, key: str, least: float | None = None) -> float:
    """Angular frequency [rad/s] of a number [Hz] or a text."""
    found, known = number(frequency, key, "frequency"), DIMENSIONS["frequency"]
    if found < 0 or (least is None and found == 0):
        raise InputError("is not a frequency", key=key, value=frequency, allowed="above 0 Hz")
    if found and not known.least <= found <= known.most:
        allowed = f"{known.least:g} to {known.most:g} Hz"
        raise InputError("is not a frequency of a machine", key=key, value=frequency, allowed=allowed)
    return 2 * np.pi * found
