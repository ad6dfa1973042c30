"""The robot of the rigid path: welds and springs of joints released, drives prescribed."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array, Mask
from flexapod.kinematics.leg_geometry import COORDINATES, DRIVEN
from flexapod.kinematics.robot import once
from flexapod.model import ForceDrive, Leg, PrescribedDrive, Robot, Simulation
from flexapod.solve.batch import RestStates
from flexapod.solve.rigid_motion import rigid_motion
from flexapod.solve.robot_system import robot_system
from flexapod.solve.statics.minimum_energy_forces import open_forces
from flexapod.solve.statics.rigid_forces import displacement_by_error, joint_forces
from flexapod.solve.system import System

__all__ = ["RobotForces", "is_hexapod", "released", "rigid_errors", "rigid_forces", "rigid_system"]


#: Frames of an ideal robot
STILL = {"base_mount": None, "platform_mount": None, "base_motion": None}


@once
def released(robot: Robot) -> Robot:
    """The same robot as drawn, without elements of its own tables, with ideal joints: fixed ones universal, or balls.

    Its drives are prescribed.
    """
    legs = tuple(_ideal(leg) for leg in robot.legs)
    return robot.replace(type="+".join(leg.chain for leg in legs), legs=legs, geometry=None, heat=None, **STILL)


def _ideal(leg: Leg) -> Leg:
    letters = leg.letters
    ends = [letter.replace("F", free) for letter, free in ((letters.base, "U"), (letters.platform, "S"))]
    first = leg.chain[: 1 if letters.carriage else 0]
    none = {"stiffness": None, "bending": None, "torsion": None, "leg_axes": False, "damping": None, "loss": None}
    none |= {"stiffness_damping": None, "stiffness_loss": None, "friction": None}
    return leg.replace(
        chain=first + ends[0] + letters.stroke + ends[1],
        base_joint=leg.base_joint.replace(**none),
        platform_joint=leg.platform_joint.replace(**none),
        springs=(),
        elements=(),
        guide=None,
        cylinder=leg.cylinder.replace(diameter=None, inner_diameter=None, material=None, body=None),
        drive=PrescribedDrive(),
        **({} if leg.piston.keyed else {"piston": leg.piston.replace(keyed=True)}),
    )


@once
def rigid_system(robot: Robot) -> System:
    """Equations of the robot of the rigid path."""
    return robot_system(released(robot), Simulation(fidelity="rigid"), 0.0)  # no spring is left


@dataclass(frozen=True, kw_only=True)
class RobotForces:
    """Forces of the rigid robot at T instants, world axes.

    Attributes
    ----------
    drive_force : ndarray, shape (T, legs)
        Of the drives on what they move [N, of cranks N m]; 0 of passive legs.
    joint_force : ndarray, shape (T, legs, 3)
        Of the legs on the platform [N].
    joint_moment : ndarray, shape (T, legs, 3), or None
        Of the legs on the platform [N m]; None of legs UPS.
    base_force, base_moment : ndarray, shape (T, legs, 3), or None
        Of the base on legs UPS, at the universal joints [N], [N m].
    states, held, closure
        Configurations, forces on all coordinates that are held (T, legs, n) and forces of the closures (T, legs, rows)
        of the equations `rigid_system`, where the forces are theirs.
    open_forces : int
        How many the rigid statics leaves open: shown are those of the least strain energy of the legs.
    """

    drive_force: Array
    joint_force: Array
    joint_moment: Array | None = None
    base_force: Array | None = None
    base_moment: Array | None = None
    states: RestStates | None = None
    held: Array | None = None
    closure: Array | None = None
    open_forces: int = 0


def rigid_forces(
    robot: Robot, path: kinematics.Poses, wrench: Array, legs: kinematics.LegState | None = None
) -> RobotForces:
    """Forces of drives and joints of the robot of the rigid path.

    Six legs UPS by Newton and Euler (T2.26)-(T2.36), others by their equations of motion (T7.24). Drives with a
    constant force have it where the others hold the robot.

    Parameters
    ----------
    robot : Robot
    path : Poses
    wrench : ndarray, shape (T, 6) or (6,)
        At the tool, world axes.
    legs : LegState, optional
        Of the same poses, where they are known.

    Raises
    ------
    ComputationError
        A pose is singular.
    """
    if is_hexapod(robot):
        found = kinematics.inverse_dynamics(robot, path, wrench, legs)
        return RobotForces(
            drive_force=found.actuator_force,
            joint_force=found.joint_force,
            base_force=found.base_force,
            base_moment=found.base_moment,
        )
    system = rigid_system(robot)
    states, rates = rigid_motion(system, released(robot), path)
    pushed, loose = _constant(robot, system)
    # drives with a force of their own, where the others hold the robot without them
    if loose.any() and loose.sum() <= open_forces(system):
        system = replace(system, held=system.held & ~loose)
    else:
        pushed = np.zeros_like(pushed)
    forces = joint_forces(system, states, rates, wrench, pushed)
    return RobotForces(
        drive_force=_of_drives(robot, forces.held),
        joint_force=forces.joint_force,
        joint_moment=forces.joint_moment,
        states=states,
        held=forces.held,
        closure=forces.closure,
        open_forces=forces.open_forces,
    )


def _constant(robot: Robot, system: System) -> tuple[Array, Mask]:
    """Constant forces of drives (legs, n), and which coordinates nothing but these drives."""
    legs, force = kinematics.rigid_limbs(robot), np.zeros(system.held.shape)
    loose = np.zeros(system.held.shape, dtype=bool)
    for i, leg in enumerate(robot.legs):
        drive = leg.drive
        if leg.driven and isinstance(drive, ForceDrive) and drive.value is not None:
            at = system.kernel.shapes.index(COORDINATES[int((legs.state[i] == DRIVEN).argmax())])
            force[i, at], loose[i, at] = drive.value, True
    return force, loose


def is_hexapod(robot: Robot) -> bool:
    """Whether a robot has six driven legs UPS, ball joints being ideal or released."""
    legs = kinematics.rigid_limbs(robot)
    driven = (legs.state[:, COORDINATES.index("l")] == DRIVEN).all()
    return legs.plain and len(legs) == 6 and bool(driven) and not legs.hub_held.any()


def _of_drives(robot: Robot, held: Array) -> Array:
    """Of all held coordinates (T, legs, n) those that drives hold, (T, legs)."""
    shapes, legs = rigid_system(robot).kernel.shapes, kinematics.rigid_limbs(robot)
    found = np.zeros(held.shape[:2])
    for k, name in enumerate(COORDINATES):
        if shapes.has(name):
            driven = legs.state[:, k] == DRIVEN
            found[:, driven] = held[:, driven, shapes.index(name)]
    return found


def rigid_errors(robot: Robot, path: kinematics.Poses) -> Array:
    """Displacement of the payload for unit errors of each of `COORDINATES`, (T, legs, 8, 6); see T7.27."""
    system = rigid_system(robot)
    states = rigid_motion(system, released(robot), path)[0]
    steps, shapes = displacement_by_error(system, states), system.kernel.shapes
    found = np.zeros((*steps.shape[:2], len(COORDINATES), 6))
    for k, name in enumerate(COORDINATES):
        if shapes.has(name):
            found[:, :, k] = steps[:, :, shapes.index(name)]
    return found
