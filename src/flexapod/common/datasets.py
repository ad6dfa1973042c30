"""Datasets of variables and labels, also of arrays that nobody has asked for yet."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike
from xarray import DataArray, Dataset, Variable
from xarray.core.indexing import LazilyIndexedArray, NumpyIndexingAdapter
from xarray.indexes import Index, PandasIndex

from flexapod.common.arrays import Array


def variable(dims: str | tuple[str, ...], given: ArrayLike, attrs: Mapping[str, object] | None = None) -> Variable:
    """Variable of numbers or texts; xarray's own conversion would first import dask, a quarter of a second."""
    array = np.asarray(given)
    return Variable(dims, array, dict(attrs or {}), fastpath=array.dtype.kind in "biufcUO")


def lazy_variable(
    values: Mapping[str, Array], name: str, sizes: Mapping[str, int], dtype: type, attrs: dict[str, str]
) -> Variable:
    """Variable that asks some values for its array when it is read; `sizes` by dimension."""
    array = LazilyIndexedArray(_Awaited(values, name, tuple(sizes.values()), dtype))
    return Variable(tuple(sizes), array, attrs, fastpath=True)


class _Awaited(NumpyIndexingAdapter):
    """Array of known shape, as xarray's own around one; it is made when it is read, written, copied or sent."""

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


def build_dataset(
    data: Mapping[Any, Any], coords: Mapping[Any, Any] | None = None, attrs: Mapping[Any, Any] | None = None
) -> Dataset:
    """Make what `xarray.Dataset` makes of the same, without what it imports first: dask, a quarter of a second.

    Parameters
    ----------
    data, coords : mapping
        Variables, arrays of xarray (without their labels), or (dims, values, attributes) by name; labels of a
        dimension also as they are.
    attrs : mapping, optional

    Raises
    ------
    ValueError
        A dimension has several lengths.
    """
    variables = {name: _read(name, given) for name, given in {**data, **(coords or {})}.items()}
    indexes: dict[Any, Index] = {
        name: _index(name, variables[name].values) for name in coords or {} if variables[name].dims == (name,)
    }
    for name, index in indexes.items():
        variables[name] = index.create_variables({name: variables[name]})[name]
    return Dataset._construct_direct(variables, set(coords or {}), attrs=dict(attrs or {}), indexes=indexes)


def _read(name: str, given: Any) -> Variable:
    if isinstance(given, DataArray | Variable):  # with attributes of its own, as what xarray makes
        return (given.variable if isinstance(given, DataArray) else given).copy(deep=False)
    return variable(*given) if isinstance(given, tuple) else variable(name, given)


_of_words = lru_cache(maxsize=64)(_index)


def assemble_dataset(
    data: Mapping[str, Variable], labels: Mapping[str, tuple[object, dict[str, str]]], attrs: Mapping[str, object]
) -> Dataset:
    """Dataset of variables, and of coordinates from labels and attributes by dimension.

    Put together of its parts: of arrays xarray would first import pint and others, and what is one already it would
    compare and merge, which takes longer than all else in a Dataset.
    """
    variables, indexes = dict(data), {}
    for dim, (given, words) in labels.items():
        indexes[dim] = index = _of_words(dim, tuple(given)) if isinstance(given, list) else _index(dim, given)
        variables[dim] = index.create_variables()[dim]
        variables[dim].attrs = words
    return Dataset._construct_direct(variables, set(labels), attrs=dict(attrs), indexes=indexes)
