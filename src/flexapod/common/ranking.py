"""The first of the largest and of the least: among equals the number decides, not the last bits of a processor."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from flexapod.common.arrays import Array, Mask

T = TypeVar("T")
ROUNDING = 1e-12
"""Values that differ by less, of the largest size among them, are the same: some thousand roundings. It is no wider,
since at instants next to that of a smooth maximum values differ by 1e-10 of it."""
EQUALS = 1e-9
"""The same for legs, parts and directions, which are few: results of simulations are symmetric to 1e-10."""


def is_largest(values: Array, axis: int | None = None, same: float = ROUNDING) -> Mask:
    """Mark the values that are the largest along an axis, or of all; what is not a number is none of them."""
    largest, least = (extreme(axis=axis, keepdims=True) for extreme in (values.max, values.min))
    if np.isfinite(largest).all() and np.isfinite(least).all():
        return values >= largest - same * np.maximum(largest, -least)
    known = np.where(np.isnan(values), -np.inf, values)
    return known >= known.max(axis=axis, keepdims=True) - same * _size(values, axis)


def _size(values: Array, axis: int | None = None) -> Array:
    return np.where(np.isfinite(values), np.abs(values), 0.0).max(axis=axis, keepdims=True, initial=0.0)


def first_largest(values: Array, same: float = ROUNDING) -> int:
    """Place of the first of the largest of all values, in their order; `argmax`, but for rounding."""
    return int(is_largest(np.asarray(values, float), same=same).argmax())


def first_least(values: Array, same: float = ROUNDING) -> int:
    """Place of the first of the least of all values, in their order; `argmin`, but for rounding."""
    return first_largest(-np.asarray(values, float), same)


def descending_order(values: Array) -> NDArray[np.intp]:
    """Places of values (n,) from the largest to the least; those of equals in their order."""
    order = np.argsort(-values, kind="stable")
    falling = values[order]
    lower = falling[:-1] > falling[1:] + EQUALS * _size(values)
    return order[np.lexsort((order, np.append(0 * order[:1], lower).cumsum()))]


def largest_item(items: Iterable[T], key: Callable[[T], float]) -> T:
    """The first of those items whose `key` is largest; `max`, but for rounding."""
    found = list(items)
    return found[first_largest(np.array([key(item) for item in found]), EQUALS)]
