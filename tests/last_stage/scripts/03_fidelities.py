"""One robot at every fidelity and start, and the single actuator: how the settings of a simulation are asked for."""

import json

import numpy as np

import flexapod as fx

MARCH = {"step": 1e-3, "duration": 0.03, "output_step": 5e-3}
study = fx.preset("paper-robot")
ladder = {}
for fidelity in ("rigid", "lumped", "assumed-modes", "finite-segment", "beam-fem"):
    data = fx.simulate(study, fidelity=fidelity, modes=None if fidelity in ("rigid", "lumped") else 2, **MARCH)
    ladder[fidelity] = [data.com_position.values[-1], data.actuator_force.values[-1], int(data.attrs["steps"])]

starts = {}
for start in ("equilibrium", "straight", "moving"):
    data = fx.simulate(study, initial=start, fidelity="lumped", **MARCH)
    starts[start] = data.tool_deviation.values[[0, -1]]

milling = fx.simulate(study, load=[200, 0, -300, 0, 0, 20], fidelity="lumped", **MARCH)
law = fx.model.SineWrench(amplitude=np.array([100.0, 0, 0, 0, 0, 0]), frequency=25.0)
shaken = fx.simulate(study, load=fx.model.Load(wrench=law), fidelity="lumped", rho_inf=0.8, **MARCH)
within = fx.simulate(study, fidelity="lumped", tolerance=1e-6, duration=0.05, output_step=0.01)
progress = []
fx.simulate(study, fidelity="lumped", progress=lambda now, end: progress.append((now, end)), **MARCH)

actuator = fx.preset("paper-actuator")
beam = fx.simulate_actuator(actuator, duration=0.2, output_step=0.05, tolerance=1e-8)
spinning = fx.run(actuator.replace(simulation=actuator.simulation.replace(duration=0.1)))

found = {
    "ladder": ladder,
    "starts": starts,
    "milling": milling.tool_deviation.values[-1],
    "shaken": shaken.tool_deviation.values[-1],
    "within": [within.tool_deviation.values[-1], within.attrs["integrator"], "estimated_force_error" in within.attrs],
    "progress": progress[-1],
    "beam": {name: beam[name].values[-1] for name in ("tip_deflection", "length", "angle", "torque")},
    "beam_variables": sorted(beam.data_vars),
    "spinning": spinning.tip_deflection.values[-1],
    "actuator_modes": fx.modes(actuator).frequency.values,
}
print(json.dumps(found, default=lambda x: np.asarray(x).tolist()))
