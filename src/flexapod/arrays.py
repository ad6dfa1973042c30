"""Shared type names. Shapes and units of arrays are stated in the docstrings."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["Array", "Mask"]

Array = NDArray[np.float64]
"""A float64 array; SI units."""

Mask = NDArray[np.bool_]
"""A Boolean array."""
