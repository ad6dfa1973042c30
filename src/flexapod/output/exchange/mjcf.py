"""A robot for MuJoCo: legs as trees, loops closed by equality constraints, drives as actuators."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.results.arguments import as_pose
from flexapod.kinematics.rotations import quaternion
from flexapod.mechanics.elements.registry import refuse_tables
from flexapod.output.exchange.formats import Content
from flexapod.output.exchange.mjcf_springs import Drive, LegSprings, flexible_springs, rigid_springs
from flexapod.output.exchange.mjcf_trees import LEAST, LegCompliance, leg_body, numbers, payload_inertia
from flexapod.solve.statics.ideal_robot import rigid_forces

STEPS = 2  # in which what holds a loop closed pulls a gap together
HARD = "0.9999 0.9999 0.001 0.5 2"  # the hardest that MuJoCo takes
NAMES = {"l": ("leg_length_command", "actuator_force"), "chi": ("drive_command", "drive_force")}
_WIDTH = 110


def mjcf(study: model.Study, *, fidelity: str | None = None) -> Content:
    """The robot as MJCF, SI units, at home.

    Legs stretch and bend as far as the study's fidelity says; ``fidelity = "rigid"``: not at all.
    """
    robot = study.robot
    refuse_tables(robot.legs, "MJCF")
    simulation = model.override(study, fidelity=fidelity).simulation if fidelity is not None else study.simulation
    rigid = simulation.fidelity == "rigid"
    springs = rigid_springs(robot) if rigid else flexible_springs(robot, simulation.lateral_shapes > 0)
    limbs = kinematics.rigid_limbs(robot) if rigid else kinematics.robot_limbs(robot)
    missing = mjcf_omissions(study, rigid)
    text = "\n".join([
        f'<mujoco model="{robot.type}">',
        *_comment(springs, rigid, missing),
        f'<compiler angle="radian" autolimits="false" boundmass="{LEAST}" boundinertia="{LEAST}"/>',
        f'<option timestep="{numbers(springs.step)}" integrator="implicitfast" solver="Newton" tolerance="1e-10" '
        f'iterations="100" gravity="{numbers(robot.gravity)}"><flag contact="disable"/></option>',
        "<worldbody>",
        *(leg_body(robot, limbs, i, springs.gives[i], looks=True).text for i in range(robot.count)),
        *_payload(robot, limbs),
        "</worldbody>",
        "<equality>", *_closures(limbs, springs), "</equality>",
        "<actuator>", *_actuators(springs), "</actuator>",
        "<sensor>", *_sensors(robot, limbs, springs), "</sensor>",
        f'<keyframe><key name="home" ctrl="{numbers(_home(robot, springs))}"/></keyframe>',
        "</mujoco>",
    ])  # fmt: skip
    return Content(files={"": text + "\n"}, left_out=tuple(missing), remarks=(_remark(springs),))


def mjcf_omissions(study: model.Study, rigid: bool) -> list[str]:
    """Parts and effects of the robot that the MJCF file omits, as text."""
    robot, found = study.robot, ["the study's motion: commands of the drives come from outside"]
    if rigid:
        found.append("all that gives way but servos")
    else:
        found += ["how stiffness changes with the stroke: springs are those at home"]
        found += ["modes of the pistons: each bends in one place, statically exact at home"]
        found += ["inertia of rotors"] * any(leg.screw is not None for leg in robot.legs)
        found += ["damping ratios of the pistons"]
    found += ["friction"] * any(
        x.friction for leg in robot.legs for x in (leg.base_joint, leg.platform_joint, leg.drive)
    )
    found += ["play"] * any(leg.half_play for leg in robot.legs)
    found += ["oil that leaks"] * any(leg.cylinder_of_oil is not None for leg in robot.legs)
    found += ["limits of strokes and joints"]
    found += ["[control]: the loop of a controller"] * (study.control is not None)
    found += ["[load]: forces come from outside, as xfrc_applied"] * (study.load.wrench is not None)
    found += ["robot.base_motion: the base is at rest"] * (robot.base_motion is not None)
    mounts = [f"robot.{name}: its frame does not move" for name in ("base_mount", "platform_mount")
              if getattr(robot, name) is not None]  # fmt: skip
    tables = [f"[{name}]: the machine is as drawn" for name in ("geometry", "heat") if getattr(robot, name) is not None]
    return [*found, *mounts, *tables]


def _remark(springs: LegSprings) -> str:
    return (
        f"Steps of {springs.step:.2g} s: springs have dampers that bring them to rest in one, and loops are springs "
        f"themselves, {STEPS} steps fast; longer steps need both slower."
    )


def _comment(springs: LegSprings, rigid: bool, missing: list[str]) -> Iterator[str]:
    drives = (
        "Commands: leg_length_command_i, joint to joint, or drive_command_i of a carriage; actuator_force_i or "
        "drive_force_i where the drive is a force. Names and signs are those of results of flexapod."
    )
    gives = (
        "Nothing gives way but servos; a prescribed drive lags a little."
        if rigid
        else "A driven leg's stretch, with that of its joints and its drive, is the servo of its actuator; a piston "
        "bends on slides and hinges in the middle of its free part."
    )
    words = [
        "Written by flexapod. Units: m, kg, s, N, rad. World axes, z up; at home.",
        drives,
        gives,
        _remark(springs),
    ]
    yield "<!--"
    for paragraph in (*words, f"Left out: {'; '.join(missing)}."):
        yield from textwrap.wrap(paragraph, _WIDTH)
    yield "-->"


def _payload(robot: model.Robot, limbs: kinematics.Limbs) -> Iterator[str]:
    """The payload, free but for what holds the platform, with its centre of mass and its tool."""
    R = robot.home_rotation
    yield f'<body name="payload" pos="{numbers(robot.home_position)}" quat="{numbers(quaternion(R))}">'
    if not limbs.hub_held.any():
        yield '<freejoint name="payload"/>'
    else:
        names = [f"payload_{name}" for name in ("x", "y", "z", "roll", "pitch", "yaw")]
        for k in np.flatnonzero(~limbs.hub_held):
            kind = "slide" if k < 3 else "hinge"
            yield f'<joint name="{names[k]}" type="{kind}" axis="{numbers(R.T[:, k % 3])}"/>'
    yield payload_inertia(robot) if robot.payload is not None else ""
    for name, place in (("com", robot.com), ("tool", robot.tool)):
        yield f'<site name="{name}" pos="{numbers(place)}"/>'
    for place in robot.platform_joints:
        ends = numbers([*robot.com, *place])
        yield f'<geom type="capsule" fromto="{ends}" size="{numbers(0.02 * limbs.L_c)}"/>'
    yield "</body>"


def _closures(limbs: kinematics.Limbs, springs: LegSprings) -> Iterator[str]:
    time = STEPS * springs.step
    how = f'solref="{numbers([-1 / time**2, -2 / time])}" solimp="{HARD}"'
    for i, gives in enumerate(springs.gives, start=1):
        if limbs.pose_closure[i - 1]:
            at = numbers(limbs.platform[i - 1])
            yield f'<weld name="loop_{i}" body1="tip_{i}" body2="payload" anchor="{at}" {how}/>'
        else:
            body, place = _tip_body(gives, i)
            yield f'<connect name="loop_{i}" body1="{body}" body2="payload" anchor="0 0 {numbers(place)}" {how}/>'


def _tip_body(gives: LegCompliance, i: int) -> tuple[str, float]:
    """The body that ends in the platform joint, and where that is on its axis z [m]."""
    return (f"piston_{i}", 0.0) if gives.piston is None else (f"bend_{i}", 0.5 * gives.piston.free)


def _actuators(springs: LegSprings) -> Iterator[str]:
    for i, drive in _numbered(springs):
        if drive.servo is not None:
            yield (
                f'<position name="{NAMES[drive.on][0]}_{i}" joint="{drive.on}_{i}" '
                f'kp="{numbers(drive.servo.stiffness)}" kv="{numbers(drive.servo.damping)}"/>'
            )
        if drive.push:
            yield f'<motor name="{NAMES[drive.on][1]}_{i}" joint="{drive.on}_{i}"/>'


def _home(robot: model.Robot, springs: LegSprings) -> list[float]:
    """Commands at home; forces are those that hold the rigid robot."""
    pushed = any(drive.push for _, drive in _numbered(springs))
    home = kinematics.RigidPoses(robot, as_pose(robot, None))
    force = rigid_forces(home, np.zeros((1, 6))).drive_force[0] if pushed else np.zeros(0)
    found = []
    for i, drive in _numbered(springs):
        found += [drive.home] if drive.servo is not None else []
        found += [float(force[i - 1])] if drive.push else []
    return found


def _sensors(robot: model.Robot, limbs: kinematics.Limbs, springs: LegSprings) -> Iterator[str]:
    for point in ("com", "tool"):
        yield f'<framepos name="{point}_position" objtype="site" objname="{point}"/>'
    yield '<framequat name="platform_quaternion" objtype="xbody" objname="payload"/>'
    yield '<frameangvel name="platform_angular_velocity" objtype="xbody" objname="payload"/>'
    slides = limbs.unknown[:, kinematics.COORDINATES.index("l")]
    for i in range(1, robot.count + 1):
        if slides[i - 1] or "l" in springs.gives[i - 1].joints:
            yield f'<jointpos name="leg_length_{i}" joint="l_{i}"/>'
    for i, drive in _numbered(springs):
        if drive.on == "chi":
            yield f'<jointpos name="drive_position_{i}" joint="chi_{i}"/>'
        yield f'<jointactuatorfrc name="{NAMES[drive.on][1]}_{i}" joint="{drive.on}_{i}"/>'


def _numbered(springs: LegSprings) -> Iterator[tuple[int, Drive]]:
    return ((i, drive) for i, drive in enumerate(springs.drives, start=1) if drive is not None)
