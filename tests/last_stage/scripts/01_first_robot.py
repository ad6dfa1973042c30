"""The first example of the README and the page "Start": one robot, one answer, one report."""

import json
from pathlib import Path

import numpy as np

import flexapod as fx

data = fx.simulate(fx.preset("paper-robot"), duration=0.3, output_step=0.01)
peak = 1e6 * np.abs(data.com_deviation).max("time")
stretch = 1e6 * np.abs(data.deviation_by_cause.sel(cause="axial-strain").sum("leg")).max("time")
print(f"The payload misses its path by x {peak[0]:.2f}, y {peak[1]:.2f}, z {peak[2]:.1f} um.")

study = fx.load("robot.toml")
short = fx.simulate(study, fidelity="lumped", step=1e-3, duration=0.05)
summary = fx.study.summary(short)
fx.study.save(short, "short.nc")
again = fx.study.open_results("short.nc")
table = again.tool_deviation.to_pandas()

found = {
    "peak": peak,
    "stretch": stretch,
    "variables": sorted(data.data_vars),
    "units": {name: data[name].attrs["units"] for name in sorted(data.data_vars)},
    "dimensions": {name: data[name].dims for name in sorted(data.data_vars)},
    "attributes": sorted(data.attrs),
    "causes": data.cause.values,
    "drive_force": data.drive_force.values[-1],
    "energies": [float(data[f"energy_{kind}"][-1]) for kind in ("kinetic", "potential", "strain", "dissipated")],
    "machine": {name: short[name].values[-1] for name in ("tool_deviation", "drive_force", "drive_position")},
    "machine_causes": short.cause.values,
    "frame": [list(table.columns), float(table.abs().max().max())],
    "summary": sorted(name for name in dir(summary) if not name.startswith("_")),
    "peak_of_summary": summary.peak,
    "text": fx.loads(again.attrs["study"]).source_text == study.source_text,
    "files": sorted(path.name for path in Path().iterdir()),
}
print(json.dumps(found, default=lambda x: np.asarray(x).tolist()))
