"""Curves that swing more often than a picture can show, as the band that they fill."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from scipy.ndimage import maximum_filter1d

__all__ = ["MOST", "is_quick", "swings", "vibration_line"]

MOST = 240  # half swings across a page: more of them are solid ink
SEEN = 0.02  # of the range of a curve: a smaller swing is the width of its line
NEIGHBOURS = 5  # maxima of which the largest is the edge: where several vibrations add up, not each reaches it
EDGE = 600  # instants of a band at most; each stands for those up to the next


def swings(values: np.ndarray) -> np.ndarray:
    """Where a curve turns back: places of its maxima and minima."""
    return np.flatnonzero(np.diff(np.sign(np.diff(values))) != 0) + 1


def is_quick(values: np.ndarray, most: float = MOST) -> bool:
    """Whether a curve swings more often than a panel can show; swings that nobody sees do not count."""
    return bool(np.count_nonzero(np.abs(np.diff(values[swings(values)])) > SEEN * np.ptp(values)) > most)


def vibration_line(axes: Axes, time: np.ndarray, values: np.ndarray, most: float = MOST, **style: Any) -> bool:
    """Draw a curve, or between its maxima and its minima the band that it fills where it turns back more often.

    Parameters
    ----------
    axes : Axes
    time, values : array, shape (n,)
    most : float
        Half swings that the panel can show, as of `is_quick`.
    style
        Color, linewidth and label of the curve, as of `Axes.plot`.

    Returns
    -------
    bool
        Whether it is a band.
    """
    if not is_quick(values, most):
        axes.plot(time, values, **style)
        return False
    at = swings(values)
    middle = 0.5 * (values[at[:-1]] + values[at[1:]])
    middle = np.interp(time, 0.5 * (time[at[:-1]] + time[at[1:]]), middle)
    low, high = (sign * _edge(time, sign * values, at[sign * (values[at] - middle[at]) >= 0]) for sign in (-1.0, 1.0))
    first = np.unique(np.linspace(0, len(time) - 1, EDGE).astype(int))
    time, low, high = time[first], np.minimum.reduceat(low, first), np.maximum.reduceat(high, first)
    axes.fill_between(time, low, high, color=style["color"], alpha=0.25, linewidth=0)
    edge: dict[str, Any] = style | {"linewidth": 0.8}
    axes.plot(time, low, **edge)
    edge["label"] = None
    axes.plot(time, high, **edge)
    return True


def _edge(time: np.ndarray, values: np.ndarray, maxima: np.ndarray) -> np.ndarray:
    """Upper edge of what a curve fills, through the largest of neighbouring maxima."""
    return np.interp(time, time[maxima], maximum_filter1d(values[maxima], NEIGHBOURS, mode="nearest"))
