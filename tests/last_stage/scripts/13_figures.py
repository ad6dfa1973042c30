"""Every figure that a result has, with the words on its axes, and files of it."""

import json
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import flexapod as fx
import flexapod.plot
from flexapod.plot import save
from flexapod.plot.style import save as saved

data = fx.simulate("robot.toml", fidelity="lumped", step=1e-3, duration=0.04, output_step=2e-3)
bent = fx.simulate(fx.preset("paper-robot"), modes=1, step=1e-3, duration=0.02, output_step=1e-3)
beam = fx.simulate_actuator(fx.preset("paper-actuator"), duration=0.1, output_step=0.01)
poles = fx.linearize("robot.toml", inputs="wrench", outputs="tool").damp()
figures = {
    "actuator_forces": fx.plot.actuator_forces(data),
    "by_leg": fx.plot.by_leg(data, "drive_position"),
    "com_path": fx.plot.com_path(data),
    "deviation_by_cause": fx.plot.deviation_by_cause(data),
    "energies": fx.plot.energies(data),
    "leg_lengths": fx.plot.leg_lengths(data),
    "motion_law": fx.plot.motion_law(data),
    "tip_deflections": flexapod.plot.tip_deflections(bent),
    "robot_3d": flexapod.plot.robot_3d(bent, 0.01),
    "pole_map": fx.plot.pole_map(poles, below=500),
    "actuator_response": fx.plot.actuator_response(beam),
    "actuator_path": fx.plot.actuator_path(beam, magnify=10),
    "actuator_modes": fx.plot.actuator_modes(beam),
    "transmissibility": fx.plot.transmissibility(fx.transmissibility("robot.toml", [5.0, 20.0, 80.0])),
}
files = save(figures["by_leg"], "figure-3", formats=("pdf", "svg", "png"), width=0.085)
fx.plot.save(figures["energies"], "energies", formats=("png", "svg"))  # PNG alone where nothing is said
found = {
    "names": sorted(name for name in fx.plot.__all__ if name not in ("tornado",)),
    "axes": {name: len(figure.axes) for name, figure in figures.items()},
    "lines": {name: len(figure.axes[0].lines) for name, figure in figures.items()},
    "labels": {
        name: [figure.axes[0].get_xlabel(), figure.axes[0].get_ylabel()]
        for name, figure in figures.items()
        if name in ("actuator_forces", "leg_lengths", "motion_law", "energies")
    },
    "drawn": np.abs(figures["by_leg"].axes[0].lines[0].get_ydata()).max(),
    "files": sorted(path.name for path in Path().iterdir()),
    "saved": [Path(file).name for file in files],
    "same": saved is save,
    "open": len(plt.get_fignums()),
}
print(json.dumps(found, default=lambda x: np.asarray(x).tolist()))
