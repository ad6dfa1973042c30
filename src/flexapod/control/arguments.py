"""Numbers that calls are given, as arrays: what is none is refused in words."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from flexapod.arrays import Array
from flexapod.errors import InputError

__all__ = ["frequencies", "numbers"]


def numbers(given: ArrayLike, key: str, allowed: str) -> Array:
    """Finite numbers, one or several, (n,).

    Raises
    ------
    InputError
        Something else, or in rows and columns.
    """
    try:
        found = np.atleast_1d(np.asarray(given, dtype=float))
    except (TypeError, ValueError):
        found = np.full(1, np.nan)
    if found.ndim != 1 or not np.isfinite(found).all():
        raise InputError("are no finite numbers in a row", key=key, value=given, allowed=allowed)
    return found


def frequencies(hz: ArrayLike) -> Array:
    """Frequencies [Hz], (f,)."""
    return numbers(hz, "hz", "frequencies [Hz], for example numpy.geomspace(1, 1000, 400)")
