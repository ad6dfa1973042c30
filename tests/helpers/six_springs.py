"""The paper's robot as six springs under a payload."""

import numpy as np

import flexapod as fx


def springs() -> fx.Study:
    study = fx.preset("paper-robot")
    leg = study.robot.legs[0]
    bare = leg.replace(
        piston=fx.model.leg.piston.Piston(length=leg.piston.length, EA=leg.piston.EA, EI=leg.piston.EI, rhoA=0.0),
        cylinder=leg.cylinder.replace(mass=0.0, inertia=0.0),
    )
    robot = study.robot.replace(legs=(bare,) * 6)
    motion = fx.model.CombinedMotion(amplitudes={"roll": 0.3, "surge": 0.05, "yaw": 0.1}, duration=1.0)
    return study.replace(robot=robot, motion=motion, simulation=fx.model.Simulation(fidelity="lumped"))


def lengths(robot: fx.model.Robot, p: np.ndarray, R: np.ndarray) -> np.ndarray:
    return p + robot.platform_joints @ R.T - robot.base_joints


MOVING, AFTER = 0.2, 0.03  # s


def turning() -> fx.Study:
    """Springs without mass, damping and weight under a payload whose tool is far from its mass."""
    study = springs()
    robot = study.robot
    payload = robot.payload.replace(
        com=[0.02, -0.03, 0.05], tool=[0.3, 0.1, 0.4], inertia=[[15.0, 2.0, -1.0], [2.0, 20.0, 1.0], [-1.0, 1.0, 12.0]]
    )
    bare = tuple(leg.replace(damping=0.0) for leg in robot.legs)
    motion = fx.model.CombinedMotion(amplitudes={"roll": 0.3, "surge": 0.05, "yaw": 0.5}, duration=MOVING)
    return study.replace(robot=robot.replace(legs=bare, payload=payload, gravity=[0, 0, 0]), motion=motion)
