"""Shared type names. Shapes and units of arrays are stated in the docstrings."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""A float64 array; SI units."""

Mask = NDArray[np.bool_]
"""A Boolean array."""

Index = NDArray[np.intp]
"""Places in another array."""

Complex = NDArray[np.complex128]
"""A complex array."""


def floats(value: object) -> Array:
    """A new array of real numbers of whatever holds some.

    Raises
    ------
    ValueError
        Complex numbers, whose imaginary parts NumPy leaves out; numbers beyond floats; dates; lists that are no array.
    """
    try:
        found = np.asarray(value)
        if found.dtype.kind == "c" and not np.imag(found).any():
            found = np.real(found)
        if found.dtype.kind not in "biufOUS":
            raise ValueError
        return np.array(found, dtype=np.float64)
    except (TypeError, ValueError, OverflowError, RecursionError):
        raise ValueError("are no real numbers") from None
