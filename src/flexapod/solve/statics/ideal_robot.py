"""Ideal robot of the rigid path: clamped and compliant joints released, drives prescribed; substitutes of pivots.

Substitutes of held pivots are chosen once, at home, so that motions keep their meaning over poses, Eq. (T7.28).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array, Index, Mask
from flexapod.common.errors import ComputationError
from flexapod.common.ranking import EQUALS, first_largest, is_largest
from flexapod.kinematics.dynamics import LoadSharing
from flexapod.kinematics.jacobian import sharing_inverse
from flexapod.kinematics.leg_geometry import COORDINATES, DRIVEN
from flexapod.kinematics.robot import cache_per_robot
from flexapod.model import ForceDrive, Leg, PrescribedDrive, Robot, Simulation
from flexapod.solve.batch import RestStates, matrices_at_rest
from flexapod.solve.rigid_motion import rigid_motion
from flexapod.solve.robot_system import robot_system
from flexapod.solve.statics.elimination import LegBases, keep_held_pivots, leg_bases
from flexapod.solve.statics.minimum_energy_forces import open_forces
from flexapod.solve.statics.reduction import border_rows, flat_columns
from flexapod.solve.statics.rigid_forces import JointForces, displacement_by_error, joint_forces
from flexapod.solve.system import System

LENGTH = COORDINATES.index("l")

#: Frames of an ideal robot
STILL = {"base_mount": None, "platform_mount": None, "base_motion": None}


@cache_per_robot
def idealize_robot(robot: Robot) -> Robot:
    """Nominal robot, without elements of its own tables, with ideal joints: fixed ones universal, or balls.

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


@cache_per_robot
def rigid_system(robot: Robot) -> System:
    """Equations of the robot of the rigid path."""
    return robot_system(idealize_robot(robot), Simulation(fidelity="rigid"), 0.0)  # no spring is left


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
        Of the base on six legs UPS, at the universal joints [N], [N m].
    open_forces : int
        How many the rigid statics leaves open: shown are those of the least strain energy of the legs.
    """

    drive_force: Array
    joint_force: Array
    joint_moment: Array | None = None
    base_force: Array | None = None
    base_moment: Array | None = None
    open_forces: int = 0


def rigid_forces(at: kinematics.RigidPoses, wrench: Array) -> RobotForces:
    """Forces of drives and joints of the robot of the rigid path.

    Legs UPS by Newton and Euler (T2.26)-(T2.36), more than six of them as their stiffness shares the load (T7.30);
    others by their equations of motion (T7.24). Drives with a constant force have it where the others hold the robot.

    Parameters
    ----------
    at : RigidPoses
    wrench : ndarray, shape (T, 6) or (6,)
        At the tool, world axes.

    Raises
    ------
    ComputationError
        A pose is singular.
    """
    robot = at.robot
    if is_hexapod(robot):
        found = at.inverse_dynamics(wrench)
        return RobotForces(
            drive_force=found.actuator_force,
            joint_force=found.joint_force,
            base_force=found.base_force,
            base_moment=found.base_moment,
        )
    if has_closed_form(robot):
        sharing = _load_sharing(robot)
        found = at.inverse_dynamics(wrench, sharing)
        force = found.actuator_force * kinematics.rigid_limbs(robot).given[:, LENGTH]
        return RobotForces(
            drive_force=force,
            joint_force=found.joint_force,
            open_forces=max(int(np.isnan(sharing.pushed).sum()) - 6, 0),
        )
    forces = reactions(at, wrench)[1]
    return RobotForces(
        drive_force=_of_drives(robot, forces.held),
        joint_force=forces.joint_force,
        joint_moment=forces.joint_moment,
        open_forces=forces.open_forces,
    )


def reactions(at: kinematics.RigidPoses, wrench: Array) -> tuple[RestStates, JointForces]:
    """Forces in every joint by the equations of motion `rigid_system`, Eq. (T7.24), and its states.

    Parameters and errors as of `rigid_forces`.
    """
    robot = at.robot
    system = rigid_system(robot)
    states, rates = rigid_motion(system, _ideal_poses(at))
    pushed, loose = _constant(robot, system)
    # drives with a force of their own, where the others hold the robot without them
    if loose.any() and loose.sum() <= open_forces(system):
        system = replace(system, held=system.held & ~loose)
    else:
        pushed = np.zeros_like(pushed)
    return states, joint_forces(system, states, rates, wrench, pushed)


def _ideal_poses(at: kinematics.RigidPoses) -> kinematics.RigidPoses:
    """The robot of the rigid path at poses: its legs are those that rigid kinematics has anyway."""
    return kinematics.RigidPoses(idealize_robot(at.robot), at.poses, at.legs)


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


def has_closed_form(robot: Robot) -> bool:
    """Test whether a robot has legs UPS alone, at least six of them driven, with ball joints ideal or released."""
    legs = kinematics.rigid_limbs(robot)
    driven = np.count_nonzero(legs.state[:, LENGTH] == DRIVEN)
    return legs.plain and bool(driven >= 6) and not bool(legs.hub_held.any())


@cache_per_robot
def _load_sharing(robot: Robot) -> LoadSharing:
    """Sharing of the load between legs UPS: by their pistons; drives with a constant force where others hold."""
    driven = kinematics.rigid_limbs(robot).state[:, LENGTH] == DRIVEN
    constant = [leg.drive.value if isinstance(leg.drive, ForceDrive) else None for leg in robot.legs]
    given = np.array([np.nan if value is None else value for value in constant])
    pushed = np.where(driven, given, 0.0)
    if np.isnan(pushed).sum() < 6:
        pushed = np.where(driven, np.nan, 0.0)
    return LoadSharing(_axial_stiffness(robot), pushed)


def _axial_stiffness(robot: Robot) -> Array:
    """Axial stiffness of the pistons, (legs,) [N/m], Eq. (T7.25)."""
    return np.array([leg.piston.EA / leg.piston.length for leg in robot.legs])


def is_hexapod(robot: Robot) -> bool:
    """Test whether a robot has six driven legs UPS, with ball joints ideal or released."""
    legs = kinematics.rigid_limbs(robot)
    driven = (legs.state[:, COORDINATES.index("l")] == DRIVEN).all()
    return legs.plain and len(legs) == 6 and bool(driven) and not legs.hub_held.any()


def _of_drives(robot: Robot, held: Array) -> Array:
    """Forces of drives (T, legs), out of those of all held coordinates (T, legs, n)."""
    shapes, legs = rigid_system(robot).kernel.shapes, kinematics.rigid_limbs(robot)
    found = np.zeros(held.shape[:2])
    for k, name in enumerate(COORDINATES):
        if shapes.has(name):
            driven = legs.state[:, k] == DRIVEN
            found[:, driven] = held[:, driven, shapes.index(name)]
    return found


def rigid_errors(at: kinematics.RigidPoses) -> Array:
    """Displacement of the payload for unit errors of each of `COORDINATES`, (T, legs, 8, 6); see T7.27."""
    robot = at.robot
    if has_closed_form(robot):
        return _errors_of_lengths(at)
    system = rigid_system(robot)
    states = rigid_motion(system, _ideal_poses(at))[0]
    steps, shapes = displacement_by_error(system, states), system.kernel.shapes
    found = np.zeros((*steps.shape[:2], len(COORDINATES), 6))
    for k, name in enumerate(COORDINATES):
        if shapes.has(name):
            found[:, :, k] = steps[:, :, shapes.index(name)]
    return found


def _errors_of_lengths(at: kinematics.RigidPoses) -> Array:
    """`rigid_errors` of legs UPS, in closed form."""
    robot, poses = at.robot, at.poses
    driven = kinematics.rigid_limbs(robot).state[:, LENGTH] == DRIVEN
    try:
        by_length = sharing_inverse(at.drive_jacobian(robot.com), _axial_stiffness(robot)[driven])
    except np.linalg.LinAlgError:
        raise ComputationError(
            "a pose on the path is singular: lengths do not determine it", next_step="See `flexapod check`."
        ) from None
    found = np.zeros((len(poses), robot.count, len(COORDINATES), 6))
    found[:, driven, LENGTH] = np.concatenate([by_length[..., :3], by_length[..., 3:] @ poses.rotation], axis=-1)
    return found


YIELDS = 0.01  # what a shape must move a held pivot by, for what the payload does, to stand for it
DEPENDENT = 1e-9  # share of a row that others leave of it: less is rounding


def with_substitutes(system: System, home: RestStates) -> System:
    """System with substitutes of its held pivots, as its one state at home suggests them.

    First the shapes of each leg for its own pivots; for the rows of legs that cannot give way other shapes, then steps
    of the payload. Among equals the first: legs that are alike choose alike.
    """
    n, found = system.n, np.full(system.held.shape, -1, dtype=np.intp)
    bases = leg_bases(system, matrices_at_rest(system, home, np.zeros(system.load_size)))
    for b in bases:
        by = _shapes(b)
        if by is not None:
            found[b.legs[:, None], b.border] = b.legs[:, None] * n + by
    chosen = replace(system, substitutes=found)
    left = keep_held_pivots(chosen, bases)
    legs, pivots = (np.concatenate(x) for x in zip(*map(_rows, left), strict=True))
    if legs.size:
        columns = flat_columns(system, left)
        found[legs, pivots] = np.append(columns, -1)[_of_all(border_rows(left)[0], columns.size - system.border.size)]
    return replace(system, substitutes=found)


def _rows(b: LegBases) -> tuple[Index, Index]:
    """Leg and held pivot of each row that a group keeps."""
    return np.repeat(b.legs, b.border.size), np.tile(b.border, b.legs.size)


def _shapes(b: LegBases) -> Index | None:
    """Coordinates (g, h) that substitute held pivots of legs; None where a leg has none that moves one enough."""
    left, Y = b.N[0][:, b.border], b.Y[0][:, b.border]
    if left.shape[-1] < left.shape[-2]:
        return None
    size = np.maximum(np.abs(left).max(axis=-1, initial=0.0), np.abs(Y).max(axis=-1, initial=0.0))
    chosen, each = np.zeros(left.shape[:-1], dtype=np.intp), np.arange(len(left))
    for k in range(left.shape[-2]):
        column = is_largest(np.abs(left[:, k]), axis=-1, same=EQUALS).argmax(axis=-1)
        pivot = left[each, k, column]
        if not (np.abs(pivot) > YIELDS * size[:, k]).all():
            return None
        chosen[:, k] = b.rest[each, column]
        left[:, k + 1 :] -= (left[each, k + 1 :, column] / pivot[:, None])[..., None] * left[:, k, None]
    return chosen


def _of_all(G: Array, shapes: int) -> Index:
    """Column of each row (rows, r) of the border, the first ``shapes`` of them of legs; -1 of rows that depend."""
    size = np.linalg.norm(G, axis=1, keepdims=True)
    left, found = G / np.where(size > 0, size, 1.0), np.full(len(G), -1, dtype=np.intp)  # one that nothing moves: zero
    for width, least in ((shapes, YIELDS), (G.shape[1], DEPENDENT)):
        while width and np.abs(left[:, :width]).max() > least:
            row, column = divmod(first_largest(np.abs(left[:, :width]).ravel(), EQUALS), width)
            found[row] = column
            left -= np.outer(left[:, column] / left[row, column], left[row])
            left[row] = 0.0
    return found
