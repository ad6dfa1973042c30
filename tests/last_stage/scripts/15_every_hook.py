"""Parts of one's own with every hook that the base class of elements has, one by one and all together."""

import json

import everything
import numpy as np

import flexapod as fx
from flexapod.elements.element import Element, registered
from flexapod.elements.known import element_at

text = fx.preset("machine-hexapod").source_text
assert fx.Element is Element and registered["foot"] is everything.Foot
LOOP = 'loop = { stiffness = "5 kN m/rad", damping = "20 N m s/rad" }\nbrake = {'
SERVO = text.replace('command = "position"', 'command = "servo"').replace("brake = {", LOOP)
MARCH = {"fidelity": "lumped", "step": 1e-3, "duration": 0.02, "output_step": 5e-3}
TABLES = {
    "foot": 'stiffness = "100 N/um"\ndamping = "2 kN s/m"',
    "gasket": 'force = "40 N"',
    "slack": 'travel = "4 um"',
    "washer": "share = 0.5",
    "patience": "gain = 1e8",
    "fan": 'thrust = "-25 N"',
    "cogging": 'force = "30 N"\npitch = "2 mm"',
}


def study(*names):
    tables = "\n".join(f"[leg.{name}]\n{TABLES[name]}\n" for name in names)
    return fx.loads(SERVO.replace("[motion]", f"{tables}\n[motion]", 1))


NAMES = ("tool_deviation", "drive_force", "friction", "foot_sink")
found = {}
for names in ((), *((name,) for name in TABLES), tuple(TABLES)):
    data = fx.simulate(study(*names), **MARCH)
    found["+".join(names) if len(names) < 2 else "all"] = {x: data[x].values[-1] for x in NAMES if x in data}
    last = data

everyone = study(*TABLES)
legs = everyone.robot.legs
uneven = everyone.replace(robot=everyone.robot.replace(legs=(*(x.replace(elements=()) for x in legs[:3]), *legs[3:])))
balance = last.energy_kinetic + last.energy_potential + last.energy_strain + last.energy_dissipated
budget = fx.budget(study("gasket", "cogging"))
found |= {
    "balance": bool(np.ptp((balance - last.work_drive - last.work_external).values) < 1.0),
    "modes": fx.modes(study("foot", "washer"), fidelity="lumped").frequency.values[:6],
    "cogs at rest": fx.modes(study("cogging"), fidelity="lumped").frequency.values[:3],
    "uneven": fx.simulate(uneven, **MARCH).tool_deviation.values[-1],
    "labels": [str(x) for x in last.friction.coords["slide"].values] if "slide" in last.friction.coords else [],
    "dims": last.friction.dims,
    "rows": [str(part) for part in budget.part.values if "gasket" in str(part) or "cogging" in str(part)],
    "known": [element_at(name).__name__ for name in TABLES],
    "check": len(fx.study.check_path(everyone)) >= 0,
}
print(json.dumps(found, default=lambda x: np.asarray(x).tolist()))
