"""Writes the results in `stored`, with the commit before, in a folder with its `robot.toml`: once."""

from pathlib import Path

import numpy as np

import flexapod as fx
from flexapod.control import DVF
from flexapod.exchange.uff import uff
from flexapod.surveys.sweeps import open_sweep, save_zarr

OUT = Path(__file__).parents[1] / "stored"
QUICK = {"fidelity": "lumped", "tolerance": None, "step": 1e-3, "duration": 0.03, "output_step": 5e-3}
study = fx.load("robot.toml")
study = study.replace(simulation=study.simulation.replace(**QUICK))
fx.study.save(fx.simulate(study), OUT / "results.nc")
beam = fx.preset("paper-actuator")
fx.study.save(fx.simulate_actuator(beam, duration=0.05, output_step=0.01), OUT / "actuator.nc")
(OUT / "SWEEP.toml").write_text(
    '[[vary]]\nkey = "payload.mass"\nvalues = ["200 kg", "250 kg"]\n\n[keep]\nscalars = ["com_deviation_peak"]\n'
)
fx.sweep(study, OUT / "SWEEP.toml", store=OUT / "sweep.sqlite", workers=0)
save_zarr(open_sweep(OUT / "sweep.sqlite"), OUT / "sweep.zarr")
plant = fx.linearize(fx.preset("nano-hexapod"), inputs=["drive"], outputs=["stroke"])
plant.reduce(below="1 kHz").save(OUT / "plant.npz")
law = DVF(100.0, low_pass="2 kHz").sampled(1e-4, plant.outputs, plant.inputs, plant.units)
law.save(OUT / "law.npz")
response = fx.linearize(study, inputs="wrench:fz", outputs="tool:z").frequency_response(np.array([20.0, 40.0, 60.0]))
(OUT / "response.uff").write_text(uff(response))
