"""Variables and coordinates of a Dataset, also of arrays that nobody has asked for yet."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from xarray import Coordinates, Variable
from xarray.core.indexing import LazilyIndexedArray, NumpyIndexingAdapter
from xarray.indexes import PandasIndex

from flexapod.arrays import Array

__all__ = ["awaited", "coordinates", "variable"]


def variable(dims: tuple[str, ...], given: ArrayLike, attrs: dict[str, str]) -> Variable:
    """Variable of plain numbers or texts; xarray's own conversion would first import dask, a quarter of a second."""
    array = np.asarray(given)
    return Variable(dims, array, attrs, fastpath=array.dtype.kind in "biufU")


def awaited(
    values: Mapping[str, Array], name: str, sizes: Mapping[str, int], dtype: type, attrs: dict[str, str]
) -> Variable:
    """Variable that asks some values for its array when it is read; `sizes` by dimension."""
    array = LazilyIndexedArray(_Awaited(values, name, tuple(sizes.values()), dtype))
    return Variable(tuple(sizes), array, attrs, fastpath=True)


class _Awaited(NumpyIndexingAdapter):
    """As xarray's own around an array, of known shape; the array is made when it is read, written, copied or sent."""

    __slots__ = ("_dtype", "_name", "_shape", "_values")

    def __init__(self, values: Mapping[str, Array], name: str, shape: tuple[int, ...], dtype: type) -> None:
        self._values, self._name, self._shape, self._dtype = values, name, shape, np.dtype(dtype)

    @property
    def array(self) -> Array:
        return self._values[self._name]

    @property
    def shape(self) -> tuple[int, ...]:
        return self._shape

    @property
    def dtype(self) -> np.dtype:
        return self._dtype

    def __reduce__(self) -> tuple[type, tuple[Array]]:
        return NumpyIndexingAdapter, (self.array,)


def _index(dim: str, given: object) -> PandasIndex:
    array = np.asarray(given)
    return PandasIndex(pd.Index(array), dim, coord_dtype=array.dtype)


_of_words = lru_cache(maxsize=64)(_index)


def coordinates(labels: Mapping[str, tuple[object, dict[str, str]]]) -> Coordinates:
    """Indexed coordinates from labels and attributes; made from arrays, xarray would first import pint and others."""
    variables, indexes = {}, {}
    for dim, (given, attrs) in labels.items():
        index = _of_words(dim, tuple(given)) if isinstance(given, list) else _index(dim, given)
        variables[dim] = index.create_variables()[dim]
        variables[dim].attrs = dict(attrs)
        indexes[dim] = index
    return Coordinates(variables, indexes)
