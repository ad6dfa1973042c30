"""The Dataset of a sweep: from its store, by key, as a table."""

from __future__ import annotations

import json
from collections.abc import Hashable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexapod.files import replacing
from flexapod.surveys.sweeps.store import COMPUTED, FAILED, PENDING, TEXTS, SweepStore, Values, unreadable
from flexapod.surveys.sweeps.writer import incomplete

if TYPE_CHECKING:
    from xarray import DataArray, Dataset

STATES = np.array(["pending", "computed", "failed"])


def open_sweep(path: str | Path) -> Dataset:
    """The Dataset of a sweep's store, finished or not; records are read when they are used.

    Raises
    ------
    InputError
        There is no store of a sweep, or another version has written it.
    ComputationError
        A part of it cannot be read. Of a record that is told by Zarr, when it is used; the sweep run again mends it.
    """
    return as_dataset(SweepStore.open(Path(path)))


def as_dataset(store: SweepStore) -> Dataset:
    """The Dataset of an open store: whole records of one on disk stay there until they are used."""
    import xarray as xr

    for name in store.coordinates:
        if not store.whole(name):
            raise unreadable(store.path, name)
    data = xr.open_zarr(store.group.store, chunks=None, consolidated=False)
    _load(data, "status", store.path)  # first: what is written meanwhile has its values before its status
    varied, kept, complete = (str(data.attrs.pop(name)).split() for name in ("varied", "kept", "complete"))
    data = data.reset_coords(varied)  # a store keeps no order
    coordinates = {name: data[name] for name in varied}
    data = data[[*kept, "status", "message", "remarks"]].assign_coords(coordinates)
    small = [name for name, array in data.variables.items() if "time" not in array.dims or store.path is None]
    for name in small:
        _load(data, name, store.path)
    for name in data.variables:
        if data[name].dtype.kind == "T":
            data[name] = data[name].astype(object)
    absent = np.any([store.absent(name) for name in (*kept, *TEXTS)], axis=0)
    return data.assign(_consistent(data, absent, [name for name in complete if name in small]))


def _load(data: Dataset, name: Hashable, path: Path | None) -> None:
    try:
        data.variables[name].load()  # without its coordinates, which have their own turn
    except Exception:  # whatever the decoder of a spoilt chunk says
        raise unreadable(path, str(name)) from None


def _consistent(data: Dataset, absent: Values, complete: Sequence[str]) -> dict[str, Any]:
    """The status in words, and loaded values and texts as they belong to it, whatever was written meanwhile."""
    status = data["status"].values.copy()
    status[absent] = PENDING
    status[incomplete(status, {name: data[name].values for name in complete})] = PENDING
    made: dict[str, Any] = {"status": ("point", STATES[status], {"long_name": "state of the point"})}
    for name, state in (("message", FAILED), ("remarks", COMPUTED)):
        made[name] = ("point", np.where(status == state, data[name].values, ""), data[name].attrs)
    for name, array in data.data_vars.items():
        if array.dtype.kind == "f" and "time" not in array.dims:
            there = (status == COMPUTED).reshape(-1, *[1] * (array.ndim - 1))
            made[str(name)] = (array.dims, np.where(there, array.values, np.nan), array.attrs)
    return made


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
    import xarray as xr

    coords = {name: made.pop(str(name)) for name in data.coords}
    return xr.Dataset(made, coords=coords, attrs=data.attrs)


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
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
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
