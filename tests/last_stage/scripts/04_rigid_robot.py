"""The rigid robot: paths, legs, forces, postures, singularities; `fx.kinematics` and the calls above it."""

import json

import numpy as np

import flexapod as fx
from flexapod import kinematics

study = fx.preset("paper-robot")
robot = study.robot
t = np.linspace(0.0, 1.0, 5)
path = kinematics.poses(robot, study.motion, t)
legs = kinematics.inverse_kinematics(robot, path)
forces = kinematics.inverse_dynamics(robot, path)
lengths = kinematics.leg_lengths(robot.base_joints, robot.platform_joints, path.position, path.rotation)
nearest = kinematics.nearest_singularity(robot, path)

inverse = fx.inverse_kinematics(study, duration=0.5, output_step=0.1)
dynamics = fx.inverse_dynamics(study, duration=0.5, output_step=0.1, load=[0, 0, -100, 0, 0, 0])
forward = fx.forward_kinematics(study, [0.95, 0.95, 0.93, 0.93, 0.95, 0.95])
low = kinematics.forward_kinematics(robot, [0.95, 0.95, 0.93, 0.93, 0.95, 0.95])

found = {
    "position": path.position,
    "rotation": path.rotation[-1],
    "length": legs.length,
    "same": float(np.abs(lengths - legs.length).max()),
    "force": forces.actuator_force,
    "nearest": [nearest.condition, nearest.smallest_singular_value, nearest.sign_changes],
    "reachable": kinematics.reachable(robot, path),
    "jacobian": kinematics.drive_jacobian(robot, kinematics.home_pose(robot)),
    "rates": inverse.leg_length_rate.values,
    "inverse_variables": sorted(inverse.data_vars),
    "dynamics": dynamics.actuator_force_rigid.values,
    "dynamics_variables": sorted(dynamics.data_vars),
    "forward": [forward.platform_position.values, sorted(forward.data_vars)],
    "low": [low.position, callable(kinematics.postures)],
    "mobility": {name: fx.mobility(fx.preset(name)).motions.values for name in ("tripod", "nano-hexapod")},
}
print(json.dumps(found, default=lambda x: np.asarray(x).tolist()))
