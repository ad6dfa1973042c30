"""Controllers from sample to sample in the nonlinear simulation; one of them is a function of the user's own."""

import json

import numpy as np

import flexapod as fx
from flexapod.control import DVF, PID, AdaptiveDamping, Function, Tracker

study = fx.preset("nano-hexapod")
MARCH = {"fidelity": "lumped", "step": 5e-5, "duration": 0.01, "output_step": 1e-3}


class Damping:
    """A force against the rate of each stroke, by differences of readings."""

    def __init__(self):
        self.before = None

    def __call__(self, t, readings):
        rate = 0.0 if self.before is None else (readings - self.before) / 1e-4
        self.before = readings
        return -20.0 * rate * np.ones(6)


names = [f"{kind}:{i}" for kind in ("stroke", "drive") for i in range(1, 7)]
own = Function(function=Damping(), inputs=tuple(names[:6]), outputs=tuple(names[6:]))
plant = fx.linearize(study, inputs=["drive"], outputs=["stroke"])
cases = {
    "none": {},
    "DVF": {"controller": DVF(100.0, sensor="stroke"), "sample": "10 kHz"},
    "late": {"controller": DVF(50.0, sensor="stroke"), "sample": 1e-4, "delay_samples": 1},
    "coarse": {
        "controller": DVF(100.0, sensor="stroke"), "sample": "10 kHz", "quantise": 1e-9, "saturate": 5.0,
        "noise": 1e-9, "seed": 4,
    },
    "function": {"controller": own, "sample": "10 kHz"},
    "adaptive": {"controller": AdaptiveDamping(gain=50.0, tracker=Tracker(frequency="350 Hz")), "sample": "10 kHz"},
    "state space": {
        "controller": PID(1e3, 0.0, 20.0, low_pass="2 kHz").on(plant.outputs, plant.inputs), "sample": "10 kHz",
    },
}  # fmt: skip
found = {}
for name, settings in cases.items():
    data = fx.simulate(study, **MARCH, **settings)
    found[name] = {"tool": data.tool_deviation.values[-1], "variables": sorted(data.data_vars)}
    if settings:
        found[name] |= {"input": data.control_input.values[-1], "work": float(data.work_control[-1])}

text = study.source_text + '\n[control]\nlaw = "dvf"\ngain = "100 N s/m"\nsample = "0.1 ms"\n'
written = fx.simulate(fx.loads(text), **MARCH)
found["written"] = [written.tool_deviation.values[-1], sorted(written.attrs)]
print(json.dumps(found, default=lambda x: np.asarray(x).tolist()))
