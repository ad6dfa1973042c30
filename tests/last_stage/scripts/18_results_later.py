"""Results, stores of sweeps, maps and laws that were written with the commit before, read back."""

import json
from pathlib import Path

import numpy as np

import flexapod as fx
from flexapod.surveys.sweeps import open_sweep, unstacked

data = fx.study.open_results("stored/results.nc")
study = fx.loads(data.attrs["study"])
again = fx.simulate(study)
summary = fx.study.summary(data)
beam = fx.study.open_results("stored/actuator.nc")
bodies = fx.plot.deviation_by_cause(data)
sweep = open_sweep("stored/sweep.sqlite")
folder = open_sweep("stored/sweep.zarr")
grid = unstacked(sweep)
with np.load("stored/plant.npz", allow_pickle=False) as kept:
    sizes = [list(kept[key].shape) for key in "ABCD"]
text = fx.preset("nano-hexapod").source_text
law = '\n[control]\nlaw = "file"\nfile = "stored/law.npz"\nsample = "0.1 ms"\n'
loop = fx.simulate(
    fx.loads(text + law, path="study.toml"), fidelity="lumped", step=5e-5, duration=0.005, output_step=1e-3
)
try:
    fx.sweep(study, "stored/SWEEP.toml", store="stored/sweep.sqlite", workers=0)
    refused = "continued"
except fx.InputError:
    refused = "refused"

found = {
    "stored": data.tool_deviation.values[-1],
    "same": bool(np.abs(again.tool_deviation - data.tool_deviation).max() < 1e-13),
    "variables": [name in again for name in data.data_vars],
    "units": all(again[name].attrs["units"] == data[name].attrs["units"] for name in data.data_vars),
    "dims": all(again[name].dims == data[name].dims for name in data.data_vars),
    "summary": [summary.peak, summary.rms, summary.time],
    "beam": beam.tip_deflection.values[-1],
    "sweep": [sweep.com_deviation_peak.values, sweep.status.values],
    "folder": [folder.com_deviation_peak.values, list(grid.sizes)],
    "sizes": sizes,
    "loop": loop.tool_deviation.values[-1],
    "refused": refused,
    "axes": len(bodies.axes),
    "stored_files": sorted(path.name for path in Path("stored").iterdir()),
}
print(json.dumps(found, default=lambda x: np.asarray(x).tolist()))
