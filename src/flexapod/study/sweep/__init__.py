"""Many variants of a study, computed by many workers, into one store that survives being killed."""

from flexapod.study.sweep.result import open_sweep, save_table, scalar_names, unstacked
from flexapod.study.sweep.run import SweepStopped, sweep

__all__ = ["SweepStopped", "open_sweep", "save_table", "scalar_names", "sweep", "unstacked"]
