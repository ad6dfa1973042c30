"""Commands ahead of time: sag and inertia made up for, modes left at rest, the least time."""

import json
from pathlib import Path

import numpy as np

import flexapod as fx

study = fx.load("robot.toml")
study = study.replace(simulation=study.simulation.replace(fidelity="lumped", tolerance=1e-3))
rest = fx.compensate(study, out="rest.toml")
inertia = fx.compensate(study, 2)
shaped = fx.shape(study, "zvd", modes=1, out="shaped.toml")
measured = fx.shape(study.motion, "zv", modes=["60 Hz"])
again = fx.load("rest.toml")

before = fx.simulate(study, duration=0.3, output_step=0.02)
after = fx.simulate(inertia, duration=0.3, output_step=0.02)
miss = {
    "before": before.tool_position.values - before.tool_position_rigid.values,
    "after": after.tool_position.values - before.tool_position_rigid.values,
}

plant = fx.control.StateSpace(
    A=np.array([[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0], [0.0, 0.0, -400.0, -0.4]]),
    B=np.array([[0.0], [1.0], [0.0], [1.0]]), C=np.array([[1.0, 0.0, 0.0, 0.0]]), D=np.zeros((1, 1)),
    inputs=("force",), outputs=("place",), states=("x", "v", "y", "w"), units={"force": "N", "place": "m"},
)  # fmt: skip
quick = fx.time_optimal(plant, end=1.0)
robust = fx.time_optimal(plant, end=1.0, robust=True)

found = {
    "notes": [len(one.notes) for one in (rest, inertia, shaped)],
    "miss": {name: float(np.abs(values).max()) for name, values in miss.items()},
    "ends": [one.motion.end_time for one in (study, rest, inertia, shaped)],
    "kinds": [type(one.motion).__name__ for one in (rest, shaped)] + [type(measured).__name__],
    "table": [again.motion.end_time, np.asarray(fx.kinematics.poses(again.robot, again.motion, [0.3]).position)],
    "shaped": np.asarray(fx.kinematics.poses(shaped.robot, shaped.motion, [0.3]).position),
    "quick": {name: getattr(quick, name) for name in ("duration", "times") if hasattr(quick, name)},
    "quick_has": sorted(name for name in dir(quick) if not name.startswith("_")),
    "robust": {name: getattr(robust, name) for name in ("duration", "times") if hasattr(robust, name)},
    "files": sorted(path.name for path in Path().iterdir()),
    "head": Path("rest.csv").read_text().splitlines()[0],
}
print(json.dumps(found, default=lambda x: np.asarray(x).tolist()))
