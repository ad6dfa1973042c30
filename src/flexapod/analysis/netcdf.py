"""A Dataset as a NetCDF 4 file, as xarray writes and reads it, but without dask: its import takes a second."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from flexapod.common.arrays import Array

if TYPE_CHECKING:
    import netCDF4
    from xarray import Dataset, Variable

ENCODING = "utf-8"


def write(data: Dataset, path: Path, **attributes: object) -> None:
    """Write a Dataset of numbers, truth values and texts, every array with checksums; `attributes` are added.

    Raises
    ------
    OSError, RuntimeError
        The file cannot be written.
    """
    from netCDF4 import Dataset as File

    with File(path, "w", format="NETCDF4") as file:
        for name, size in data.sizes.items():
            file.createDimension(str(name), size)
        for name, array in data.variables.items():
            _variable(file, str(name), array, _further(data, str(name)))
        file.setncatts({name: _plain(value) for name, value in {**data.attrs, **attributes}.items()})


def _further(data: Dataset, name: str) -> dict[str, str]:
    """The coordinates of an array that are not labels of its dimensions, as the CF conventions name them."""
    own = data.variables[name]
    labels = [str(c) for c in data.coords if c not in data.sizes and set(data[c].dims) <= set(own.dims)]
    return {"coordinates": " ".join(labels)} if labels and name in data.data_vars else {}


def _variable(file: netCDF4.Dataset, name: str, array: Variable, further: dict[str, str]) -> None:
    values, dims, attrs = np.asarray(array.values), tuple(str(dim) for dim in array.dims), array.attrs | further
    if values.dtype.kind in "UOT":  # texts of letters
        values, attrs = _letters(values), attrs | {"_Encoding": ENCODING}
        width = f"string{values.shape[-1]}"
        if width not in file.dimensions:
            file.createDimension(width, values.shape[-1])
        dims = (*dims, width)
    elif values.dtype.kind == "b":
        values, attrs = values.astype("i1"), attrs | {"dtype": "bool"}
    fill = np.nan if values.dtype.kind == "f" else None
    made = file.createVariable(name, values.dtype, dims, fletcher32=bool(dims and values.size), fill_value=fill)
    made.set_auto_maskandscale(False)
    made.set_auto_chartostring(False)
    made.setncatts({key: _plain(value) for key, value in attrs.items()})
    made[...] = values


def _letters(texts: Array) -> Array:
    """Texts as arrays of their bytes, in one dimension more."""
    packed = np.char.encode(texts.astype(str), ENCODING)
    size = max(packed.dtype.itemsize, 1)
    return packed.astype(f"S{size}").reshape(*texts.shape, 1).view("S1").reshape(*texts.shape, size)


def _plain(value: object) -> object:
    """What an attribute can hold: texts, numbers and rows of them."""
    return int(value) if isinstance(value, bool | np.bool_) else value
