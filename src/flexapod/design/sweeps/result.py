"""The Dataset of a sweep: from its store, by key, as a table."""

from __future__ import annotations

import json
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexapod.common.files import replace_file
from flexapod.common.lazy_imports import LazyModule
from flexapod.design.sweeps.refusals import other_format
from flexapod.design.sweeps.store import COMPUTED, FAILED, FLOAT, FORMAT, PENDING, SweepStore
from flexapod.design.sweeps.zarr_folder import read_zarr

if TYPE_CHECKING:
    from xarray import DataArray, Dataset

    from flexapod.common import datasets
    from flexapod.design.sweeps import records
else:
    datasets = LazyModule("flexapod.common.datasets")
    records = LazyModule("flexapod.design.sweeps.records")


def open_sweep(path: str | Path) -> Dataset:
    """The Dataset of a sweep's store, finished or not; records are read when they are used.

    Parameters
    ----------
    path : path
        The SQLite file, or a Zarr folder; of a Zarr folder whose store lies beside it the store, which holds the same
        and may hold more.

    Raises
    ------
    InputError
        There is no store of a sweep, it is damaged, or another version has written it.
    ComputationError
        A part of it cannot be read. Of a record that is told when it is used; the sweep run again mends it.
    """
    place, file = Path(path), store_file(Path(path))
    if place.is_dir() and not file.is_file():
        return read_zarr(place)
    with SweepStore.open(file) as store:
        if store.layout.header["flexapod_sweep_format"] != FORMAT:
            raise other_format(file, store.layout.header)
        return as_dataset(store)


def store_file(path: Path) -> Path:
    """The SQLite file of a sweep: for ``NAME.zarr`` it is ``NAME.sqlite``."""
    return path.with_suffix(".sqlite") if path.suffix == ".zarr" else path


def as_dataset(store: SweepStore) -> Dataset:
    """The Dataset of an open store: whole records of one on disk stay there until they are used."""
    known = store.layout
    made: dict[str, Any] = {}
    states = np.full(known.size, PENDING, dtype="U8")
    words = {state: np.full(known.size, "", dtype=object) for state in (FAILED, COMPUTED)}
    scalars = known.result_arrays(records=False)
    ends = np.cumsum([0, *(prod(array.shape[1:]) for array in scalars.values())])
    numbers = np.full((known.size, ends[-1]), np.nan)
    for row in store.points():
        states[row.point], words[row.state][row.point] = row.state, row.words
        if row.state == COMPUTED:
            numbers[row.point] = np.frombuffer(row.scalars, FLOAT)
    for (name, (dims, shape, attributes, _)), begin, end in zip(scalars.items(), ends[:-1], ends[1:], strict=True):
        made[name] = (dims, np.ascontiguousarray(numbers[:, begin:end]).reshape(shape), attributes)
    for name, (dims, shape, attributes, _) in known.result_arrays(records=True).items():
        if store.path:
            made[name] = records.lazy_record(store.path, name, dims, shape, attributes)
        else:
            made[name] = (dims, store.record(name, range(known.size), shape[1:]), attributes)
    made["status"] = ("point", states, {"long_name": "state of the point"})
    made["message"] = ("point", words[FAILED], {"long_name": "why there is no result"})
    made["remarks"] = ("point", words[COMPUTED], {"long_name": "remarks on the result, a line each"})
    coordinates = {
        name: (dims, values.astype(object) if values.dtype.kind == "U" else values, attributes)
        for name, (dims, _, attributes, values) in known.arrays.items()
        if values is not None
    }
    return datasets.build_dataset(made, coordinates, known.header)


def unstacked(data: Dataset) -> Dataset:
    """A sweep with one dimension for every key that varies by itself in place of `point`.

    Keys that vary together share the dimension of the first; a Latin hypercube has `sample`, random draws `draw`.
    """
    axes: list[dict[str, Any]] = json.loads(data.attrs["axes"])
    names, shape = [axis["name"] for axis in axes], [axis["count"] for axis in axes]
    owner = {key: axis["name"] for axis in axes for key in axis["keys"]}
    made: dict[str, Any] = {}
    for name, array in data.variables.items():
        if "point" not in array.dims:
            made[str(name)] = array
            continue
        whole = array.values.reshape(*shape, *array.shape[1:])
        dims = [*names, *array.dims[1:]]
        if (own := owner.get(str(name))) is not None:
            at = tuple(slice(None) if axis == own else 0 for axis in names)
            whole, dims = whole[at], [own, *array.dims[1:]]
        made[str(name)] = (dims, whole, array.attrs)

    coords = {name: made.pop(str(name)) for name in data.coords}
    return datasets.build_dataset(made, coords, data.attrs)


def save_table(data: Dataset, path: str | Path) -> Path:
    """Everything but whole records as a CSV file, a point a row; an existing file is replaced.

    Raises
    ------
    InputError
        The folder cannot be written to.
    """
    import csv

    columns: dict[str, Any] = {"point": np.arange(data.sizes["point"])}
    last = {name: data[name] for name in ("status", "message", "remarks")}
    others = {str(name): data[name] for name in (*data.coords, *data.data_vars) if name not in last}
    for name, array in (others | last).items():
        if array.dims[:1] == ("point",) and "time" not in array.dims:
            columns |= _columns(name, array)
    with replace_file(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows(zip(*(column.tolist() for column in columns.values()), strict=True))
    return Path(path)


def _columns(name: str, array: DataArray) -> dict[str, Any]:
    """Values by the name of the column, with labels and unit."""
    unit = f" [{array.attrs['units']}]" if "units" in array.attrs else ""
    if array.ndim == 1:
        return {f"{name}{unit}": array.values}
    found = {}
    for at in np.ndindex(*array.shape[1:]):
        labels = [
            array[dim].values[i] if dim in array.coords else i + 1 for dim, i in zip(array.dims[1:], at, strict=True)
        ]
        found[f"{name}.{'.'.join(map(str, labels))}{unit}"] = array.values[(slice(None), *at)]
    return found


def scalar_names(data: Dataset) -> list[str]:
    """Names of the quantities that have one number a point; the first is what summaries and figures show."""
    arrays = data.data_vars.items()
    return [str(name) for name, array in arrays if array.dims == ("point",) and array.dtype.kind == "f"]
