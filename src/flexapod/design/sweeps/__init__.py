"""Many variants of a study, computed by many workers, into one store that survives being killed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexapod.common.lazy_imports import lazy_attributes
from flexapod.design.sweeps.result import open_sweep, save_table, scalar_names, unstacked
from flexapod.design.sweeps.zarr_folder import save_zarr

if TYPE_CHECKING:
    from collections.abc import Callable

    from flexapod.design.sweeps.run import SweepStopped, sweep

__all__ = ["SweepStopped", "open_sweep", "save_table", "save_zarr", "scalar_names", "sweep", "unstacked"]

#: What computes is loaded when it is asked for: who opens a result needs no solver.
__getattr__: Callable[[str], object] = lazy_attributes(
    "flexapod.design.sweeps", {"flexapod.design.sweeps.run": ("SweepStopped", "sweep")}
)
