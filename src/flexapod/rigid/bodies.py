"""Legs as bodies: how far they turn at their joints, how near to each other they come, Eqs. (T2.47)-(T2.48)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from flexapod.rigid.vectors import blocks, dot
from flexapod.typing import Array

__all__ = ["Nearest", "nearest_legs", "turned_by"]


class Nearest(NamedTuple):
    """Least gap between two legs at T instants [m], negative where they overlap; numbers of the two from 0, (T, 2)."""

    gap: Array
    legs: NDArray[np.intp]


def turned_by(axes: Array, rotation: Array, home: Array, home_rotation: Array) -> Array:
    """How far legs have turned at base and platform joint since home, (T, n, 2) [rad], Eq. (T2.47).

    Parameters
    ----------
    axes : ndarray, shape (T, n, 3)
        Unit vectors along the legs, world axes.
    rotation : ndarray, shape (T, 3, 3)
        Of the platform.
    home, home_rotation : ndarray, shape (n, 3), (3, 3)
        The same at home.
    """
    seen = np.einsum("tji,tlj->tli", rotation, axes)  # from the platform
    return np.stack([_angle(axes, home), _angle(seen, home @ home_rotation)], axis=-1)


def _angle(a: Array, b: Array) -> Array:
    """Angles between unit vectors (T, n, 3) and (n, 3); exact for small ones, too."""
    across = np.linalg.norm(np.cross(a, b), axis=-1)
    return np.arctan2(across, (a * b).sum(axis=-1))


def nearest_legs(feet: Array, tips: Array, mouth: Array, radii: Array, pairs: Array) -> Nearest:
    """Which two of some pairs of legs come nearest to each other, and how near, Eq. (T2.48).

    A leg is a cylinder to its mouth and a piston from there on, each with round ends.

    Parameters
    ----------
    feet, tips : ndarray, shape (T, n, 3)
        Of the legs [m].
    mouth : ndarray, shape (n,)
        From the foot [m].
    radii : ndarray, shape (n, 2)
        Of cylinders and pistons [m].
    pairs : ndarray, shape (m, 2)
        Numbers of the legs, m >= 1.
    """
    found = Nearest(np.empty(len(feet)), np.empty((len(feet), 2), dtype=int))
    one, other = pairs.T
    for where in blocks(len(feet)):
        start, end = (np.moveaxis(x[where], (0, 1, 2), (2, 1, 0)) for x in (feet, tips))  # (3, n, T)
        share = mouth[:, None] / np.sqrt(((end - start) ** 2).sum(axis=0))
        middle = start + share * (end - start)
        bodies = ((start, middle), (middle, end))
        gaps = [
            _apart(a[0][:, one], a[1][:, one], b[0][:, other], b[1][:, other])
            - (radii[one, i] + radii[other, k])[:, None]
            for i, a in enumerate(bodies)
            for k, b in enumerate(bodies)
        ]
        gap = np.min(gaps, axis=0)
        least = gap.argmin(axis=0)
        found.gap[where] = gap[least, np.arange(gap.shape[1])]
        found.legs[where] = pairs[least]
    return found


def _apart(a: Array, b: Array, c: Array, d: Array) -> Array:
    """Least distance of the lines from a to b and from c to d, vectors (3, ...), (...)."""
    u, v, w = b - a, d - c, a - c
    uu, vv, uv, uw, vw = dot(u, u), dot(v, v), dot(u, v), dot(u, w), dot(v, w)
    tiny = np.finfo(float).tiny
    s = np.clip((uv * vw - uw * vv) / np.maximum(uu * vv - uv**2, tiny), 0.0, 1.0)
    t = np.clip((uv * s + vw) / np.maximum(vv, tiny), 0.0, 1.0)
    s = np.clip((uv * t - uw) / np.maximum(uu, tiny), 0.0, 1.0)  # of where the other line ends
    between = w + s * u - t * v
    return np.sqrt(dot(between, between))
