"""Maps over poses, and modes at a set of poses."""

import json

import numpy as np

import flexapod as fx

study = fx.loads(fx.preset("paper-robot").source_text.replace('com = [0, "373 mm", 0]', "com = [0, 0, 0]"))
axes = {"surge": np.linspace(-0.1, 0.1, 3), "heave": np.linspace(-0.05, 0.05, 3)}
data = fx.workspace_map(study, axes, load=np.zeros(6))
line = fx.workspace_map(study, {"roll": np.deg2rad(np.linspace(-60, 60, 5))}, at={"heave": 0.02}, direction=[1, 0, 1])
robot, piston = study.robot, study.robot.legs[0].piston
up = robot.home.position[2] + data.heave.values
leg = robot.platform_joints[0] - robot.base_joints[0]
by_hand = 6 * piston.EA / piston.length * up**2 / (leg[0] ** 2 + leg[1] ** 2 + up**2)
poses = fx.modes(study, np.array([[0.0, 0, 0, 0, 0, 0], [0.02, 0, 0.01, 0, 0, 0.1]]), shapes=True)
figures = [fx.plot.workspace_map(data, "stiffness"), fx.plot.workspace_map(line, "frequency", mode=2)]
solid = fx.plot.modes_3d(fx.modes(study), show=[1, 2])

found = {
    "stiffness": data.stiffness.values,
    "by_hand": by_hand,
    "frequency": data.frequency.values[..., 0],
    "variables": sorted(data.data_vars),
    "reason": line.reason.values,
    "meanings": line.reason.attrs["flag_meanings"].split()[:3],
    "condition": line.condition.values,
    "poses": [poses.frequency.values[:, :6], sorted(poses.data_vars)],
    "axes": [len(figure.axes) for figure in (*figures, solid)],
}
print(json.dumps(found, default=lambda x: np.asarray(x).tolist()))
