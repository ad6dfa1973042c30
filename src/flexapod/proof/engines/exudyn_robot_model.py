"""The robot in Exudyn's terms. Imports Exudyn: load it in a process of its own (`exudyn_process`).

A leg is a kinematic tree in minimal coordinates: one hinge or the two of a universal joint, then a slide. Its last link
is the rigid piston, or a carriage of next to no mass that holds the inner end of a chain of ANCF cables; two
frictionless rings on the cylinder, one of them in its mouth, guide the chain.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from flexapod import rigid
from flexapod.model import Leg, Payload, Robot
from flexapod.proof.engines.exudyn_friction import pressing, rub
from flexapod.proof.engines.exudyn_parts import SoftEnd, drive, hold_platform, hold_slides, soft_end
from flexapod.proof.engines.exudyn_robot import RobotProblem, RobotResult
from flexapod.proof.engines.exudyn_system import CARRIAGE_MASS, System, exu, items
from flexapod.rigid.rotations import exponential, quaternion
from flexapod.typing import Array


@dataclass(frozen=True, kw_only=True)
class _LegNumbers:
    """Exudyn's numbers of a leg: the sensor of its coordinates, of its drive, of its tip."""

    coordinates: int
    drive: int
    tip: int


def solve(problem: RobotProblem) -> RobotResult:
    """Build the robot, integrate, and read the sensors."""
    robot, plan = problem.robot, problem.integration
    system = System(plan)
    path = rigid.poses(robot, problem.motion, plan.time)
    lengths = rigid.inverse_kinematics(robot, path).length
    start = robot.home_position + robot.home_rotation @ robot.payload.com
    body = _payload(system, robot.payload, start, robot)
    legs = [_leg(system, problem, i, lengths[:, i], body) for i in range(robot.count)]
    centre = system.mbs.AddSensor(
        items.SensorBody(
            bodyNumber=body,
            outputVariableType=exu.OutputVariableType.Displacement,
            storeInternal=True,
            writeToFile=False,
        )
    )
    seconds = system.solve(equilibrium=True)
    rigid_centre, _, _ = path.point(robot.payload.com)
    return RobotResult(
        time=plan.time,
        com_deviation=system.records([centre])[:, 0] - (rigid_centre - start),
        actuator_force=-system.records([leg.drive for leg in legs])[..., 0],
        tip_deflection=_tip_deflection(
            robot, [system.records([leg.coordinates])[:, 0] for leg in legs], system.records([leg.tip for leg in legs])
        ),
        seconds=seconds,
    )


def _payload(system: System, payload: Payload, place: Array, robot: Robot) -> int:
    J = payload.inertia
    turn = quaternion(robot.home_rotation)
    node = system.mbs.AddNode(items.NodeRigidBodyEP(referenceCoordinates=[*place, *turn]))
    body = system.mbs.AddObject(
        items.ObjectRigidBody(
            mass=payload.mass, inertia=[J[0, 0], J[1, 1], J[2, 2], J[1, 2], J[0, 2], J[0, 1]], nodeNumber=node
        )
    )
    system.weigh(body, robot.gravity)
    return body


def _leg(system: System, problem: RobotProblem, i: int, length: Array, body: int) -> _LegNumbers:
    """One leg with its drive, joined to the platform; `length` (T,) [m] is commanded."""
    mbs, robot = system.mbs, problem.robot
    leg, flexible, turns = robot.legs[i], problem.elements > 0, _turns(robot.legs[i])
    foot, head = soft_end(leg, "base"), soft_end(leg, "platform")
    inner, slide = length[0] - leg.piston.length, turns + len(foot.slides)
    tips = [0.0, 0.0, length[0]] if flexible and (head.slides or leg.platform_joint.friction) else []
    rests = [*[0.0] * slide, inner if flexible else length[0], *tips]
    node = mbs.AddNode(
        items.NodeGenericODE2(
            referenceCoordinates=rests,
            initialCoordinates=[0.0] * len(rests),
            initialCoordinates_t=[0.0] * len(rests),
            numberOfODE2Coordinates=len(rests),
        )
    )
    tree = _tree(system, node, robot, i, foot, flexible=flexible, tips=len(tips))
    links = [slide, slide + 3] if tips else [slide]
    ends = [
        mbs.AddMarker(items.MarkerKinematicTreeRigid(objectNumber=tree, linkNumber=link, localPosition=[0.0] * 3))
        for link in links
    ]
    if flexible:
        nodes = _piston(system, problem, i, tree, inner, slide - 1)
        cable = [mbs.AddMarker(items.MarkerNodePosition(nodeNumber=nodes[k])) for k in (0, -1)]
        for of_tree, of_cable in zip(ends, cable, strict=False):
            mbs.AddObject(items.ObjectJointSpherical(markerNumbers=[of_tree, of_cable]))
        ends.append(ends[-1] if tips else cable[-1])
    hold_slides(system, node, turns, foot)
    place = robot.platform_joints[i] - robot.payload.com
    joint = mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localPosition=place))
    springs = hold_platform(system, ends[-1], joint, head)
    angles = [system.coordinate(node, k) for k in range(turns)]
    rub(system, leg, angles, [ends[-1], joint], pressing(system, springs))
    pushed = drive(system, leg, system.coordinate(node, slide), length)
    tip = items.SensorMarker(
        markerNumber=ends[-1], outputVariableType=exu.OutputVariableType.Position, storeInternal=True, writeToFile=False
    )
    return _LegNumbers(
        coordinates=system.watch_node(node, exu.OutputVariableType.Coordinates),
        drive=system.watch_force(pushed),
        tip=mbs.AddSensor(tip),
    )


def _turns(leg: Leg) -> int:
    """How many ways the base joint turns: two of a universal joint, one of a hinge."""
    return 1 if leg.letters.base == "R" else 2


def _tilt(limbs: rigid.Limbs, i: int) -> Array:
    """Axes of a cylinder in its home frame, (3, 3): a hinge need not be square to its leg."""
    return exponential(np.array([0.0, limbs.home[i, rigid.COORDINATES.index("beta")], 0.0]))


def _tree(system: System, node: int, robot: Robot, i: int, foot: SoftEnd, *, flexible: bool, tips: int) -> int:
    """Cross, cylinder and piston or carriage.

    Turns about x and y of the leg's home frame, slides of the base joint, then a slide along z; where the platform
    joint gives way, a body of no mass to speak of follows the tip with `tips` slides in the cylinder, to have its axes.
    """
    leg, limbs, none = robot.legs[i], rigid.rigid_limbs(robot), np.zeros((3, 3))
    cylinder, piston, tilt, turns = leg.cylinder, leg.piston, _tilt(limbs, i), _turns(leg)
    across = piston.mass * piston.length**2 / 12
    rod = none if flexible else np.diag([across, across, 0.0])
    tube = np.diag([cylinder.inertia, cylinder.inertia, cylinder.axial_inertia + piston.axial_inertia])
    joint, before = exu.JointType, turns + len(foot.slides) - 1  # links before the cylinder
    slides = [joint.PrismaticX, joint.PrismaticY, joint.PrismaticZ]
    axes = np.eye(3) if foot.slides else tilt  # of the cylinder's link
    frames = [limbs.frames[i], *[np.eye(3)] * (turns - 1), tilt, *[np.eye(3)] * len(foot.slides)]
    return system.mbs.AddObject(
        items.ObjectKinematicTree(
            nodeNumber=node,
            gravity=robot.gravity,
            baseOffset=robot.base_joints[i],
            jointTypes=[
                *[joint.RevoluteX, joint.RevoluteY][:turns],
                *(slides[k] for k in foot.slides),
                joint.PrismaticZ,
                *slides[:tips],
            ],
            linkParents=[*range(-1, before + 1), *[before, before + 2, before + 3][:tips]],
            jointTransformations=exu.Matrix3DList([*frames, *[axes, np.eye(3), np.eye(3)][:tips]]),
            jointOffsets=exu.Vector3DList([[0.0] * 3] * (before + 2 + tips)),
            linkInertiasCOM=exu.Matrix3DList([*[none] * before, axes @ tube @ axes.T, rod, *[none] * tips]),
            linkCOMs=exu.Vector3DList(
                [
                    *[[0.0] * 3] * before,
                    cylinder.com * axes[:, 2],
                    [0.0, 0.0, 0.0 if flexible else -piston.length / 2],
                    *[[0.0] * 3] * tips,
                ]
            ),
            linkMasses=[
                *[0.0] * before,
                cylinder.mass,
                CARRIAGE_MASS if flexible else piston.mass,
                *[0.0, 0.0, CARRIAGE_MASS][:tips],
            ],
        )
    )


def _piston(system: System, problem: RobotProblem, i: int, tree: int, inner: float, tube: int) -> list[int]:
    """Chain of cables from the inner end on, with the rings on the link `tube` that guide it; its nodes."""
    mbs, robot, count = system.mbs, problem.robot, problem.elements
    leg, piston, limbs = robot.legs[i], robot.legs[i].piston, rigid.rigid_limbs(robot)
    tilt = _tilt(limbs, i)
    axis = limbs.frames[i] @ tilt[:, 2]
    along = np.array([0.0, 0.0, 1.0]) if tube >= _turns(leg) else tilt[:, 2]
    start = robot.base_joints[i] + axis * inner
    size = piston.length / count
    nodes = [
        mbs.AddNode(items.NodePointSlope1(referenceCoordinates=[*(start + axis * k * size), *axis]))
        for k in range(count + 1)
    ]
    joined = partial(system.cable, items.ObjectANCFCable, rhoA=piston.rhoA, EI=piston.EI, EA=piston.EA)
    cables = [joined(nodes[k : k + 2], size, gravity=problem.robot.gravity) for k in range(count)]
    shapes = [mbs.AddMarker(items.MarkerBodyBeamShape(bodyNumber=cable)) for cable in cables]
    for place in (leg.cylinder.mouth, leg.cylinder.mouth - problem.guide):
        ring = mbs.AddMarker(
            items.MarkerKinematicTreeRigid(objectNumber=tree, linkNumber=tube, localPosition=place * along)
        )
        element = min(int((place - inner) / size), count - 1)
        mbs.AddObject(
            items.ObjectJointSliding(
                markerNumbers=[ring, shapes[element]],
                slidingMarkerNumbers=shapes,
                slidingMarkerOffsets=[k * size for k in range(count)],
                nodeNumber=system.sliding_data(element, place - inner),
                constrainRotations=[0, 0, 0],  # anything else raises an error
                constrainTranslations=[1, 1, 1],  # in world axes; the force along the cable is zero in any case
            )
        )
    return nodes


def _tip_deflection(robot: Robot, coordinates: list[Array], tips: Array) -> Array:
    """Tips (T, legs, 3) [m] seen from the axes of the cylinders at their `coordinates` (T, any), (T, legs, 2)."""
    limbs = rigid.rigid_limbs(robot)
    beta = np.tile(limbs.home[:, rigid.COORDINATES.index("beta")], (len(tips), 1))
    for i, leg in enumerate(robot.legs):
        if _turns(leg) == 2:
            beta[:, i] = coordinates[i][:, 1]
    turns = rigid.leg_rotations(limbs.frames, np.column_stack([q[:, 0] for q in coordinates]), beta)
    found = np.einsum("tnij,tni->tnj", turns, tips - robot.base_joints)[..., :2]
    for i, leg in enumerate(robot.legs):
        if soft_end(leg, "base").across:
            found[:, i] -= coordinates[i][:, _turns(leg) : _turns(leg) + 2]
    return found
