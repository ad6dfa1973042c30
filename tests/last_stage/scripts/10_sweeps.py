"""Sweeps as `docs/sweep.md` has them: lists, ranges, keys together, hypercubes, tolerances, stores, grids."""

import json
from pathlib import Path

import numpy as np

import flexapod as fx
from flexapod.surveys.sweeps import open_sweep, save_zarr, unstacked

study = fx.preset("paper-robot")
quick = study.simulation.replace(fidelity="lumped", tolerance=None, step=2e-3, duration=0.02, output_step=4e-3)
study = study.replace(simulation=quick)
Path("SWEEP.toml").write_text("""
[[vary]]
key = "motion.profile"
values = ["quintic", "cycloidal"]

[[vary]]
key = "leg.piston.diameter"
start = "25 mm"
stop = "35 mm"
count = 3

[keep]
scalars = ["com_deviation_peak", "actuator_force_peak", "first_frequency"]
records = ["com_deviation"]
record_step = "8 ms"
""")
grid = fx.sweep(study, "SWEEP.toml", store="sweep.sqlite", workers=0)
again = fx.sweep(study, "SWEEP.toml", store="sweep.sqlite", workers=0)
table = unstacked(open_sweep("sweep.sqlite"))
save_zarr(open_sweep("sweep.sqlite"), "sweep.zarr")

together = {
    "vary": [{"together": {"payload.mass": ["50 kg", "100 kg"], "payload.inertia": [[9, 9, 9], [17.88, 17.88, 17.88]]}}]
}
cube = {"latin_hypercube": {"count": 3, "seed": 1, "ranges": {"robot.home_height": ["0.88 m", "0.92 m"]}}}
draws = {
    "random": {
        "count": 3,
        "seed": 1,
        "tolerance": [
            {"key": "leg.piston.diameter", "normal": "0.02 mm"},
            {"key": "robot.base.joints", "uniform": "0.1 mm"},
            {"key": "leg.piston.E", "normal": "1 %"},
        ],
    },
    "keep": {"scalars": ["com_deviation_peak"]},
}
pairs, boxes, machines = (fx.sweep(study, one, workers=0) for one in (together, cube, draws))
legs = fx.sweep(study, {"vary": [{"key": "leg[3].damping", "values": [0.002, 0.02]}]}, workers=0)
one = fx.sweep(study, {"vary": [{"key": "payload.mass", "values": [100, 120]}]}, workers=0)
figures = [fx.plot.sweep(grid), fx.plot.sweep(one, "com_deviation_peak"), fx.plot.sweep(machines)]

refused = []
for key in ("leg.piston.diametre", "payload.mass"):
    try:
        fx.sweep(study, {"vary": [{"key": key, "values": ["1 m"]}]}, workers=0)
    except fx.InputError as error:
        refused.append([error.key, str(error.value)])

found = {
    "grid": {name: grid[name].values for name in ("com_deviation_peak", "actuator_force_peak", "first_frequency")},
    "records": [grid.com_deviation.dims, grid.com_deviation.values[-1, -1]],
    "status": sorted(set(grid.status.values.tolist())),
    "again": bool((again.com_deviation_peak == grid.com_deviation_peak).all()),
    "table": [list(table.sizes), table.com_deviation_peak.sel({"motion.profile": "quintic"}).values],
    "zarr": sorted(open_sweep("sweep.zarr").data_vars),
    "together": [pairs.com_deviation_peak.values, sorted(pairs.data_vars)],
    "cube": [boxes["robot.home_height"].values, boxes.com_deviation_peak.values],
    "drawn": [machines["leg.piston.diameter"].values, machines.com_deviation_peak.values],
    "legs": legs.com_deviation_peak.values,
    "refused": refused,
    "axes": [len(figure.axes) for figure in figures],
}
print(json.dumps(found, default=lambda x: np.asarray(x).tolist()))
