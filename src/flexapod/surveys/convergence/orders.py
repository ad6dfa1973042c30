"""Orders and rates of convergence, and the error of the finest result, Eqs. (T12.1)-(T12.4)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from flexapod.typing import Array

HIGHEST = 40.0  # orders beyond it are not orders


def relative_difference(values: Array, reference: Array) -> float:
    """Largest distance between two curves over the largest size of the reference, Eq. (T12.1); NaN if that is 0.

    Parameters
    ----------
    values, reference : ndarray, shape (T, ..., component)
        The last axis holds the components of a vector.
    """
    largest = float(np.linalg.norm(reference, axis=-1).max(initial=0.0))
    gap = float(np.linalg.norm(values - reference, axis=-1).max(initial=0.0))
    return gap / largest if largest > 0 else float("nan")  # (T12.1)


def observed_order(sizes: tuple[float, float, float], errors: tuple[float, float]) -> float:
    """Order p of two results and the finest, from the differences of the two to the finest, Eq. (T12.2).

    Parameters
    ----------
    sizes : (coarse, fine, finest)
        Steps, or lengths of elements; only their ratios count.
    errors : (coarse, fine)
        Differences to the finest.

    Returns
    -------
    float
        NaN where the error does not fall, or faster than any order up to 40.

    References
    ----------
    I. Celik et al., Procedure for estimation and reporting of uncertainty due to discretization in CFD applications,
    Journal of Fluids Engineering 130 (2008) 078001, doi:10.1115/1.2960953.
    """
    a, b = np.log(sizes[0] / sizes[2]), np.log(sizes[1] / sizes[2])
    if not (a > b > 0 and errors[0] > errors[1] > 0):
        return float("nan")
    target = errors[0] / errors[1]

    def ratio(p: float) -> float:
        return float(np.expm1(p * a) / np.expm1(p * b)) if p else float(a / b)  # (T12.2)  rises with p

    low, high = 0.0, HIGHEST
    if not ratio(low) < target < ratio(high):
        return float("nan")
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if ratio(middle) < target else (low, middle)
    return low


def finest_error(size: float, finest: float, error: float, order: float) -> float:
    """Error of the finest result itself, Eq. (T12.3), from a coarser one's difference to it.

    Without a known order (NaN), or one below 1, the difference itself.
    """
    if not order >= 1:
        return error
    return error / float(np.expm1(order * np.log(size / finest)))  # (T12.3)


def shape_factor(counts: Sequence[int], errors: Sequence[float]) -> float | None:
    """What each shape more divides the error by, where that describes it better than a power of the count, Eq. (T12.4).

    Parameters
    ----------
    counts, errors : sequences
        At least three numbers of shapes, with errors above the rounding floor.

    Returns
    -------
    float or None
        None where a power fits better, or with fewer than three.
    """
    if len(counts) < 3:
        return None
    k, y = np.asarray(counts, dtype=float), np.log(np.asarray(errors, dtype=float))
    slope, misfit = _line(k, y)
    return float(np.exp(-slope)) if slope < 0 and misfit < _line(np.log(k), y)[1] else None  # (T12.4)


def _line(x: Array, y: Array) -> tuple[float, float]:
    """Slope and sum of squared residuals of the straight line through points."""
    x, y = x - x.mean(), y - y.mean()
    slope = float(x @ y / (x @ x))
    return slope, float(np.square(y - slope * x).sum())
