"""The locked robot at a pose as a deck: flexible pistons, rigid cylinders and payload, springs at joints.

Rigid bodies are point masses joined by equations. The piston outside its cylinder is a square bar of solid elements
with the piston's EA, EI and rhoA; what is inside can only stretch, so it is springs and masses on the leg's axis.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr

from flexapod.common.arrays import Array
from flexapod.model import Rectangle
from flexapod.output.exchange.decks import Deck, Term, Tie, cross_matrix, dependent_displacements, number
from flexapod.output.exchange.decks_legs import LegAtPose, PayloadAtPose
from flexapod.solve.fem.hexahedra import extrude_section
from flexapod.solve.fem.section_mesh import section_mesh

Carriers = dict[Term, Array]
"""The displacements in which the payload is free, each with the motion (6,) that it causes, see `write_payload`."""

_NOTHING = 1e-9  # of a length, of a mass
_ROUNDING = 1e-13  # of the largest second moment of a body
_NEAR = 1e-3  # of the leg: a spring that short has no direction to rely on
_BEHIND = 0.05  # of the leg: where the drive of a piston is anchored that ends at the universal joint


@dataclass(frozen=True, kw_only=True)
class _GuidedNode:
    """A node whose displacement along `directions` is `motion` (k, n) @ the motions of its leg.

    `directions` (k, 3), or (1, 1) of a node that moves along x alone.
    """

    node: int
    directions: Array
    motion: Array


def point_masses(mass: float, inertia: Array) -> tuple[Array, Array]:
    """Point masses (n,) [kg] at places (n, 3) [m] about the origin, with mass, centre and inertia of a body.

    A sixth of the mass at each of +-sqrt(3 c / m) on a principal axis, c the second moment of the mass along it (half
    the trace of the inertia (3, 3) about the centre [kg m^2] less the moment about that axis); in the centre what a
    flat or thin body leaves.
    """
    moments, axes = np.linalg.eigh(0.5 * np.trace(inertia) * np.eye(3) - inertia)
    reach = np.sqrt(3 * np.maximum(moments, 0.0) / mass)
    extended = moments > _ROUNDING * max(moments.max(), np.finfo(float).tiny)
    arms = (axes * reach).T[extended]
    rest = mass * (1 - extended.sum() / 3)
    places = np.vstack([arms, -arms, np.zeros((1 if rest > _NOTHING * mass else 0, 3))])
    return places, np.append(np.full(2 * len(arms), mass / 6), [rest] * (len(places) - 2 * len(arms)))


def write_payload(deck: Deck, payload: PayloadAtPose, held: NDArray[np.bool_]) -> Carriers:
    """The payload as point masses that move as one body; `held` (6,): motions that it does not have, world axes.

    Gives six displacements, fewer where some motions are held, and of each the motion it causes with the others zero:
    of the centre of mass [1], and rotation [1/m], world axes.
    """
    places, masses = point_masses(payload.mass, payload.inertia)
    nodes = _masses(deck, payload.com + places, masses, "PAYLOAD")
    motion = np.vstack([np.hstack([np.eye(3), cross_matrix(r)]) for r in places])
    terms = [(node, axis) for node in nodes for axis in (1, 2, 3)]
    free = np.sort(qr(motion[:, ~held].T, mode="r", pivoting=True)[-1][: (~held).sum()])
    causes = np.zeros((6, len(free)))
    causes[~held] = np.linalg.inv(motion[np.ix_(free, np.flatnonzero(~held))])
    carriers = {terms[j]: causes[:, k] for k, j in enumerate(free)}
    share = motion @ causes
    deck.comment("The payload moves as one body:")
    deck.equations(
        {
            terms[i]: {term: float(x) for term, x in zip(carriers, share[i], strict=True) if abs(x) > 1e-12}
            for i in range(len(terms))
            if terms[i] not in carriers
        }
    )
    return carriers


def _masses(deck: Deck, points: Array, masses: Array, name: str) -> list[int]:
    """Nodes with point masses, a set for each value."""
    nodes = [int(node) for node in deck.nodes(points, name)]
    for i, mass in enumerate(np.unique(masses), start=1):
        deck.mass([node for node, m in zip(nodes, masses, strict=True) if m == mass], float(mass), f"{name}{i}")
    return nodes


def write_leg(deck: Deck, leg: LegAtPose, name: str, count: int, payload: PayloadAtPose, carriers: Carriers) -> None:
    """A leg, with `count` solid elements along the free piston; `carriers` from `write_payload`."""
    deck.comment("", f"{name}: {leg.length:.6g} m from joint to joint, {leg.free_length:.6g} m of the piston free.")
    mouth, tip = _free_piston(deck, leg, name, count)
    guided = [*mouth, *_inner_piston(deck, leg, name, count), *_cylinder(deck, leg, name), *_foot(deck, leg, name)]
    deck.comment("The cylinder turns about its joint, the piston slides in it, the payload holds the tip:")
    deck.equations(
        dependent_displacements([_guide(guided), _joint(deck, leg, tip, payload, carriers, name)], keep=carriers.keys())
    )


def drive_shift(leg: LegAtPose, name: str) -> list[str]:
    """Lines of *BOUNDARY in a step: the anchor of the drive's spring moves until the spring pushes with its force."""
    shift = leg.force / leg.drive_spring * leg.axes[:, 2] if leg.force else np.zeros(3)
    if leg.carriage is not None and leg.carriage.force:
        shift, name = leg.carriage.force / leg.carriage.spring * leg.carriage.direction, f"{name}FOOT"
    return [f"{name}BASE, {axis}, {axis}, {number(x)}" for axis, x in enumerate(shift, start=1) if x]


def _turned(leg: LegAtPose, point: Array) -> Array:
    """Displacements (3, k) of a point of the cylinder by the motions of the leg but those of the piston."""
    turns = cross_matrix(point - leg.base) @ leg.turns.T / leg.length
    return np.column_stack([_carriage_motion(leg, point), turns, leg.base_gives.T])


def _carriage_motion(leg: LegAtPose, point: Array) -> Array:
    """Displacement (3, 1) of a point of the cylinder by a compliant carriage; (3, 0) without one."""
    foot = leg.carriage
    return np.zeros((3, 0)) if foot is None else (foot.direction + np.cross(foot.turn, point - leg.base))[:, None]


def _cylinder_node(leg: LegAtPose, node: int, point: Array, *, slides: bool) -> _GuidedNode:
    """A node on the cylinder, or on a section of the piston that slides in it."""
    z = leg.axes[:, 2]
    turn = np.cross(z, point - leg.base)[:, None] / leg.side if leg.piston_turns else np.zeros((3, 0))
    motion = np.column_stack([_turned(leg, point), z * slides, turn * slides])
    return _GuidedNode(node=node, directions=np.eye(3), motion=motion)


def _spring_node(deck: Deck, motion: Array, stiffness: float, size: float, name: str) -> _GuidedNode:
    """A node that moves along x by the one motion of `motion` (n,), `size` [m] times an angle or 1, sprung."""
    node = int(deck.nodes(np.zeros(3), name)[0])
    deck.write("*BOUNDARY", f"{node}, 2, 3")
    deck.ground_spring(node, stiffness / size**2, name)
    return _GuidedNode(node=node, directions=np.eye(1), motion=motion[None])


def _foot(deck: Deck, leg: LegAtPose, name: str) -> list[_GuidedNode]:
    """Write the compliance at the base: springs of the joint, mass and drive of a carriage."""
    moves, gives = leg.carriage is not None, len(leg.base_gives)
    motions = np.eye(moves + len(leg.turns) + gives + 1 + leg.piston_turns)[moves:]
    found = [
        _spring_node(deck, motions[k], stiffness, leg.length, f"{name}TURN{k + 1}")
        for k, stiffness in enumerate(leg.turn_springs)
        if stiffness
    ]
    found += [
        _spring_node(deck, motions[len(leg.turns) + k], stiffness, 1.0, f"{name}GIVES{k + 1}")
        for k, stiffness in enumerate(leg.base_springs)
    ]
    if leg.carriage is not None:
        place, anchor = leg.base, leg.base - _BEHIND * leg.length * leg.carriage.direction
        node, held = (int(deck.nodes(at, f"{name}{part}")[0]) for at, part in ((place, "SLIDE"), (anchor, "FOOT")))
        deck.fix_nodes([held])
        if leg.carriage.mass:
            deck.mass([node], leg.carriage.mass, f"{name}CARRIAGE")
        if leg.carriage.spring:
            deck.springs([(held, node)], leg.carriage.spring, f"{name}FOOTDRIVE")
        found.append(_cylinder_node(leg, node, place, slides=False))
    return found


def _free_piston(
    deck: Deck, leg: LegAtPose, name: str, count: int
) -> tuple[list[_GuidedNode], list[tuple[int, Array]]]:
    """Write the piston outside the cylinder: nodes of its section at the mouth, nodes and places of that at the tip."""
    square = section_mesh(Rectangle(width=leg.side, height=leg.side), leg.side, "hex20")
    part = extrude_section(square, leg.free_length, count)
    points = leg.axis_points(leg.mouth) + part.nodes @ leg.axes[:, [2, 0, 1]].T
    nodes = deck.nodes(points, name)
    deck.elements("C3D20", nodes[part.elements.astype(np.int64)], f"{name}FREE")
    deck.solid_section(f"{name}FREE", E=leg.EA / leg.side**2, density=leg.rhoA / leg.side**2)
    mouth, tip = part.plane(0), part.plane(1)
    clamped = [_cylinder_node(leg, int(nodes[i]), points[i], slides=True) for i in mouth]
    return clamped, [(int(nodes[i]), points[i]) for i in tip]


def _inner_piston(deck: Deck, leg: LegAtPose, name: str, count: int) -> list[_GuidedNode]:
    """Write the piston inside the cylinder: springs and masses on the axis, and the drive that holds its end."""
    depth = leg.piston_length - leg.free_length
    pieces = 2 * max(1, round(0.5 * count * depth / leg.free_length)) if depth > _NOTHING * leg.length else 0
    places = leg.mouth - np.linspace(0.0, depth, pieces + 1)
    points = leg.axis_points(places)
    nodes = [int(node) for node in deck.nodes(points, f"{name}AXIS")]
    if pieces:
        deck.springs(list(pairwise(nodes)), leg.EA * pieces / depth, f"{name}STRETCH")
        share = leg.rhoA * depth / pieces / 3  # Simpson's rule: mass, centre and inertia about the joint are exact
        deck.mass([nodes[0], nodes[-1]], share, f"{name}ENDS")
        deck.mass(nodes[1::2], 4 * share, f"{name}ODD")
        if pieces > 2:
            deck.mass(nodes[2:-1:2], 2 * share, f"{name}EVEN")
    across, still, driven = leg.axes[:, :2].T, np.zeros((2, 1 + leg.piston_turns)), []
    if leg.drive:
        place = leg.axis_points(0.0 if abs(places[-1]) > _NEAR * leg.length else -_BEHIND * leg.length)
        held = int(deck.nodes(place, f"{name}BASE")[0])
        deck.springs([(held, nodes[-1])], leg.drive_spring, f"{name}DRIVE")
        if leg.carriage is None and not len(leg.base_gives):
            deck.fix_nodes([held])
        else:
            driven = [_cylinder_node(leg, held, place, slides=False)]
    loose = [
        _GuidedNode(node=node, directions=across, motion=np.column_stack([across @ _turned(leg, point), still]))
        for node, point in zip(nodes[1:], points[1:], strict=True)
    ]
    return [_cylinder_node(leg, nodes[0], points[0], slides=True), *loose, *driven]


def _cylinder(deck: Deck, leg: LegAtPose, name: str) -> list[_GuidedNode]:
    if not leg.mass:
        return []
    z = leg.axes[:, 2]
    inertia = leg.inertia * np.eye(3) + (leg.axial_inertia - leg.inertia) * np.outer(z, z)
    places, masses = point_masses(leg.mass, inertia)
    points = leg.axis_points(leg.com) + places
    nodes = _masses(deck, points, masses, f"{name}CYLINDER")
    return [_cylinder_node(leg, node, point, slides=False) for node, point in zip(nodes, points, strict=True)]


def _guide(guided: Sequence[_GuidedNode]) -> Tie:
    """All that moves with carriage, base joint and the slide of the piston's section at the mouth."""
    terms = [(g.node, axis) for g in guided for axis in ((1, 2, 3) if g.directions.shape[1] == 3 else (1,))]
    rows = np.zeros((sum(len(g.directions) for g in guided), len(terms)))
    row = column = 0
    for g in guided:
        height, width = g.directions.shape
        rows[row : row + height, column : column + width] = g.directions
        row, column = row + height, column + width
    return Tie(terms=tuple(terms), rows=rows, motion=np.vstack([g.motion for g in guided]))


def _joint(
    deck: Deck, leg: LegAtPose, tip: Sequence[tuple[int, Array]], payload: PayloadAtPose, carriers: Carriers, name: str
) -> Tie:
    """The section at the tip turns about its middle as its joint allows; the middle moves with the payload."""
    ball = leg.ends is None
    axes = np.eye(3) if leg.ends is None else leg.ends
    turns = [np.column_stack([cross_matrix(point - leg.tip) @ axes.T / leg.side, leg.tip_gives.T]) for _, point in tip]
    arms = [np.hstack([np.eye(3), cross_matrix((leg.tip if ball else point) - payload.com)]) for _, point in tip]
    moved = np.column_stack([*carriers.values(), np.zeros((6, 0))])
    motions = np.eye(len(axes) + len(leg.tip_gives))
    springs = [
        _spring_node(deck, motions[k] * leg.length / leg.side, stiffness, leg.length, f"{name}END{k + 1}")
        for k, stiffness in enumerate(leg.end_springs)
        if stiffness
    ]
    springs += [
        _spring_node(deck, motions[len(axes) + k], stiffness, 1.0, f"{name}TIPGIVES{k + 1}")
        for k, stiffness in enumerate(leg.tip_springs)
    ]
    rows = np.zeros((3 * len(tip) + len(springs), 3 * len(tip) + len(springs) + len(carriers)))
    rows[:, : len(rows)] = np.eye(len(rows))
    rows[: 3 * len(tip), len(rows) :] = -np.vstack(arms) @ moved
    terms = [*((node, axis) for node, _ in tip for axis in (1, 2, 3)), *((s.node, 1) for s in springs)]
    return Tie(terms=(*terms, *carriers), rows=rows, motion=np.vstack([*turns, *(s.motion for s in springs)]))
