"""The locked robot at a pose as a deck: flexible pistons, rigid cylinders and payload, ideal joints.

Rigid bodies are point masses joined by equations. The piston outside its cylinder is a square bar of solid elements
with the piston's EA, EI and rhoA; what is inside can only stretch, so it is springs and masses on the leg's axis.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.linalg import qr

from flexapod.exchange.decks import Deck, Term, number
from flexapod.exchange.decks_ties import Tie, cross_matrix, solved
from flexapod.fem.mesh import extruded
from flexapod.fem.section_mesh import section_mesh
from flexapod.model import Rectangle
from flexapod.typing import Array

__all__ = ["Carriers", "LegAtPose", "PayloadAtPose", "drive_shift", "point_masses", "write_leg", "write_payload"]

Carriers = dict[Term, Array]
"""The six displacements in which the payload is free, each with the motion (6,) that it causes, see `write_payload`."""

_STIFF = 1e5  # of a locked drive, in EA / l: adds 1e-5 of a leg's compliance
_NOTHING = 1e-9  # of a length, of a mass
_ROUNDING = 1e-13  # of the largest second moment of a body
_NEAR = 1e-3  # of the leg: a spring that short has no direction to rely on
_BEHIND = 0.05  # of the leg: where the drive of a piston is anchored that ends at the universal joint


@dataclass(frozen=True, kw_only=True)
class LegAtPose:
    """A leg at a pose, SI, world axes.

    `base`, `tip` (3,): its joints; `axes` (3, 3): columns x, y, z of the leg, z towards the tip; `first_axis` (3,) of
    the universal joint, whose second is y; `mouth`, `piston_length` [m]; `EA`, `EI`, `rhoA` of the piston; `mass`,
    `com`, `inertia`, `axial_inertia` of the cylinder; `drive` [N/m], inf for a prescribed stroke; `force` [N] that a
    force drive gives beside that spring.
    """

    base: Array
    tip: Array
    axes: Array
    first_axis: Array
    mouth: float
    piston_length: float
    EA: float
    EI: float
    rhoA: float
    mass: float
    com: float
    inertia: float
    axial_inertia: float
    drive: float
    force: float

    @property
    def length(self) -> float:
        """Joint to joint [m]."""
        return float(np.linalg.norm(self.tip - self.base))

    @property
    def free_length(self) -> float:
        """Of the piston, outside the cylinder [m]."""
        return self.length - self.mouth

    @property
    def side(self) -> float:
        """Side of the square bar that has the piston's EI / EA [m]."""
        return float(np.sqrt(12 * self.EI / self.EA))

    @property
    def drive_spring(self) -> float:
        """Stiffness of the spring that holds the piston's end [N/m]."""
        return min(self.drive, _STIFF * self.EA / self.length)

    def at(self, place: float | Array) -> Array:
        """Points on the axis at distances from the universal joint, (3,) or (n, 3) [m]."""
        return self.base + np.multiply.outer(place, self.axes[:, 2])


@dataclass(frozen=True, kw_only=True)
class PayloadAtPose:
    """The payload at a pose: `mass` [kg], `com` (3,) [m], `inertia` (3, 3) [kg m^2] about it, world axes."""

    mass: float
    com: Array
    inertia: Array


@dataclass(frozen=True, kw_only=True)
class _Guided:
    """A node whose displacement along `directions` (k, 3) is `motion` (k, 3) @ (l alpha, l beta, slide)."""

    node: int
    directions: Array
    motion: Array


def point_masses(mass: float, inertia: Array) -> tuple[Array, Array]:
    """Point masses about the origin with the mass, the centre and the inertia of a body.

    A sixth of the mass at each of +-sqrt(3 c / m) on a principal axis, c the second moment of the mass along it (half
    the trace of the inertia less the moment about that axis); in the centre what a flat or thin body leaves.

    Parameters
    ----------
    mass : float
        [kg]
    inertia : ndarray, shape (3, 3)
        About the centre of mass [kg m^2].

    Returns
    -------
    places : ndarray, shape (n, 3)
        [m]
    masses : ndarray, shape (n,)
        [kg]
    """
    moments, axes = np.linalg.eigh(0.5 * np.trace(inertia) * np.eye(3) - inertia)
    reach = np.sqrt(3 * np.maximum(moments, 0.0) / mass)
    extended = moments > _ROUNDING * max(moments.max(), np.finfo(float).tiny)
    arms = (axes * reach).T[extended]
    rest = mass * (1 - extended.sum() / 3)
    places = np.vstack([arms, -arms, np.zeros((1 if rest > _NOTHING * mass else 0, 3))])
    return places, np.append(np.full(2 * len(arms), mass / 6), [rest] * (len(places) - 2 * len(arms)))


def write_payload(deck: Deck, payload: PayloadAtPose) -> Carriers:
    """The payload as point masses that move as one body.

    Returns
    -------
    dict
        Six displacements, and of each the motion it causes with the others zero: of the centre of mass [1], and
        rotation [1/m], world axes.
    """
    places, masses = point_masses(payload.mass, payload.inertia)
    nodes = _masses(deck, payload.com + places, masses, "PAYLOAD")
    motion = np.vstack([np.hstack([np.eye(3), cross_matrix(r)]) for r in places])
    terms = [(node, axis) for node in nodes for axis in (1, 2, 3)]
    free = np.sort(qr(motion.T, mode="r", pivoting=True)[-1][:6])
    causes = np.asarray(np.linalg.inv(motion[free]), dtype=np.float64)
    carriers = {terms[j]: causes[:, k] for k, j in enumerate(free)}
    share = motion @ causes
    deck.say("The payload moves as one body:")
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
    deck.say("", f"{name}: {leg.length:.6g} m from joint to joint, {leg.free_length:.6g} m of the piston free.")
    mouth, tip = _free_piston(deck, leg, name, count)
    guided = [*mouth, *_inside(deck, leg, name, count), *_cylinder(deck, leg, name)]
    deck.say("The cylinder turns about its joint, the piston slides in it, the payload holds the tip:")
    deck.equations(solved([_guide(guided), _joint(leg, tip, payload, carriers)], keep=carriers.keys()))


def drive_shift(leg: LegAtPose, name: str) -> list[str]:
    """Lines of *BOUNDARY in a step: the anchor of the drive's spring moves until the spring pushes with its force."""
    shift = leg.force / leg.drive_spring * leg.axes[:, 2] if leg.force else np.zeros(3)
    return [f"{name}BASE, {axis}, {axis}, {number(x)}" for axis, x in enumerate(shift, start=1) if x]


def _turned(leg: LegAtPose, point: Array) -> Array:
    """Displacement (3, 2) of a point by the two angles of the universal joint times the leg's length."""
    return cross_matrix(point - leg.base) @ np.column_stack([leg.first_axis, leg.axes[:, 1]]) / leg.length


def _carried(leg: LegAtPose, node: int, point: Array, *, slides: bool) -> _Guided:
    """A node on the cylinder, or on a section of the piston that slides in it without turning."""
    motion = np.column_stack([_turned(leg, point), leg.axes[:, 2] * slides])
    return _Guided(node=node, directions=np.eye(3), motion=motion)


def _free_piston(deck: Deck, leg: LegAtPose, name: str, count: int) -> tuple[list[_Guided], list[tuple[int, Array]]]:
    """The part outside: its section at the mouth, and nodes and places of that at the tip."""
    square = section_mesh(Rectangle(width=leg.side, height=leg.side), leg.side, "hex20")
    part = extruded(square, leg.free_length, count)
    points = leg.at(leg.mouth) + part.nodes @ leg.axes[:, [2, 0, 1]].T
    nodes = deck.nodes(points, name)
    deck.elements("C3D20", nodes[part.elements.astype(np.int64)], f"{name}FREE")
    deck.solid(f"{name}FREE", E=leg.EA / leg.side**2, density=leg.rhoA / leg.side**2)
    mouth, tip = part.plane(0), part.plane(1)
    clamped = [_carried(leg, int(nodes[i]), points[i], slides=True) for i in mouth]
    return clamped, [(int(nodes[i]), points[i]) for i in tip]


def _inside(deck: Deck, leg: LegAtPose, name: str, count: int) -> list[_Guided]:
    """The part inside, springs and masses on the axis, and the drive that holds its end."""
    depth = leg.piston_length - leg.free_length
    pieces = 2 * max(1, round(0.5 * count * depth / leg.free_length)) if depth > _NOTHING * leg.length else 0
    places = leg.mouth - np.linspace(0.0, depth, pieces + 1)
    points = leg.at(places)
    nodes = [int(node) for node in deck.nodes(points, f"{name}AXIS")]
    if pieces:
        deck.springs(list(pairwise(nodes)), leg.EA * pieces / depth, f"{name}STRETCH")
        share = leg.rhoA * depth / pieces / 3  # Simpson's rule: mass, centre and inertia about the joint are exact
        deck.mass([nodes[0], nodes[-1]], share, f"{name}ENDS")
        deck.mass(nodes[1::2], 4 * share, f"{name}ODD")
        if pieces > 2:
            deck.mass(nodes[2:-1:2], 2 * share, f"{name}EVEN")
    anchor = 0.0 if abs(places[-1]) > _NEAR * leg.length else -_BEHIND * leg.length
    held = int(deck.nodes(leg.at(anchor), f"{name}BASE")[0])
    deck.fixed([held])
    deck.springs([(held, nodes[-1])], leg.drive_spring, f"{name}DRIVE")
    across = leg.axes[:, :2].T
    loose = [
        _Guided(node=node, directions=across, motion=np.column_stack([across @ _turned(leg, point), np.zeros(2)]))
        for node, point in zip(nodes[1:], points[1:], strict=True)
    ]
    return [_carried(leg, nodes[0], points[0], slides=True), *loose]


def _cylinder(deck: Deck, leg: LegAtPose, name: str) -> list[_Guided]:
    if not leg.mass:
        return []
    z = leg.axes[:, 2]
    inertia = leg.inertia * np.eye(3) + (leg.axial_inertia - leg.inertia) * np.outer(z, z)
    places, masses = point_masses(leg.mass, inertia)
    points = leg.at(leg.com) + places
    nodes = _masses(deck, points, masses, f"{name}CYLINDER")
    return [_carried(leg, node, point, slides=False) for node, point in zip(nodes, points, strict=True)]


def _guide(guided: Sequence[_Guided]) -> Tie:
    """All that moves with the cylinder's two angles and the slide of the piston's section at the mouth."""
    rows = np.zeros((sum(len(g.directions) for g in guided), 3 * len(guided)))
    row = 0
    for i, g in enumerate(guided):
        rows[row : row + len(g.directions), 3 * i : 3 * i + 3] = g.directions
        row += len(g.directions)
    terms = tuple((g.node, axis) for g in guided for axis in (1, 2, 3))
    return Tie(terms=terms, rows=rows, motion=np.vstack([g.motion for g in guided]))


def _joint(leg: LegAtPose, tip: Sequence[tuple[int, Array]], payload: PayloadAtPose, carriers: Carriers) -> Tie:
    """The section at the tip turns about its middle, which moves with the payload."""
    arm = np.hstack([np.eye(3), cross_matrix(leg.tip - payload.com)])
    held = arm @ np.column_stack(list(carriers.values()))
    rows = np.hstack([np.eye(3 * len(tip)), np.tile(-held, (len(tip), 1))])
    terms = tuple((node, axis) for node, _ in tip for axis in (1, 2, 3))
    turns = np.vstack([cross_matrix(point - leg.tip) / leg.side for _, point in tip])
    return Tie(terms=(*terms, *carriers), rows=rows, motion=turns)
