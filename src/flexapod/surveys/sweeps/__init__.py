"""Many variants of a study, computed by many workers, into one store that survives being killed."""

from typing import TYPE_CHECKING

from flexapod.surveys.sweeps.result import open_sweep, save_table, scalar_names, unstacked
from flexapod.surveys.sweeps.zarr_folder import save_zarr

if TYPE_CHECKING:
    from flexapod.surveys.sweeps.run import SweepStopped, sweep

__all__ = ["SweepStopped", "open_sweep", "save_table", "save_zarr", "scalar_names", "sweep", "unstacked"]


def __getattr__(name: str) -> object:
    """What computes is loaded when it is asked for: who opens a result needs no solver."""
    if name not in ("SweepStopped", "sweep"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from flexapod.surveys.sweeps import run

    return getattr(run, name)
