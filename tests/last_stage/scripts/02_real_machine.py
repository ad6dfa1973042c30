"""Recipes about a machine of catalogue parts: its parts, modes, stiffness, accuracy, budget, and which joint to buy."""

import json

import numpy as np

import flexapod as fx

study = fx.load("robot.toml")
text = study.source_text
bought = {}
for axial in (200, 300):  # N/um, two joints of a catalogue
    one = fx.loads(text.replace('axial = "200 N/um"', f'axial = "{axial} N/um"'))
    leg = float(fx.parts(one).leg_stiffness.sel(leg=1))
    bought[axial] = [leg, fx.modes(one).frequency[:3].values]

parts = fx.parts("robot.toml", {"heave": 0.02})
K = fx.stiffness(study).stiffness.values
compliance = np.linalg.inv(K)[:3, :3]
values, directions = np.linalg.eigh(compliance)
raised = fx.modes(study, {"heave": 0.05, "roll": 0.1}, load=[0, 0, -500, 0, 0, 0])
many = fx.modes(study, {"heave": np.linspace(-0.05, 0.05, 3)})

budget = fx.budget("robot.toml")
path = fx.budget(study, motion=True)
accuracy = fx.accuracy("robot.toml", draws=100, seed=3)
heat = accuracy.pose_error_by_part.sel(component="z")
play = fx.play(fx.loads(text.replace("platform_joint = { ", 'platform_joint = { play = "5 um", ')))
shaken = fx.vibration(fx.loads('disturbance = { floor = "VC-C" }\n' + text))
mobility = fx.mobility(study)

found = {
    "bought": bought,
    "parts": dict(zip(parts.part.values, parts.part_stiffness.sel(leg=1).values, strict=True)),
    "softest": [1e-6 / values[-1], np.hypot(*directions[:2, -1])],
    "raised": {name: raised[name][:3].values for name in ("frequency", "damping_ratio", "payload_share")},
    "many": many.frequency.isel(mode=slice(3)).values,
    "cut_off": many.cut_off.values,
    "budget_variables": sorted(budget.data_vars),
    "accuracy": {s: budget.pose_accuracy.sel(state=s).values for s in ("uncalibrated", "calibrated")},
    "repeatability": budget.repeatability_bidirectional.values,
    "natures": sorted({str(x) for x in budget.nature.values}),
    "path_accuracy": path.pose_accuracy.values,
    "heat": {part: heat.sel(error=part).sum().values for part in heat.error.values},
    "sigma": accuracy.pose_sigma.values,
    "drawn": np.sqrt(np.diag(accuracy.sample_covariance.values)),
    "play_variables": sorted(play.data_vars),
    "shaken": shaken.vibration_rms.values,
    "shaken_by_source": shaken.vibration_by_source.values,
    "mobility": [mobility.motions.values, int(mobility.locked)],
    "open_values": len(fx.open_values("machine-hexapod")),
    "citations": len(fx.cite()),
}
print(json.dumps(found, default=lambda x: np.asarray(x).tolist()))
