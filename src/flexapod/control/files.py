"""Linear systems for other programs: MATLAB, NumPy, JSON, NetCDF files with all names and units, python-control."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexapod.common.errors import ComputationError, InputError
from flexapod.common.files import path_of, replacing
from flexapod.common.lazy_imports import loaded

if TYPE_CHECKING:
    from flexapod.control.state_space import StateSpace

__all__ = ["save", "to_control"]


def to_control(system: StateSpace) -> Any:
    """See `StateSpace.to_control`."""
    try:
        control: Any = loaded("control")  # it has no types
    except ImportError:
        raise ComputationError(
            "python-control is not installed", next_step='pip install "flexapod[control]", or pip install control'
        ) from None
    if not (system.inputs and system.outputs):
        raise InputError("has no inputs or no outputs", key="system", value=system, allowed="at least one of each")
    if system.D_rate is not None:
        by = ", ".join(system.inputs[k] for k in np.flatnonzero(system.D_rate.any(axis=0)))
        raise InputError(
            "has outputs that follow rates of inputs, which python-control has no place for", key="system", value=by,
            next_step=".select(inputs, outputs) takes others; a low_pass of the controller's rates has none",
        )  # fmt: skip
    names = {"inputs": list(system.inputs), "outputs": list(system.outputs), "states": list(system.states)}
    return control.ss(system.A, system.B, system.C, system.D, system.sample or 0, **names)


def save(system: StateSpace, path: str | Path) -> Path:
    """See `StateSpace.save`."""
    path = path_of(path, "path")
    write = WRITERS.get(path.suffix.lower())
    if write is None:
        raise InputError("is not a format of linear systems", key="path", value=path.name, allowed=", ".join(WRITERS))
    with replacing(path) as temporary:
        write(system, temporary)
    return path


def _named(system: StateSpace) -> dict[str, np.ndarray]:
    """Matrices and names; units beside inputs and outputs; a sample time of 0 is that of a continuous system.

    `D_rate` only where outputs follow rates of inputs.
    """
    names = {"inputs": system.inputs, "outputs": system.outputs, "states": system.states}
    units = {f"{name[:-1]}_units": [system.units.get(x, "1") for x in names[name]] for name in ("inputs", "outputs")}
    texts = {name: np.array(list(values), dtype=str) for name, values in (names | units).items()}
    matrices = {name: getattr(system, name) for name in "ABCD"}
    matrices |= {} if system.D_rate is None else {"D_rate": system.D_rate}
    return matrices | texts | {"sample": np.array(system.sample or 0.0)}


def _mat(system: StateSpace, path: Path) -> None:
    from scipy.io import savemat

    given = {name: x.astype(object) if x.dtype.kind == "U" else x for name, x in _named(system).items()}  # as cells
    with path.open("wb") as file:
        savemat(file, given, oned_as="row")


def _npz(system: StateSpace, path: Path) -> None:
    with path.open("wb") as file:
        np.savez(file, allow_pickle=False, **_named(system))


def _json(system: StateSpace, path: Path) -> None:
    path.write_text(json.dumps({name: x.tolist() for name, x in _named(system).items()}), encoding="utf-8")


def _nc(system: StateSpace, path: Path) -> None:
    from flexapod.control.datasets import system_dataset

    system_dataset(system).to_netcdf(path, engine="netcdf4")


WRITERS: dict[str, Callable[[StateSpace, Path], None]] = {".mat": _mat, ".npz": _npz, ".json": _json, ".nc": _nc}
