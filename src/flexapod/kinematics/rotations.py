"""Rotations as matrices, unit quaternions and rotation vectors, and vectors with time last, in NumPy alone.

Quaternions are w x y z, platform to world. SciPy's class of the same purpose takes a tenth of the time in which
a whole simulation starts and ends.

A vector with time last is a sequence of three arrays of equal shape, mostly (n legs, T poses): NumPy then runs
along time. The functions of this package take and return arrays with time first; only their inner part is
turned round, in blocks of poses that stay in the cache.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from flexapod.common.arrays import Array


def canonical(e: Array) -> Array:
    """Unit quaternions (..., 4) of the same rotations with w >= 0."""
    return np.copysign(1 / _size(e), e[..., :1]) * e


def _size(vectors: Array) -> Array:
    """Norms (..., 1) of vectors (..., k)."""
    return np.sqrt(np.add.reduce(vectors * vectors, axis=-1, keepdims=True))


def _parts(vectors: Array) -> tuple[Array, ...]:
    """Components (...) of vectors (..., k)."""
    return tuple(vectors[..., k] for k in range(vectors.shape[-1]))


def matrix(e: Array) -> Array:
    """Rotation matrices (..., 3, 3) of quaternions (..., 4), brought to unit length, Eq. (T4.1)."""
    w, x, y, z = _parts(e / _size(e))
    R = np.empty((*np.shape(w), 3, 3))
    R[..., 0, 0], R[..., 0, 1], R[..., 0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    R[..., 1, 0], R[..., 1, 1], R[..., 1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    R[..., 2, 0], R[..., 2, 1], R[..., 2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
    return R


def quaternion(R: Array) -> Array:
    """Unit quaternions (..., 4) with w >= 0 of rotation matrices (..., 3, 3), Eq. (T4.1) backwards.

    The products 4 e e^T are linear in R; of their four rows, each a multiple of e, the one with the largest diagonal
    entry (at least 1) loses no digits.
    """
    xx, yy, zz = R[..., 0, 0], R[..., 1, 1], R[..., 2, 2]
    wx, wy, wz = R[..., 2, 1] - R[..., 1, 2], R[..., 0, 2] - R[..., 2, 0], R[..., 1, 0] - R[..., 0, 1]
    xy, xz, yz = R[..., 0, 1] + R[..., 1, 0], R[..., 0, 2] + R[..., 2, 0], R[..., 1, 2] + R[..., 2, 1]
    rows = (
        (1 + xx + yy + zz, wx, wy, wz),
        (wx, 1 + xx - yy - zz, xy, xz),
        (wy, xy, 1 - xx + yy - zz, yz),
        (wz, xz, yz, 1 - xx - yy + zz),
    )
    products = np.empty((*R.shape[:-2], 4, 4))
    for i, row in enumerate(rows):
        for j, x in enumerate(row):
            products[..., i, j] = x
    largest = np.argmax(np.diagonal(products, axis1=-2, axis2=-1), axis=-1)
    return canonical(np.take_along_axis(products, largest[..., None, None], axis=-2)[..., 0, :])


def product(a: Array, b: Array) -> Array:
    """Quaternions (..., 4) of the rotation b followed by the rotation a."""
    (w, x, y, z), (s, i, j, k) = _parts(a), _parts(b)
    e = np.empty(np.broadcast_shapes(a.shape, b.shape))
    e[..., 0] = w * s - x * i - y * j - z * k
    e[..., 1] = w * i + x * s + y * k - z * j
    e[..., 2] = w * j - x * k + y * s + z * i
    e[..., 3] = w * k + x * j - y * i + z * s
    return e


def difference(a: Array, b: Array) -> Array:
    """Rotation vectors (..., 3) [rad] of what turns b into a, both quaternions (..., 4), in the fixed frame."""
    return rotation_vector(product(a, b * np.array([1.0, -1.0, -1.0, -1.0])))


def rotation_vector(e: Array) -> Array:
    """Rotation vectors (..., 3) [rad], at most pi long, of quaternions (..., 4): Eq. (T6.2) backwards."""
    e = canonical(e)
    sine = _size(e[..., 1:])
    angle = 2 * np.arctan2(sine, e[..., :1])
    return np.divide(angle, sine, out=np.full_like(sine, 2.0), where=sine > 0) * e[..., 1:]


def exponential(turn: Array) -> Array:
    """Rotation matrices of rotation vectors (..., 3) [rad], shape (..., 3, 3), Eq. (T2.40)."""
    angle = np.linalg.norm(turn, axis=-1)[..., None, None]
    x, y, z = _parts(turn)
    zero = np.zeros_like(x)
    k = np.stack([np.stack(r, axis=-1) for r in ([zero, -z, y], [z, zero, -x], [-y, x, zero])], axis=-2)
    half = np.sinc(angle / (2 * np.pi))  # sin(angle / 2) / (angle / 2)
    return np.eye(3) + np.sinc(angle / np.pi) * k + half**2 / 2 * (k @ k)


def carried_twists(arms: Array) -> Array:
    """Matrices (..., 6, 6) from a twist of a body to that of its points `arms` (..., 3) away."""
    found = np.zeros((*arms.shape[:-1], 6, 6))
    found[..., :, :] = np.eye(6)
    found[..., :3, 3:] = np.cross(np.eye(3), arms[..., None], axis=-2)
    return found


def displace_pose(pose: Array, step: Array) -> Array:
    """Poses (..., 7) moved by steps (..., 6): x + dx, R exp(theta^), Eqs. (T4.3) and (T6.2)."""
    half = 0.5 * _size(step[..., 3:])
    turn = np.concatenate([np.cos(half), 0.5 * np.sinc(half / np.pi) * step[..., 3:]], axis=-1)
    e = product(pose[..., 3:], turn)
    e /= _size(e)
    return np.concatenate([pose[..., :3] + step[..., :3], e], axis=-1)


Vector = Sequence[Array] | Array

BLOCK = 1024  # poses; an array of six legs then takes 48 kB, and what a block needs fits the second-level cache


def blocks(count: int, size: int = BLOCK) -> Iterator[slice]:
    """Ranges of at most `size` out of `count` poses; of no poses one, which is empty."""
    return (slice(first, min(first + size, count)) for first in range(0, max(count, 1), size))


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


def rotate_vector(matrix: Array, vector: Vector) -> tuple[Array, Array, Array]:
    """Matrix times vector; `matrix` (3, 3, ...) broadcasts against the vector's components."""
    return dot(matrix[0], vector), dot(matrix[1], vector), dot(matrix[2], vector)
