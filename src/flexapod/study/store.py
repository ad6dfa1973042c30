"""Results on disk: NetCDF and CSV, written whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from flexapod.errors import InputError
from flexapod.typing import Array

if TYPE_CHECKING:
    from xarray import DataArray, Dataset

__all__ = ["open_results", "replacing", "save", "save_csv"]


def save(data: Dataset, path: str | Path) -> Path:
    """Write a Dataset to a NetCDF 4 file; an existing file is replaced when the new one is complete.

    Raises
    ------
    InputError
        The folder cannot be written to.
    """
    with replacing(path) as temporary:
        data.to_netcdf(temporary, engine="netcdf4", format="NETCDF4")
    return Path(path)


def open_results(path: str | Path) -> Dataset:
    """Read a Dataset that `save` wrote, whole, so that the file may be replaced.

    Raises
    ------
    InputError
        No such file, or none of ours.
    """
    import xarray as xr

    try:
        with xr.open_dataset(path, engine="netcdf4") as data:
            found = data.load()
    except (OSError, ValueError) as error:
        raise InputError(f"is not a readable NetCDF file ({error})", file=str(path)) from None
    if "flexapod_version" not in found.attrs:
        raise InputError("is not a result of flexapod", file=str(path), next_step="Make one with `flexapod run FILE`")
    return found


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
    import numpy as np

    columns = {"time [s]": data.time.values}
    for name, values in data.data_vars.items():
        if "time" in values.dims:
            columns |= _columns(str(name), values)
    table = np.column_stack(list(columns.values()))
    with replacing(path) as temporary:
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
    flat = values.stack(all_labels=dims).transpose("time", "all_labels")
    labels = [".".join(str(part) for part in label) for label in flat.all_labels.values]
    return {f"{name}.{label} [{unit}]": column for label, column in zip(labels, flat.values.T, strict=True)}


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """A temporary file beside `path` that takes its place when the block ends without an error.

    Raises
    ------
    InputError
        The folder cannot be made or written to.
    """
    path = Path(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=f".{path.stem}-", suffix=path.suffix, dir=path.parent)
        os.close(handle)
        temporary = Path(name)
    except OSError as error:
        raise _unwritable(path, error) from None
    try:
        yield temporary
        temporary.chmod(0o666 & ~_umask())
        temporary.replace(path)
    except OSError as error:
        raise _unwritable(path, error) from error
    finally:
        temporary.unlink(missing_ok=True)


def _unwritable(path: Path, error: OSError) -> InputError:
    return InputError(
        f"cannot be written: {error.strerror or error}",
        file=str(path),
        next_step="Choose a place that you may write to and that has space",
    )


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
