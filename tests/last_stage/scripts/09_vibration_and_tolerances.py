"""A floor that shakes and legs set to within 10 um: the gallery's examples, by hand beside the calls."""

import json
from pathlib import Path

import numpy as np

import flexapod as fx

S = 1e-6  # (m/s^2)^2/Hz, one-sided
Path("floor.csv").write_text(f"frequency [Hz],z [(m/s^2)^2/Hz]\n0.01,{S}\n20000,{S}\n")
text = fx.preset("paper-robot").source_text.replace('com = [0, "373 mm", 0]', "com = [0, 0, 0]")
study = fx.loads(text + '\n[disturbance]\nfloor = { spectrum = "floor.csv" }\n', path="study.toml")
data = fx.vibration(study)
up = int(np.argmax(abs(data.vibration_by_mode.sel(component="z").values)))
omega, zeta = 2 * np.pi * float(data.frequency[up]), float(data.damping_ratio[up])
by_hand = np.sqrt(S / (8 * zeta * omega**3))

plant = fx.linearize(study, inputs="floor:z", outputs="tool:z").reduce(below="1 kHz")
shaken = plant.psd({"floor:z": (np.array([0.01, 20000.0]), np.array([S, S]))})
sources = plant.by_source({"floor:z": (np.array([0.01, 20000.0]), np.array([S, S]))})

machine = fx.load("robot.toml").source_text
machine = machine[: machine.index("[heat]")] + '[tolerances]\nleg_offset = "10 um"\n'
loose = fx.accuracy(fx.loads(machine), draws=200, seed=1)

figures = [fx.plot.vibration(data), fx.plot.cumulative(shaken), fx.plot.budget(fx.budget(fx.loads(machine)))]

found = {
    "rms": data.vibration_rms.values,
    "by_hand": by_hand,
    "by_mode": data.vibration_by_mode.sel(component="z").values[:6],
    "variables": sorted(data.data_vars),
    "plant": [float(shaken.rms[0]), float(sources.rms_by_source[0, 0]), sorted(shaken.data_vars)],
    "sigma": loose.pose_sigma.values,
    "drawn": np.sqrt(np.diag(loose.sample_covariance.values)),
    "accuracy_variables": sorted(loose.data_vars),
    "axes": [len(figure.axes) for figure in figures],
}
print(json.dumps(found, default=lambda x: np.asarray(x).tolist()))
