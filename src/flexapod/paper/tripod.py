"""A 3-RPS robot of the paper's pistons under the paper's roll: a mechanism in which bending moves the payload."""

from __future__ import annotations

import numpy as np

from flexapod import model
from flexapod.paper.claim import axis_motion
from flexapod.paper.readings import robot_preset
from flexapod.paper.trials import opened

ANGLES = np.deg2rad([0.0, 120.0, 240.0])  # of the hinges, which lie along the circle


def tripod() -> model.Study:
    """Three of the legs of `paper-robot-radii` on hinges, with its circles, height, payload and roll."""
    study = robot_preset("paper-robot-radii")
    robot, motion = study.robot, axis_motion(study)
    out = np.column_stack([np.cos(ANGLES), np.sin(ANGLES), np.zeros(3)])
    hinges = (model.Joint(axis=np.array([-y, x, 0.0])) for x, y, _ in out)
    legs = tuple(leg.replace(chain="RPS", base_joint=hinge) for leg, hinge in zip(robot.legs, hinges, strict=False))
    base, platform = (np.linalg.norm(joints, axis=1)[0] for joints in (robot.base_joints, robot.platform_joints))
    three = robot.replace(type="3-RPS", base_joints=base * out, platform_joints=platform * out, legs=legs)
    return opened(study.replace(robot=three, motion=motion.replace(independent=("heave", "roll", "pitch"))))
