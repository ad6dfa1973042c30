"""The first of the largest and of the least: among equals the number decides, not the last bits of a processor."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeVar

import numpy as np

from flexapod.typing import Array

__all__ = ["alike", "first_largest", "first_least", "most"]

T = TypeVar("T")
SAME = 1e-9
"""Values that differ by less, of the largest size among them, are the same: rounding of 1e-16, made worse a million
times, is 1e-10, and nobody reads nine digits."""


def alike(values: Array, axis: int | None = None) -> Array:
    """Which values are the largest along an axis, or of all; what is not a number is none of them."""
    size = np.where(np.isfinite(values), np.abs(values), 0.0).max(axis=axis, keepdims=True, initial=0.0)
    known = np.where(np.isnan(values), -np.inf, values)
    return known >= known.max(axis=axis, keepdims=True) - SAME * size


def first_largest(values: Array, axis: int | None = None) -> Array:
    """Place of the first of the largest values along an axis, or of all in their order: `argmax`, but for rounding."""
    return alike(np.asarray(values, float), axis).argmax(axis=axis)


def first_least(values: Array, axis: int | None = None) -> Array:
    """Place of the first of the least values along an axis, or of all in their order."""
    return first_largest(-np.asarray(values, float), axis)


def most(items: Iterable[T], key: Callable[[T], float]) -> T:
    """The first of those items whose `key` is largest; as `max`, but for rounding."""
    found = list(items)
    return found[int(first_largest(np.array([key(item) for item in found])))]
