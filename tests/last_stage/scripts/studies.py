"""What is asked of study files: their modes, a short motion, budgets, sweeps; `asked` of a table that names them."""

import tomllib
from pathlib import Path

import bellows  # noqa: F401  # [leg.bellows]
import everything  # noqa: F401  # [leg.gasket]
import numpy as np

import flexapod as fx

MARCH = {"step": 1e-3, "duration": 0.02, "output_step": 5e-3}
QUICK = {"fidelity": "lumped", "tolerance": None} | MARCH


def asked(table):
    """By the name of each file."""
    entries = tomllib.loads(Path(table).read_text(encoding="utf-8"))["study"]
    found = {Path(entry["file"]).stem: of_study(**entry) for entry in entries}
    return {name: {key: np.asarray(value).tolist() for key, value in each.items()} for name, each in found.items()}


def of_study(file, sweep=None, budget=False, accuracy=False):
    """Numbers of one file."""
    study = fx.load(file)
    again = fx.loads(study.source_text, path=file)
    if isinstance(study, fx.ActuatorStudy):
        found = of_actuator(study)
    else:
        found = of_robot(study)
    found["again"] = fx.model.to_toml(again) == fx.model.to_toml(study)
    if budget:
        data = fx.budget(study)
        found |= {"rows": data.part.values, "accuracy": data.pose_accuracy.values, "worst": data.worst.values}
    if accuracy:
        found["pose_error"] = fx.accuracy(file).pose_error.values
    if sweep:
        own = {} if isinstance(study, fx.ActuatorStudy) else {"fidelity": "lumped"}
        quick = study.simulation.replace(**own, tolerance=None, **MARCH)
        data = fx.sweep(study.replace(simulation=quick), sweep, workers=0)
        found["swept"] = sorted(data.data_vars)
        found |= {f"swept {x}": data[x].values for x in data.data_vars if data[x].dtype == float}
        found |= {f"swept {x}": data[x].values for x in data.coords if data[x].dtype == float}
    return found


def of_actuator(study):
    """Of a beam."""
    data = fx.simulate_actuator(study, tolerance=None, **MARCH)
    return {
        "tip": data.tip_deflection.values[-1],
        "energy": data.energy_kinetic.values[-1],
        "modes": fx.modes(study).frequency.values[:3],
    }


def of_robot(study):
    """Of a robot."""
    bends = {"fidelity": "assumed-modes", "modes": 1} if study.robot.platform_fixed else {"fidelity": "lumped"}
    data = fx.simulate(study, **QUICK | bends)
    modes = fx.modes(study, **bends)
    return {
        "motions": fx.mobility(study).motions.values,
        "modes": modes.frequency.values[:6],
        "damping": modes.damping_ratio.values[:6],
        "stroke": data.drive_position.values[-1],
        "units": [data.drive_position.attrs["units"], data.drive_force.attrs["units"]],
        "force": data.drive_force.values[-1],
        "variables": sorted(data.data_vars),
        "causes": data.cause.values if "cause" in data.coords else [],
        **({"tool": data.tool_deviation.values[-1]} if "tool_deviation" in data else {}),
    }
