"""Play of a leg as a gap in the springs before its piston, Eqs. (T16.26)-(T16.27). Numbers and symbols alike."""

from typing import Any, TypeVar

ROUNDED = 0.2  # width over half of the play within which the gap's edges are rounded
LEAST = 1e-9  # m, of a leg without play

T = TypeVar("T")


def past_gap(x: T, half: Any) -> T:
    """How far a displacement x is past the edges of a gap that is `half` wide on either side."""
    rounding = (ROUNDED * half) ** 2 + LEAST**2  # type: ignore[operator]
    return x - 0.5 * (((x + half) ** 2 + rounding) ** 0.5 - ((x - half) ** 2 + rounding) ** 0.5)  # type: ignore[operator]


def touching(x: T, half: Any) -> T:
    """Its derivative by x: 0 within the gap, 1 past it, Eq. (T16.27)."""
    rounding = (ROUNDED * half) ** 2 + LEAST**2  # type: ignore[operator]
    right, left = x + half, x - half  # type: ignore[operator]
    return 1 - 0.5 * (right / (right**2 + rounding) ** 0.5 - left / (left**2 + rounding) ** 0.5)
