"""A sweep as a Zarr folder: written for other programs, and read, also of versions that kept their sweeps in it."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexapod.common.errors import InputError
from flexapod.common.files import check_regular, temporary_folder
from flexapod.design.sweeps.refusals import damaged_store, no_store, other_format
from flexapod.design.sweeps.store import COMPUTED, FAILED, FORMAT, PENDING

if TYPE_CHECKING:
    from xarray import Dataset

EARLIER = 2  # the format of folders that were stores
BYTES = 64 << 20  # of points that are written together


def is_sweep(folder: Path) -> bool:
    """Test whether a folder is marked as one that holds a sweep."""
    about = folder / "zarr.json"
    return about.is_file() and b'"flexapod_sweep_format"' in about.read_bytes()


def save_zarr(data: Dataset, path: str | Path) -> Path:
    """The Dataset of a sweep as a Zarr folder, which appears when it is whole; an earlier one is replaced.

    Raises
    ------
    InputError
        There is something else, or the folder cannot be written to.
    """
    path, size = Path(path), data.sizes["point"]
    if path.exists() and not is_sweep(path):
        raise no_store(path)
    data = data.assign(status=data.status.astype(object))  # texts of one length have no specification yet
    many = max(1, int(BYTES * size / data.nbytes))
    fixed = [name for name, array in data.variables.items() if "point" not in array.dims]
    try:
        with temporary_folder(path.parent) as folder, warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="Consolidated metadata")  # what xarray looks for first
            new: Any = folder / "new"
            for begin in range(0, size, many):
                part = data.isel(point=slice(begin, begin + many)).drop_vars(fixed if begin else ())
                part.to_zarr(new, append_dim="point" if begin else None)
            if path.exists():
                path.rename(folder / "old")
            new.rename(path)
    except OSError as error:
        words = f"cannot be written: {error.strerror or error}"
        raise InputError(words, file=path, next_step="Choose a place that has space, or leave Zarr out") from None
    return path


def read_zarr(folder: Path) -> Dataset:
    """The Dataset of a folder: records are read when they are used.

    Raises
    ------
    InputError
        It holds no sweep, is damaged, or another version has written it.
    """
    import xarray as xr

    if not is_sweep(folder):
        raise no_store(folder)
    try:
        for file in folder.rglob("*"):
            if not file.is_dir():
                check_regular(file)  # reading a pipe would never end
        data = xr.open_zarr(folder, chunks=None, consolidated=False)
        for array in data.variables.values():
            if "time" not in array.dims:
                array.load()
    except Exception as error:  # whatever the decoder of what is spoilt says
        raise damaged_store(folder, str(error)) from None
    if data.attrs["flexapod_sweep_format"] == EARLIER:
        data = _of_store(data)
    elif data.attrs["flexapod_sweep_format"] != FORMAT:
        raise other_format(folder, data.attrs)
    return data.assign({n: array.astype(object) for n, array in data.variables.items() if array.dtype.kind == "T"})


def _of_store(data: Dataset) -> Dataset:
    """Dataset of an earlier store: status as text, and results only where it says that there are some."""
    varied, kept, _ = (str(data.attrs.pop(name)).split() for name in ("varied", "kept", "complete"))
    coordinates = {name: data[name] for name in varied}
    data = data.reset_coords(varied)[[*kept, "status", "message", "remarks"]].assign_coords(coordinates)
    status = data.status
    made: dict[str, Any] = {
        "status": ("point", np.array([PENDING, COMPUTED, FAILED])[status], {"long_name": "state of the point"}),
        "message": data.message.astype(object).where(status == 2, ""),
        "remarks": data.remarks.astype(object).where(status == 1, ""),
    }
    return data.assign(made | {name: data[name].where(status == 1) for name in kept if "time" not in data[name].dims})
