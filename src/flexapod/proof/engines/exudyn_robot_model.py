"""The robot in Exudyn's terms. Imports Exudyn: load it in a process of its own (`exudyn_process`).

A leg is a kinematic tree in minimal coordinates: two hinges of the universal joint, then a slide. Its last link is the
rigid piston, or a carriage of next to no mass that holds the inner end of a chain of ANCF cables; two frictionless
rings on the cylinder, one of them in its mouth, guide the chain.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from flexapod import rigid
from flexapod.model import Leg, Payload, Robot
from flexapod.proof.engines.exudyn_robot import RobotProblem, RobotResult
from flexapod.proof.engines.exudyn_system import CARRIAGE_MASS, System, exu, items
from flexapod.typing import Array

__all__ = ["solve"]


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
    home = np.array([0.0, 0.0, robot.home_height])
    start = robot.payload.com + home
    body = _payload(system, robot.payload, start, robot.gravity)
    frames = rigid.home_frames(robot)
    legs = [_leg(system, problem, i, frames[i], lengths[:, i], body) for i in range(len(robot.legs))]
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
            robot, frames, system.records([leg.coordinates for leg in legs]), system.records([leg.tip for leg in legs])
        ),
        seconds=seconds,
    )


def _payload(system: System, payload: Payload, place: Array, gravity: Array) -> int:
    J = payload.inertia
    node = system.mbs.AddNode(items.NodeRigidBodyEP(referenceCoordinates=[*place, 1.0, 0.0, 0.0, 0.0]))
    body = system.mbs.AddObject(
        items.ObjectRigidBody(
            mass=payload.mass, inertia=[J[0, 0], J[1, 1], J[2, 2], J[1, 2], J[0, 2], J[0, 1]], nodeNumber=node
        )
    )
    system.weigh(body, gravity)
    return body


def _leg(system: System, problem: RobotProblem, i: int, frame: Array, length: Array, body: int) -> _LegNumbers:
    """One leg with its drive, joined to the platform; `length` (T,) [m] is commanded."""
    mbs, robot = system.mbs, problem.robot
    leg, base, flexible = robot.legs[i], robot.base_joints[i], problem.elements > 0
    inner = length[0] - leg.piston.length
    slide = inner if flexible else length[0]
    node = mbs.AddNode(
        items.NodeGenericODE2(
            referenceCoordinates=[0.0, 0.0, slide],
            initialCoordinates=[0.0] * 3,
            initialCoordinates_t=[0.0] * 3,
            numberOfODE2Coordinates=3,
        )
    )
    tree = _tree(system, node, leg, robot, base, frame, flexible=flexible)
    carried = mbs.AddMarker(items.MarkerKinematicTreeRigid(objectNumber=tree, linkNumber=2, localPosition=[0.0] * 3))
    if flexible:
        nodes = _piston(system, problem, leg, base + frame[:, 2] * inner, frame[:, 2], tree, inner)
        first, end = (mbs.AddMarker(items.MarkerNodePosition(nodeNumber=nodes[k])) for k in (0, -1))
        mbs.AddObject(items.ObjectJointSpherical(markerNumbers=[carried, first]))
        tip = system.watch_node(nodes[-1], exu.OutputVariableType.Position)
    else:
        end = carried
        tip = mbs.AddSensor(
            items.SensorMarker(
                markerNumber=end,
                outputVariableType=exu.OutputVariableType.Position,
                storeInternal=True,
                writeToFile=False,
            )
        )
    place = robot.platform_joints[i] - robot.payload.com
    joint = mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=body, localPosition=place))
    mbs.AddObject(items.ObjectJointSpherical(markerNumbers=[joint, end]))
    drive = system.drive(node, 2, length - length[0])
    return _LegNumbers(
        coordinates=system.watch_node(node, exu.OutputVariableType.Coordinates),
        drive=system.watch_force(drive),
        tip=tip,
    )


def _tree(system: System, node: int, leg: Leg, robot: Robot, base: Array, frame: Array, *, flexible: bool) -> int:
    """Cross, cylinder and piston or carriage: turns about x and y of the leg's home frame, then a slide along z."""
    cylinder, piston, none = leg.cylinder, leg.piston, np.zeros((3, 3))
    across = piston.mass * piston.length**2 / 12
    rod = none if flexible else np.diag([across, across, 0.0])
    tube = np.diag([cylinder.inertia, cylinder.inertia, cylinder.axial_inertia + piston.axial_inertia])
    joint = exu.JointType
    return system.mbs.AddObject(
        items.ObjectKinematicTree(
            nodeNumber=node,
            gravity=robot.gravity,
            baseOffset=base,
            jointTypes=[joint.RevoluteX, joint.RevoluteY, joint.PrismaticZ],
            linkParents=[-1, 0, 1],
            jointTransformations=exu.Matrix3DList([frame, np.eye(3), np.eye(3)]),
            jointOffsets=exu.Vector3DList([[0.0] * 3] * 3),
            linkInertiasCOM=exu.Matrix3DList([none, tube, rod]),
            linkCOMs=exu.Vector3DList(
                [[0.0] * 3, [0.0, 0.0, cylinder.com], [0.0, 0.0, 0.0 if flexible else -piston.length / 2]]
            ),
            linkMasses=[0.0, cylinder.mass, CARRIAGE_MASS if flexible else piston.mass],
        )
    )


def _piston(
    system: System, problem: RobotProblem, leg: Leg, start: Array, axis: Array, tree: int, inner: float
) -> list[int]:
    """Chain of cables from the inner end on, with the rings that guide it; its nodes."""
    mbs, piston, count = system.mbs, leg.piston, problem.elements
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
            items.MarkerKinematicTreeRigid(objectNumber=tree, linkNumber=1, localPosition=[0.0, 0.0, place])
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


def _tip_deflection(robot: Robot, frames: Array, coordinates: Array, tips: Array) -> Array:
    """Tips (T, legs, 3) [m] seen from the axes of the cylinders at `coordinates` (T, legs, 3), (T, legs, 2) [m]."""
    turns = rigid.leg_rotations(frames, coordinates[..., 0], coordinates[..., 1])
    return np.einsum("tnij,tni->tnj", turns, tips - robot.base_joints)[..., :2]
