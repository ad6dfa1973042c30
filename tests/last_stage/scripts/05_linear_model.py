"""A plant with named channels: matrices, poles, norms, spectra, files, python-control."""

import json
from pathlib import Path

import control
import numpy as np
import scipy.io

import flexapod as fx

study = fx.preset("nano-hexapod")
hz = np.geomspace(10, 1000, 7)
plant = fx.linearize(study, inputs=["wrench", "drive", "floor:z"], outputs=["tool", "stroke", "force-sensor:base"])
short = plant.reduce(below="2 kHz")
bode = short.frequency_response(hz)
up = short.select("wrench:fz", "tool:z")

theirs = up.to_control()
descriptor = plant.descriptor()
grid = fx.linearize(study, {"heave": np.linspace(-5e-5, 5e-5, 3)}, inputs="wrench", outputs="tool")

files = [short.save(f"plant.{ending}") for ending in ("mat", "npz", "json", "nc")]
with np.load("plant.npz", allow_pickle=False) as kept:
    npz = sorted(kept.files)
mat = scipy.io.loadmat("plant.mat")

spectra = {"floor:z": (np.array([1.0, 1000.0]), np.array([1e-8, 1e-8]))}
history = up.step(duration=0.01, step=1e-3)

found = {
    "inputs": plant.inputs,
    "outputs": plant.outputs,
    "units": {name: plant.units[name] for name in (*plant.inputs, *plant.outputs)},
    "sizes": [plant.A.shape, short.A.shape],
    "damp": {name: short.damp()[name].values for name in ("frequency", "damping_ratio")},
    "at": [up.at(hz).real.ravel(), up.at(hz).imag.ravel()],
    "bode": [list(bode.sizes), sorted(bode.data_vars)],
    "compliance": sorted(fx.compliance(study, hz).data_vars),
    "transmissibility": sorted(fx.transmissibility(study, hz).data_vars),
    "h2": plant.h2("wrench:fz", "tool:z").h2_norm.values,
    "hinf": up.hinf().hinf_norm.values,
    "step": [sorted(history.data_vars), np.ravel(history.to_array().values)[-3:]],
    "theirs": [control.dcgain(theirs), theirs.nstates, len(theirs.poles())],
    "descriptor": sorted(name for name in dir(descriptor) if not name.startswith("_")),
    "grid": [list(grid.sizes), sorted(grid.data_vars)],
    "files": [Path(path).name for path in files],
    "npz": npz,
    "mat": sorted(name for name in mat if not name.startswith("_")),
    "zeros": len(up.zeros()),
    "sampled": np.sort(np.abs(up.sampled(1e-4).poles()))[-3:],
}
try:
    found["by_source"] = short.by_source(spectra).to_array().values.shape
except fx.InputError as error:
    found["by_source"] = error.key
print(json.dumps(found, default=lambda x: np.asarray(x).tolist()))
