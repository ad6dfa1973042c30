"""Many variants of a study, computed by many workers, into one store that survives being killed."""

from flexapod.surveys.sweeps.result import open_sweep, save_table, scalar_names, unstacked
from flexapod.surveys.sweeps.run import SweepStopped, sweep

__all__ = ["SweepStopped", "open_sweep", "save_table", "scalar_names", "sweep", "unstacked"]
