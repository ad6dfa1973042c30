from flexapod.design.sweeps.result import open_sweep as open_sweep
from flexapod.design.sweeps.result import save_table as save_table
from flexapod.design.sweeps.result import scalar_names as scalar_names
from flexapod.design.sweeps.result import unstacked as unstacked
from flexapod.design.sweeps.run import SweepStopped as SweepStopped
from flexapod.design.sweeps.run import sweep as sweep
from flexapod.design.sweeps.zarr_folder import save_zarr as save_zarr
