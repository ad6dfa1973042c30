"""The tutorial of an element of one's own: one in a leg, two in a leg, legs with it and without it, sweeps, budgets."""

import json

import bellows
import numpy as np

import flexapod as fx

MARCH = {"fidelity": "lumped", "step": 1e-3, "duration": 0.03, "output_step": 5e-3}
TABLE = '[leg.bellows]\nstiffness = "20 kN/m"\nrelaxation = "0.1 s"\nplay = "4 um"\n'
TWO = "".join(f'[[leg.bellows]]\nstiffness = "{k} kN/m"\nrelaxation = "0.1 s"\n' for k in (12, 8))
text = fx.preset("paper-robot").source_text


def written(table):
    return fx.loads(text.replace("[motion]", f"{table}\n[motion]", 1))


study = written(TABLE)
data = fx.simulate(study, **MARCH)
two = fx.simulate(written(TWO), **MARCH)
legs = study.robot.legs
some = study.replace(robot=study.robot.replace(legs=(legs[0], *(leg.replace(elements=()) for leg in legs[1:]))))
one = fx.simulate(some, **MARCH)
budget = fx.budget(study)
sweep = {"vary": [{"key": "leg.bellows.stiffness", "values": ["10 kN/m", "20 kN/m"]}]}
stiff = fx.sweep(study.replace(simulation=study.simulation.replace(
    fidelity="lumped", tolerance=None, step=1e-3, duration=0.01)), sweep, workers=0)  # fmt: skip
plain = fx.modes(fx.preset("paper-robot"))
refused = []
for table in (TABLE.replace("20 kN/m", "20 kg"), TABLE.replace("relaxation", "relax")):
    try:
        written(table)
    except fx.InputError as error:
        refused.append([error.key, str(error.value)])
try:
    fx.export(study, "abaqus", "own.inp")
except fx.InputError as error:
    refused.append([error.key, ""])

found = {
    "force": data.bellows_force.values[-1],
    "units": [data.bellows_force.attrs["units"], data.bellows_force.attrs["long_name"]],
    "two": [two.bellows_force.values[-1], two.bellows_2_force.values[-1]],
    "together": bool(np.allclose(data.bellows_force, two.bellows_force + two.bellows_2_force, rtol=1e-6)),
    "one": [one.bellows_force.values[-1], one.tool_deviation.values[-1]],
    "rows": [str(part) for part in budget.part.values],
    "seat": [budget.budget.sel(part=part, component="z").values for part in budget.part.values if "seat" in part],
    "stiff": stiff.com_deviation_peak.values,
    "modes": [fx.modes(study).frequency.values[:6], plain.frequency.values[:6]],
    "damping": fx.modes(study).damping_ratio.values[:6],
    "text": "bellows" in fx.model.to_toml(study),
    "class": [bellows.Bellows.at, isinstance(study.robot.legs[0].elements[0], bellows.Bellows)],
    "refused": refused,
}
print(json.dumps(found, default=lambda x: np.asarray(x).tolist()))
