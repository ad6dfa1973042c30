"""Vectors of many legs and poses with the component first and time last: whole arrays without a short last axis.

A vector here is a sequence of three arrays of equal shape, mostly (n legs, T poses): NumPy then runs along time. The
functions of this package take and return arrays with time first; only their inner part is turned round, in blocks
of poses that stay in the cache.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from flexapod.common.arrays import Array

Vector = Sequence[Array] | Array

BLOCK = 1024  # poses; an array of six legs then takes 48 kB, and what a block needs fits the second-level cache


def blocks(count: int) -> Iterator[slice]:
    """Ranges of at most `BLOCK` out of `count` poses; of no poses one, which is empty."""
    return (slice(first, min(first + BLOCK, count)) for first in range(0, max(count, 1), BLOCK))


def time_last(array: Array) -> Array:
    """Contiguous copy of (T, ...) with the first axis last."""
    return np.ascontiguousarray(array.transpose(*range(1, array.ndim), 0))


def time_first(vector: Vector) -> Array:
    """Contiguous array (T, n, 3) of a vector of arrays (n, T)."""
    first = vector[0]
    out = np.empty((*first.shape[::-1], len(vector)))
    for k, component in enumerate(vector):
        out[..., k] = component.T
    return out


def cross(a: Vector, b: Vector) -> tuple[Array, Array, Array]:
    """Cross product, component by component."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def dot(a: Vector, b: Vector) -> Array:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def turned(matrix: Array, vector: Vector) -> tuple[Array, Array, Array]:
    """Matrix times vector; `matrix` (3, 3, ...) broadcasts against the vector's components."""
    return dot(matrix[0], vector), dot(matrix[1], vector), dot(matrix[2], vector)
