"""The computations whose numbers are kept: each gives arrays by name, through public calls only.

So they survive moves and new names inside the package.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
from tests.helpers import legs_of_all_kinds as legs
from tests.helpers.texts import replaced

import flexapod as fx
from flexapod.model import preset_text

MARCH = {"step": 5e-4, "duration": 0.3, "output_step": 0.01, "rho_inf": 0.9}
FIDELITIES = {
    "rigid": {},
    "lumped": {},
    "finite-segment": {"modes": 4},
    "assumed-modes": {"modes": 3},
    "beam-fem": {"modes": 4},
}
VARIANTS = {
    "servo": ('drive = { type = "prescribed" }', 'drive = { type = "servo", stiffness = 2e7, damping = 3e3 }'),
    "force": (
        'drive = { type = "prescribed" }',
        'drive = { type = "force", law = "rigid", feedback = { stiffness = 2e7, damping = 3e3 } }',
    ),
    "moving": ("[simulation]", '[initial]\nstart = "moving"\n\n[simulation]'),
    "wrench": ("[simulation]", "[load]\nwrench = [200, -300, 100, 20, 10, -15]\n\n[simulation]"),
    "combined": (
        'type = "roll" ',
        'type = "combined"\namplitudes = { surge = "20 mm", heave = "-30 mm", roll = "5 deg", yaw = "8 deg" } #',
    ),
}


def variant(name):
    """`paper-robot` with one piece of its file replaced."""
    text = preset_text("paper-robot")
    if name == "combined":
        text = text.replace('amplitude = "26.6 deg"', "# amplitude")
    return fx.loads(replaced(text, VARIANTS[name]))


def series(data):
    """Variables of numbers of a Dataset but rounding itself and what carries a free sign."""
    left_out = {"closure_residual", "deviation_residual", "platform_shape", "leg_shape", "leg_stretch"}
    return {name: v.values for name, v in data.data_vars.items() if v.dtype.kind in "fi" and name not in left_out}


def flexible(data):
    """What a march computes, without commands and the rigid path."""
    rigid = ("command", "rigid", "tool_", "com_position")
    return {name: values for name, values in series(data).items() if not any(part in name for part in rigid)}


def march(fidelity):
    study = fx.preset("paper-robot")
    data = fx.simulate(study, fidelity=fidelity, **FIDELITIES[fidelity], **MARCH)
    return series(data) if fidelity == study.simulation.fidelity else flexible(data)


def marched_variant(name):
    return flexible(fx.simulate(variant(name), **MARCH))


def radii():
    return flexible(fx.simulate(fx.preset("paper-robot-radii"), **MARCH))


def tolerance():
    return flexible(fx.simulate(fx.preset("paper-robot"), duration=0.2, output_step=0.01))


def clamped_free():
    return flexible(fx.simulate(fx.preset("paper-robot"), basis="clamped-free", modes=2, axial_modes=1, **MARCH))


def kinematics():
    study = fx.preset("paper-robot")
    lengths = fx.inverse_kinematics(study, output_step=0.1)
    forces = fx.inverse_dynamics(study, output_step=0.1, load=[50, 0, -100, 0, 5, 3])
    poses = fx.forward_kinematics(study, lengths["leg_length_command"].values)
    return {
        group + "." + name: values
        for group, data in {"inverse": lengths, "forces": forces, "forward": poses}.items()
        for name, values in series(data).items()
    }


def statics(name):
    study = fx.preset(name)
    found = {}
    for title, pose in {"home": None, "turned": [0.02, -0.03, 0.01, 0.15, -0.1, 0.2]}.items():
        for fidelity in ("lumped", "assumed-modes"):
            modes, stiffness = (call(study, pose, fidelity=fidelity) for call in (fx.modes, fx.stiffness))
            found |= {f"{title}.{fidelity}.{key}": v for key, v in (series(modes) | series(stiffness)).items()}
    return found


def workspace():
    axes = {"surge": [-0.05, 0.0, 0.05], "heave": [-0.04, 0.0, 0.04], "roll": [0.0, 0.2]}
    return series(fx.workspace_map(fx.preset("paper-robot"), axes, acceleration=[0, 2, 5]))


def sweep():
    text = preset_text("paper-robot").replace('duration = "2 s" ', 'duration = "50 ms" ')
    text = text.replace("tolerance = 1e-4", 'step = "0.5 ms"')
    vary = [
        {"key": "leg.piston.diameter", "start": "25 mm", "stop": "30 mm", "count": 3},
        {"key": "payload.mass", "values": ["90 kg", "120 kg"]},
    ]
    return series(fx.sweep(fx.loads(text), {"vary": vary}, workers=0))


def actuator(**settings):
    settings = {"step": 1e-3, "duration": 1.0, "output_step": 0.05} | settings
    return series(fx.simulate_actuator(fx.preset("paper-actuator"), **settings))


def loaded_actuator():
    text = (
        preset_text("paper-actuator")
        .replace("gravity = 0 ", "gravity = 9.81 ")
        .replace("damping = 0 ", "damping = 0.01 ")
    )
    text = text.replace("tip_mass = 0 ", "tip_mass = 0.5 ").replace("hub_inertia = 0 ", "hub_inertia = 20 ")
    text = text.replace("rotation = { rate = 0.785 }", "").replace("[initial]", "[load]\ntorque = 30\n\n[initial]")
    return series(fx.simulate_actuator(fx.loads(text), step=1e-3, duration=0.5, output_step=0.05))


def check(name):
    """Figures that `flexapod check --json` prints; of extremes between equal values the first one is said."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "study.toml"
        file.write_text(preset_text(name), encoding="utf-8")
        command = [sys.executable, "-m", "flexapod", "check", str(file), "--json"]
        found = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    figures: dict[str, list[float]] = {}

    def walk(value, key):
        if isinstance(value, dict):
            for name, part in value.items():
                walk(part, f"{key}.{name}".lstrip("."))
        elif isinstance(value, list):
            for part in value:
                walk(part, key)
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            figures.setdefault(key, []).append(value)

    walk(found, "")
    return {key: np.array(values) for key, values in figures.items()}


def leg(kind):
    """What the kernels say of a leg at random states: balance, tip, matrices, energies; no part of a march."""
    found = {}
    for seed in range(20):
        x = legs.state(legs.shapes(kind), seed, 1e-2)
        for name in ("leg_residual", "leg_matrices", "leg_energies"):
            for key, value in legs.call(legs.shapes(kind), name, x).items():
                if key not in ("powers", "drive", "J"):
                    found.setdefault(key, []).append(value)
    return found


CASES = {
    "leg-point": lambda: leg("point"),
    "leg-planar": lambda: leg("planar"),
    **{f"march-{f}": (lambda f=f: march(f)) for f in FIDELITIES},
    **{f"march-{v}": (lambda v=v: marched_variant(v)) for v in VARIANTS},
    "march-radii": radii,
    "march-clamped-free": clamped_free,
    "march-tolerance": tolerance,
    "kinematics": kinematics,
    "statics": lambda: statics("paper-robot"),
    "statics-radii": lambda: statics("paper-robot-radii"),
    "map": workspace,
    "sweep": sweep,
    "actuator": actuator,
    "actuator-beam-fem": lambda: actuator(fidelity="beam-fem", modes=4),
    "actuator-tolerance": lambda: actuator(step=None, tolerance=1e-5),
    "actuator-loaded": loaded_actuator,
    "check": lambda: check("paper-robot"),
    "check-actuator": lambda: check("paper-actuator"),
}


@cache
def computed(name):
    """Arrays of floats by the names of the quantities."""
    return {key: np.asarray(value, float) for key, value in CASES[name]().items()}
