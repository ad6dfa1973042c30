"""The actuator in Exudyn's terms. Imports Exudyn: load it in a process of its own (`exudyn_process`).

Hub and slide are a kinematic tree: a hinge, then a slide that holds the inner end of a chain of planar ANCF cables.
Where the beam comes out, a sliding joint clamps it: the point of the chain that passes has the place and the direction
of the hub. A beam that is outside as a whole is clamped at its end.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from flexapod.proof.engines.exudyn_actuator import ActuatorProblem, ActuatorResult
from flexapod.proof.engines.exudyn_system import CARRIAGE_MASS, System, exu, items
from flexapod.typing import Array

_HUB = 1.0  # kg, kg m^2: of no consequence, its motion is prescribed


def solve(problem: ActuatorProblem) -> ActuatorResult:
    """Build the beam, integrate, and read the sensors."""
    actuator, plan = problem.study.actuator, problem.integration
    rotation, extension = problem.rotation, problem.extension
    system = System(plan)
    inner = actuator.free_length - actuator.length  # of the beam's inner end, from where it comes out
    node = system.mbs.AddNode(
        items.NodeGenericODE2(
            referenceCoordinates=[actuator.angle, actuator.hub_radius + inner],
            initialCoordinates=[0.0, 0.0],
            initialCoordinates_t=[rotation.rate[0], extension.rate[0]],
            numberOfODE2Coordinates=2,
        )
    )
    tree = _tree(system, node)
    places = _stations(problem)
    nodes, cables = _beam(system, problem, places)
    _hold(system, problem, places, cables, tree)
    system.hold(system.coordinate(node, 0), rotation.position)
    system.hold(system.coordinate(node, 1), extension.position)
    tip = system.watch_node(nodes[-1], exu.OutputVariableType.Position)
    seconds = system.solve(equilibrium=False)
    x, y, _ = system.records([tip])[:, 0].T
    c, s = np.cos(actuator.angle + rotation.position), np.sin(actuator.angle + rotation.position)
    return ActuatorResult(time=plan.time, tip_deflection=c * y - s * x, tip_distance=c * x + s * y, seconds=seconds)


def _tree(system: System, node: int) -> int:
    none, one = np.zeros((3, 3)), np.eye(3)
    return system.mbs.AddObject(
        items.ObjectKinematicTree(
            nodeNumber=node,
            jointTypes=[exu.JointType.RevoluteZ, exu.JointType.PrismaticX],
            linkParents=[-1, 0],
            jointTransformations=exu.Matrix3DList([one, one]),
            jointOffsets=exu.Vector3DList([[0.0] * 3] * 2),
            linkInertiasCOM=exu.Matrix3DList([_HUB * one, none]),
            linkCOMs=exu.Vector3DList([[0.0] * 3] * 2),
            linkMasses=[_HUB, CARRIAGE_MASS],
        )
    )


def _stations(problem: ActuatorProblem) -> Array:
    """Places of the nodes at t = 0 from where the beam comes out [m], one of them there: the start is consistent."""
    actuator = problem.study.actuator
    outside = np.linspace(0.0, actuator.free_length, problem.elements + 1)
    behind = actuator.length - actuator.free_length
    count = int(np.ceil(behind / outside[1] - 1e-9))
    return np.concatenate([np.linspace(-behind, 0.0, count + 1)[:-1], outside])


def _beam(system: System, problem: ActuatorProblem, places: Array) -> tuple[list[int], list[int]]:
    """Nodes and cables of the chain."""
    actuator, weight = problem.study.actuator, np.array([0.0, -problem.study.actuator.gravity, 0.0])
    nodes = [system.mbs.AddNode(_node(problem, x)) for x in places]
    stuff = {"rhoA": actuator.rhoA, "EI": actuator.EI, "EA": problem.axial_stiffness}
    joined = partial(system.cable, items.ObjectANCFCable2D, **stuff)
    return nodes, [joined(nodes[k : k + 2], size, gravity=weight) for k, size in enumerate(np.diff(places))]


def _node(problem: ActuatorProblem, x: float) -> object:
    """Node at x [m] from where the beam comes out: straight reference, initial displacement, and velocity.

    The start is the static shape under a tip force at rest in x over free length; bent without stretch.
    """
    actuator, spin, feed = problem.study.actuator, problem.rotation.rate[0], problem.extension.rate[0]
    L, tip = actuator.free_length, problem.study.initial.tip_displacement
    zeta = max(x, 0.0) / L
    v, slope, bend = (
        tip / 2 * np.array([3 * zeta**2 - zeta**3, (6 * zeta - 3 * zeta**2) / L, (6 - 6 * zeta) / L**2 * (x > 0)])
    )
    drawn_back = -(tip**2) / (8 * L) * (12 * zeta**3 - 9 * zeta**4 + 9 / 5 * zeta**5)  # -1/2 int v'^2 dx
    c, s = np.cos(actuator.angle), np.sin(actuator.angle)
    hub = np.array([[c, -s], [s, c]])
    place = np.array([actuator.hub_radius + x + drawn_back, v])
    tangent = np.array([np.sqrt(1 - slope**2), slope])
    tangent_dot = np.array([-slope / tangent[0], 1.0]) * (bend * (1 - zeta) - slope / L) * feed * (x > 0)
    turned = spin * np.array([[0.0, -1.0], [1.0, 0.0]])
    place_dot = np.array([feed, slope * (1 - zeta) * feed]) + turned @ place
    straight = np.array([actuator.hub_radius + x, 0.0])
    return items.NodePoint2DSlope1(
        referenceCoordinates=[*(hub @ straight), c, s],
        initialCoordinates=[*(hub @ (place - straight)), *(hub @ (tangent - np.array([1.0, 0.0])))],
        initialVelocities=[*(hub @ place_dot), *(hub @ (tangent_dot + turned @ tangent))],
    )


def _hold(system: System, problem: ActuatorProblem, places: Array, cables: list[int], tree: int) -> None:
    """Inner end on the slide; the clamp where the beam comes out."""
    actuator, mbs = problem.study.actuator, system.mbs
    slide = mbs.AddMarker(items.MarkerKinematicTreeRigid(objectNumber=tree, linkNumber=1, localPosition=[0.0] * 3))
    end = mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=cables[0], localPosition=[0.0] * 3))
    behind = -places[0]
    turn = 0 if behind else 1
    mbs.AddObject(items.ObjectJointGeneric(markerNumbers=[slide, end], constrainedAxes=[1, 1, 0, 0, 0, turn]))
    if not behind:
        return
    shapes = [mbs.AddMarker(items.MarkerBodyCable2DCoordinates(bodyNumber=cable)) for cable in cables]
    mouth = mbs.AddMarker(
        items.MarkerKinematicTreeRigid(objectNumber=tree, linkNumber=0, localPosition=[actuator.hub_radius, 0.0, 0.0])
    )
    element = len(cables) - problem.elements  # the first one outside
    mbs.AddObject(
        items.ObjectJointSliding2D(
            markerNumbers=[mouth, shapes[element]],
            slidingMarkerNumbers=shapes,
            slidingMarkerOffsets=list(places[:-1] + behind),
            nodeNumber=system.sliding_data(element, behind),
            constrainRotation=True,
        )
    )
