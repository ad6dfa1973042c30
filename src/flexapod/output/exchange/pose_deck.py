"""A robot at a pose as a deck for other finite element programs."""

from __future__ import annotations

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.results.arguments import LoadLike, PoseLike, RobotLike, as_pose, study_at_pose
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.mechanics.elements.registry import refuse_tables
from flexapod.output.exchange.decks import Deck, number
from flexapod.output.exchange.decks_legs import LegAtPose, PayloadAtPose, axial_inertia, legs_at_pose
from flexapod.output.exchange.decks_robot import Carriers, drive_shift, write_leg, write_payload
from flexapod.output.exchange.formats import Content
from flexapod.solve.modal.at_poses import locked_poses
from flexapod.solve.statics.locked_robot import single_equilibrium
from flexapod.solve.statics.static_loads import drive_values

ELEMENTS = 20
"""Solid elements along the free part of each piston: first bending right to 5e-5, second to 3e-4."""

MODES = 24
"""Frequencies that the deck asks for."""

_MOST = 500


def abaqus_deck(
    robot: RobotLike,
    pose: PoseLike = None,
    *,
    load: LoadLike = None,
    elements: int = ELEMENTS,
    modes: int = MODES,
    title: str = "Robot with locked drives",
) -> str:
    """The robot with its drives locked as a deck that Abaqus and CalculiX read.

    Two steps: gravity, the load and the drives' forces, with large displacements, which gives the sag; then the
    frequencies about that state. Where nothing acts only the second.

    Parameters
    ----------
    robot, pose, load
        As for `flexapod.modes`.
    elements : int
        Solid elements along the free part of each piston.
    modes : int
        How many frequencies.
    title : str
        First line of the deck.

    Returns
    -------
    str
        The deck, SI units.

    Raises
    ------
    ComputationError
        No static equilibrium at the pose.
    InputError
        A pose out of reach, a pure force drive, a piston that does not reach back to the mouth or has no mass, a
        cylinder with inertia and no mass, numbers of elements or modes out of range.
    """
    study = study_at_pose(robot, load)
    try:
        return _written(study, pose, elements, modes, title)
    except InputError as error:
        if (error.key or "").startswith(("leg", "robot")):
            raise error.with_location(file=study.path) from None
        raise


def abaqus(
    study: model.Study,
    *,
    pose: PoseLike = None,
    load: LoadLike = None,
    title: str = "Robot with locked drives",
    elements: int = ELEMENTS,
    modes: int = MODES,
) -> Content:
    """The deck, an ASCII text, and what it does not have; arguments as of `abaqus_deck`."""
    text = abaqus_deck(study, pose, load=load, elements=elements, modes=modes, title=title)
    words = text.encode("ascii", errors="replace").decode()
    return Content(files={"": words}, left_out=tuple(deck_omissions(study.robot)))


def _written(study: model.Study, pose: PoseLike, elements: int, modes: int, title: str) -> str:
    robot = study.robot
    refuse_tables(robot.legs, "decks")
    _refuse_mounts(robot)
    _check_count("elements", elements, 2, _MOST)
    _check_count("modes", modes, 1, _MOST)
    if not isinstance(title, str) or len(title.splitlines()) > 1:
        raise InputError("is no line of text", key="title", value=title)
    if robot.platform_fixed:
        raise InputError(
            "has a platform that is fixed: decks are of what it carries", key="robot.platform.fixed", value=True
        )
    path = as_pose(robot, pose)
    locked = locked_poses(robot, model.Simulation(), path, study.load)
    single_equilibrium(locked)
    legs = legs_at_pose(robot, path, drive_values(locked.system, robot, locked.acts.force)[0])
    R = path.rotation[0]
    payload = PayloadAtPose(
        mass=robot.payload.mass, com=path.point(robot.payload.com)[0][0], inertia=R @ robot.payload.inertia @ R.T
    )
    deck = Deck(title)
    deck.comment(*_explanation(robot, path, elements))
    carriers = write_payload(deck, payload, kinematics.rigid_limbs(robot).hub_held)
    for i, leg in enumerate(legs, start=1):
        write_leg(deck, leg, f"LEG{i}", elements, payload, carriers)
    wrench = locked.acts.wrench.copy()
    wrench[3:] += np.cross(path.point(robot.payload.tool)[0][0] - payload.com, wrench[:3])
    _write_steps(deck, robot, legs, carriers, wrench, modes)
    return deck.text


def deck_omissions(robot: model.Robot) -> list[str]:
    """Parts and effects of the robot that the deck omits, as text."""
    found = ["damping"]
    rubs = any(x.friction for leg in robot.legs for x in (leg.base_joint, leg.platform_joint, leg.drive))
    found += ["friction"] * rubs + ["play"] * any(leg.half_play for leg in robot.legs)
    found += ["robot.base_motion: the base is at rest"] * (robot.base_motion is not None)
    found += [f"[{name}]: the machine is as drawn" for name in ("geometry", "heat") if getattr(robot, name) is not None]
    if any(leg.piston.axial_inertia and axial_inertia(leg) == leg.cylinder.axial_inertia for leg in robot.legs):
        found.append("leg.piston.axial_inertia, which no cylinder of the given mass and inertia could carry")
    return found


def _refuse_mounts(robot: model.Robot) -> None:
    for name in ("base_mount", "platform_mount"):
        if getattr(robot, name) is not None:
            raise InputError(
                "is not written to decks",
                key=f"robot.{name}",
                allowed="frames that do not move, joints that give way",
                next_step=f"Leave it out for the deck, or share it out to leg.{name[:-6]}_joint.stiffness, "
                "{ axial, radial }: `flexapod modes` with the one and the other says what that changes",
            )


def _check_count(key: str, value: int, least: int, most: int) -> None:
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise InputError("is out of range", key=key, value=value, allowed=f"a whole number from {least} to {most}")


def _explanation(robot: model.Robot, path: kinematics.Poses, elements: int) -> list[str]:
    shift, angles = path.position[0] - robot.home_position, _roll_pitch_yaw(path.rotation[0] @ robot.home_rotation.T)
    moved = [f"{1e3 * x + 0.0:.6g} mm" for x in shift] + [f"{np.rad2deg(x) + 0.0:.6g} deg" for x in angles]
    words = ", ".join(f"{name} {value}" for name, value in zip(model.AXES, moved, strict=True))
    return [
        "Written by flexapod. Units: m, kg, s, N, Pa, Hz. World axes, z up.",
        f"Pose from home: {words}.",
        "Run NAME.inp:   ccx -i NAME   (results in NAME.dat)   or   abaqus job=NAME",
        "",
        f"Pistons: outside the cylinder {elements} solid elements C3D20, a square bar with the EA, EI and rhoA of the "
        "piston and Poisson's ratio 0, as a beam has none; for stresses take the real section. Inside the cylinder the "
        "piston is guided without friction and can only stretch: springs and point masses on the axis (set AXIS). Its "
        "end is held by a spring (set DRIVE): the servo's stiffness, or 1e5 EA / l for a locked stroke. Where a force "
        "drive pushes, its spring's anchor (set BASE) is moved until the spring pushes as much.",
        "Cylinders and payload are rigid: point masses with the body's mass, centre and inertia, joined by *EQUATION. "
        f"Joints at base and platform let turn what their letters allow ({robot.type}), by *EQUATION; springs of "
        "joints act on nodes that move as their angles and displacements do (sets TURN, END, GIVES, TIPGIVES). A bar "
        "twists as a square one: GJ is 0.84 EI.",
        f"Left out: {', '.join(deck_omissions(robot))}.",
        "Solids have shear and rotary inertia, beams have not: bending frequencies of slender pistons lie below those "
        "of `flexapod modes`, by parts in ten thousand in the first and some thousandths in the second.",
        "The equations are linear: good for small elastic motions about this pose, not for driving the robot. They "
        "leave out how weight and joint forces turn with payload and cylinders: of a squared frequency at most the "
        "weight times its distance from the joints, over the rotational stiffness.",
        "CalculiX warns that material MASS has no elastic constants; point masses need none.",
        "",
    ]


def _roll_pitch_yaw(R: Array) -> Array:
    """Angles of R = Rz(yaw) Ry(pitch) Rx(roll), Eq. (T2.9) [rad]."""
    return np.array([np.arctan2(R[2, 1], R[2, 2]), -np.arcsin(np.clip(R[2, 0], -1, 1)), np.arctan2(R[1, 0], R[0, 0])])


def _write_steps(
    deck: Deck, robot: model.Robot, legs: list[LegAtPose], carriers: Carriers, wrench: Array, modes: int
) -> None:
    g = float(np.linalg.norm(robot.gravity))
    moved = [line for i, leg in enumerate(legs, start=1) for line in drive_shift(leg, f"LEG{i}")]
    deck.comment("")
    if g or wrench.any() or moved:
        deck.comment(
            "Sag under gravity, load and drive forces; displacements of the payload's point masses are printed."
        )
        deck.write("*STEP, NLGEOM", "*STATIC", "1., 1., 1E-5, 1.")
        if moved:
            deck.write("*BOUNDARY", *moved)
        if g:
            deck.elset("HEAVY", deck.mass_sets)
            x, y, z = robot.gravity / g
            deck.write("*DLOAD", ", ".join(["HEAVY, GRAV", *map(number, (g, x, y, z))]))
        if wrench.any():
            forces = {term: float(motion @ wrench) for term, motion in carriers.items()}
            deck.write(
                "*CLOAD", *(f"{node}, {axis}, {number(force)}" for (node, axis), force in forces.items() if force)
            )
        deck.write("*NODE PRINT, NSET=PAYLOAD", "U", "*NODE FILE", "U", "*END STEP")
    deck.comment("Frequencies about that state.")
    deck.write("*STEP, PERTURBATION", "*FREQUENCY", str(modes), "*NODE FILE", "U", "*END STEP")
