"""The machine hexapod on drives that a force moves."""

import flexapod as fx
from flexapod import model

TILTED = {"surge": 0.03, "heave": -0.02, "roll": 0.1, "yaw": 0.05}


def lumped(**changes: object) -> model.Study:
    """The machine hexapod with straight pistons and a drive that a force moves."""
    study = fx.preset("machine-hexapod")
    study = model.override(study, fidelity="lumped")
    return study.replace(robot=on_servos(study.robot, stiffness=60e6, damping=60e3), **changes)


def on_servos(robot: model.Robot, **servo: float) -> model.Robot:
    """The robot as drawn, on drives of another kind."""
    drive = model.ServoDrive(**servo)
    legs = tuple(leg.replace(drive=drive, springs=()) for leg in robot.legs)
    return robot.replace(legs=legs, geometry=None, heat=None, tolerances=None)
