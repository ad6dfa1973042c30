"""Results as NetCDF and CSV files, written whole or not at all.

NetCDF 4 is written and read as xarray does, but without dask, whose import takes a second.
"""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Callable
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from flexapod.analysis.checks.resource_limits import available_memory
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.common.files import check_regular, path_of, replace_file

if TYPE_CHECKING:
    import netCDF4
    from xarray import DataArray, Dataset, Variable

T = TypeVar("T")
BLOCK = 1 << 20
AGAIN = "Make it again with `flexapod run FILE`"
NUMBER = 8  # bytes of a number in memory
SUM = "checksum_of_attributes"
ANY_FILE = 100e6
"""What any file may unpack to [bytes]."""
MOST_PACKED = 50
"""How many times its own size a larger one may unpack to; results are stored as they are, zeros pack a thousandfold."""


def save(data: Dataset, path: str | Path) -> Path:
    """Write a Dataset to a NetCDF 4 file, every variable with checksums; an existing file is replaced by the whole one.

    Raises
    ------
    InputError
        The folder cannot be written to, or the disk is full.
    """
    path = path_of(path, "path")
    if not hasattr(data, "data_vars"):
        raise InputError(f"is no Dataset but a {type(data).__name__}", key="data", allowed="a result")
    with replace_file(path) as temporary:
        try:
            write(data, temporary, **{SUM: _sum(data)})
        except RuntimeError as error:
            _fill(temporary, data.nbytes)
            raise OSError(f"the NetCDF library says {error}") from None
    return path


def _fill(path: Path, size: int) -> None:
    """Write as many zeros: the system says why a file cannot be written, the NetCDF library does not."""
    with path.open("wb") as file:
        for begin in range(0, size, BLOCK):
            file.write(bytes(min(BLOCK, size - begin)))


def open_results(path: str | Path) -> Dataset:
    """Read a Dataset that `save` wrote, whole, so that the file may be replaced; its checksums are compared.

    Raises
    ------
    InputError
        No such file, none of ours, spoilt, or one that unpacks to more than this machine can hold.
    """

    def load_variables(data: Dataset) -> Dataset:
        for name, array in data.variables.items():
            _load(array, str(name), path)
        return data

    return _read(path, load_variables)


def stored_attributes(path: str | Path) -> dict[Any, Any]:
    """The attributes of a Dataset that `save` wrote; InputError as of `open_results`."""
    return _read(path, lambda data: dict(data.attrs))


def _read(path: str | Path, read: Callable[[Dataset], T]) -> T:
    """Open and check a file of results, and return the values that `read` takes from it."""
    import xarray as xr

    path = path_of(path, "path")
    try:
        check_regular(path)
        _refuse_size(path)
        with xr.open_dataset(path, engine="netcdf4", decode_times=False) as data:
            _check_ours(data, path)
            _check_attributes(data, path)
            return read(data)
    except InputError:
        raise
    except Exception as error:  # whatever a file that is none of ours makes its reader say
        words = error.strerror if isinstance(error, OSError) and error.strerror else f"{error!s:.200}"
        why = words or type(error).__name__
        raise InputError(f"is not a readable NetCDF file ({why})", file=str(path), next_step=AGAIN) from None


def _check_ours(data: Dataset, path: str | Path) -> None:
    if not isinstance(data.attrs.get("flexapod_version"), str):
        raise InputError("is not a result of flexapod", file=str(path), next_step=AGAIN)


def _check_attributes(data: Dataset, path: str | Path) -> None:
    """NetCDF has checksums for values alone; those of the attributes are ours."""
    if data.attrs.pop(SUM, None) not in (None, _sum(data)):  # none: written before there were any
        raise InputError(
            "is damaged: its attributes are not what was written",
            file=str(path),
            next_step=f"Take a copy of the file, if there is one. {AGAIN}",
        )


def _sum(data: Dataset) -> str:
    """Checksum of all attributes of a Dataset and its variables, the same before writing and after reading."""
    parts = {"": data.attrs, **{str(name): array.attrs for name, array in data.variables.items()}}
    plain = {
        name: {key: _summed(value) for key, value in sorted(attrs.items()) if key != SUM}
        for name, attrs in sorted(parts.items())
    }
    return hashlib.sha256(json.dumps(plain).encode()).hexdigest()


def _summed(value: object) -> list[Any]:
    found = np.atleast_1d(np.asarray(value))
    return [hashlib.sha256(found.tobytes()).hexdigest()] if found.dtype == np.uint8 else found.tolist()


def _load(array: Variable, name: str, path: str | Path) -> None:
    try:
        array.load()
    except (OSError, RuntimeError, ValueError) as error:
        raise InputError(
            f"is damaged: {name} is not what was written ({error})",
            file=str(path),
            next_step=f"Take a copy of the file, if there is one. {AGAIN}",
        ) from None


def _refuse_size(path: Path) -> None:
    """Refuse a file before it is read: what it unpacks to is written at its beginning."""
    from netCDF4 import Dataset as File

    with File(path) as file:
        numbers = sum(max(math.prod(v.shape), _chunk(v.chunking())) for v in file.variables.values())
    size, packed = NUMBER * numbers, path.stat().st_size
    most = min(available_memory() / 2, max(ANY_FILE, MOST_PACKED * packed))
    if size > most:
        raise InputError(
            f"unpacks to {size / 1e9:.3g} GB from {packed / 1e6:.3g} MB",
            file=str(path),
            allowed=f"at most {most / 1e9:.3g} GB: half the free memory, and {MOST_PACKED} times the file",
            next_step="Raise output_step or shorten the duration, and compute it anew",
        )


def _chunk(lengths: object) -> int:
    """Number of values of a variable that are unpacked at once."""
    return math.prod(lengths) if isinstance(lengths, list) else 0


def save_csv(data: Dataset, path: str | Path) -> Path:
    """Write everything that varies over time alone or over one or two labels more to a CSV file, an instant a row.

    Columns are named after variable and labels, with the unit: ``com_deviation.z [m]``, ``actuator_force.3 [N]``.

    Parameters
    ----------
    data : Dataset
        With the dimension `time`.
    path : path
        An existing file is replaced when the new one is complete.

    Raises
    ------
    InputError
        The folder cannot be written to.
    """
    columns = {"time [s]": data.time.values}
    for name, values in data.data_vars.items():
        if "time" in values.dims:
            columns |= _columns(str(name), values)
    table = np.column_stack(list(columns.values()))
    with replace_file(path) as temporary:
        np.savetxt(
            temporary, table, fmt="%.10g", delimiter=",", header=",".join(columns), comments="", encoding="utf-8"
        )
    return Path(path)


def _columns(name: str, values: DataArray) -> dict[str, Array]:
    """The values flattened over all labels but time, by column name."""
    dims = [dim for dim in values.dims if dim != "time"]
    unit = values.attrs.get("units", "1")
    if not dims:
        return {f"{name} [{unit}]": values.values}
    flat = values.transpose("time", *dims).values.reshape(values.sizes["time"], -1)
    labels = [".".join(str(part) for part in label) for label in product(*(values[dim].values for dim in dims))]
    return {f"{name}.{label} [{unit}]": column for label, column in zip(labels, flat.T, strict=True)}


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
    """Value in a form that attributes can hold: flags become integers."""
    return int(value) if isinstance(value, bool | np.bool_) else value
