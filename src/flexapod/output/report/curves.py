"""Curves as a page reads them: no more points than can be seen, packed; without matplotlib."""

from __future__ import annotations

import base64

import numpy as np

from flexapod.common.arrays import Array

__all__ = ["MOST_POINTS", "packed", "thinned"]

MOST_POINTS = 1500  # of a curve: more than a page is wide


def packed(values: Array) -> dict[str, str]:
    """Numbers as plotly reads them: base64 of 32 bit floats, seven digits."""
    flat = np.ascontiguousarray(values, dtype="<f4")
    made = {"dtype": "f4", "bdata": base64.b64encode(flat.tobytes()).decode("ascii")}
    return made | ({"shape": ", ".join(map(str, flat.shape))} if flat.ndim > 1 else {})


def thinned(x: Array, y: Array, most: int = MOST_POINTS) -> tuple[Array, Array]:
    """A curve (n,), (n,) of at most about `most` points: both ends, least and largest of each interval between."""
    if len(x) <= most:
        return x, y
    edges = np.linspace(0, len(x), most // 2 + 1).astype(int)
    begins, interval = edges[:-1], np.repeat(np.arange(len(edges) - 1), np.diff(edges))
    keep = [np.array([0, len(x) - 1])]
    for extreme, none in ((np.minimum, np.inf), (np.maximum, -np.inf)):
        known = np.where(np.isfinite(y), y, none)
        hit = np.flatnonzero(known == extreme.reduceat(known, begins)[interval])
        keep.append(hit[np.searchsorted(hit, begins)])  # the first of each interval
    chosen = np.unique(np.concatenate(keep))
    return x[chosen], y[chosen]
