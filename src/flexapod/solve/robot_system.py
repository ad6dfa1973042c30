"""The equations of a robot."""

import numpy as np

from flexapod import rigid
from flexapod.mechanics.layout import Shapes
from flexapod.model import Robot, Simulation
from flexapod.rigid.limbs import ABSENT, COORDINATES, DRIVEN, HELD, Limbs
from flexapod.solve.kernel import kernel
from flexapod.solve.losses import per_loss
from flexapod.solve.parameters import (
    flexures,
    joint_parameters,
    leg_parameters,
    payload_parameters,
)
from flexapod.solve.shapes import robot_shapes
from flexapod.solve.system import System
from flexapod.typing import Mask

__all__ = ["robot_system"]


def robot_system(robot: Robot, simulation: Simulation, march: bool = True) -> System:
    """System of a robot in the fidelity, basis and number of shapes of ``simulation``; ``march``: to be integrated."""
    legs = rigid.robot_limbs(robot)
    shapes = robot_shapes(robot, simulation, legs)
    return System(
        kernel=kernel(shapes, march),
        leg_p=leg_parameters(robot, legs, shapes, per_loss(robot, simulation)),
        joint_p=joint_parameters(robot),
        payload_p=payload_parameters(robot),
        held=_held(robot, legs, shapes),
        hub_held=legs.hub_held,
    )


def _held(robot: Robot, legs: Limbs, shapes: Shapes) -> Mask:
    """Coordinates that follow a table: held by joints or drives, or those of other legs. A ball's gammas are free."""
    held = np.zeros((len(legs), shapes.size), dtype=bool)
    prescribed = np.array([leg.drive.type == "prescribed" for leg in robot.legs])
    for k, name in enumerate(COORDINATES):
        if shapes.has(name):
            state = legs.state[:, k]
            foreign = (state == ABSENT) & (name in ("chi", "spin"))
            held[:, shapes.index(name)] = (state == HELD) | ((state == DRIVEN) & prescribed) | foreign
    if shapes.torsion:  # a ball does not twist its leg
        held[:, shapes.index("t")] = ~legs.pose_closure
    if shapes.flexure:  # a joint does not give way in directions in which it has no stiffness
        rigid_ways = ~flexures(robot, legs)[:, :, :3].any(axis=-1)
        held[:, shapes.index("u1") :] = rigid_ways.reshape(len(legs), 6)
    return held
