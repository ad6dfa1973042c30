"""Legs as bodies: their rotation at the joints and the gaps between them, Eqs. (T2.47)-(T2.48)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from flexapod.common.arrays import Array, Index, Mask
from flexapod.kinematics.rotations import blocks, dot

HALVES = (0, 0, 1, 1), (0, 1, 0, 1)  # of two legs: cylinder (0) or piston (1)
SPAN = 32  # poses between which legs that follow a path move little
ROUNDING = 1e-9  # of distances [m], far above what it is: of pairs that differ by less the first one is the nearest


class Nearest(NamedTuple):
    """Least gap between two legs at T instants [m], negative where they overlap; numbers of the two from 0, (T, 2)."""

    gap: Array
    legs: NDArray[np.intp]


def turned_by(axes: Array, rotation: Array, home: Array, home_rotation: Array) -> Array:
    """Angles by which legs have turned at base and platform joint since home, (T, n, 2) [rad], Eq. (T2.47).

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
    """Least gap among some pairs of legs at each instant, and the two legs that have it, Eq. (T2.48).

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
    count, width = feet.shape[1], radii.T.ravel()
    one, other = ((pairs[:, k, None] + count * np.array(half)).ravel() for k, half in enumerate(HALVES))
    for where in blocks(len(feet)):
        a, b = _bodies(feet[where], tips[where], mouth)
        span, body = np.nonzero(_may_be_nearest(a, b, width, one, other).T)
        i, k = one[body], other[body]
        gap = _apart(a[:, i, span], b[:, i, span], a[:, k, span], b[:, k, span]) - (width[i] + width[k])[:, None]
        firsts = np.searchsorted(span, np.arange(a.shape[2]))
        least = np.minimum.reduceat(gap, firsts)
        pair = np.where(gap > least[span] + ROUNDING, len(pairs), body[:, None] // len(HALVES[0]))
        size = len(found.gap[where])
        found.gap[where] = least.ravel()[:size]
        found.legs[where] = pairs[np.minimum.reduceat(pair, firsts).ravel()[:size]]
    return found


def _bodies(feet: Array, tips: Array, mouth: Array) -> tuple[Array, Array]:
    """Begins and ends of the axes of cylinders, then of pistons, (3, 2 n, spans, `SPAN`); the last pose is repeated."""
    more = ((0, 0), (0, 0), (0, -len(feet) % SPAN))
    start, end = (np.pad(np.moveaxis(x, (0, 1, 2), (2, 1, 0)), more, mode="edge") for x in (feet, tips))
    share = mouth[:, None] / np.sqrt(((end - start) ** 2).sum(axis=0))
    middle = start + share * (end - start)
    a, b = (np.concatenate(pair, axis=1) for pair in ((start, middle), (middle, end)))
    return a.reshape(*a.shape[:2], -1, SPAN), b.reshape(*b.shape[:2], -1, SPAN)


def _may_be_nearest(a: Array, b: Array, width: Array, one: Index, other: Index) -> Mask:
    """Pairs that may be nearest in a span, (m, spans): a gap changes at most by what its bodies move."""
    begins, ends = a[..., SPAN // 2], b[..., SPAN // 2]
    way = np.maximum(*(((x - x[..., SPAN // 2, None]) ** 2).sum(axis=0).max(axis=-1) for x in (a, b)))
    moved = np.sqrt(way)[one] + np.sqrt(way)[other]
    gap = _apart(begins[:, one], ends[:, one], begins[:, other], ends[:, other]) - (width[one] + width[other])[:, None]
    return ~(gap - moved > (gap + moved).min(axis=0) + ROUNDING)


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
