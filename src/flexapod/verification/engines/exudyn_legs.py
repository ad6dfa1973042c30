"""Leg of a robot as a kinematic tree of Exudyn.

A leg is a kinematic tree in minimal coordinates: one hinge or the two of a universal joint, then a slide. Its
last link is the rigid piston, or a carriage of next to no mass that holds the inner end of a chain of ANCF
cables; two frictionless rings on the cylinder, one of them in its mouth, guide the chain. Along and across a
leg a compliant base joint is two or three slides between hinges and cylinder; one at the platform is springs in
the axes of the cylinder. A screw is a mass that turns, as travel of its nut, and a spring whose stiffness
follows the commanded length.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array
from flexapod.kinematics.rotations import exponential
from flexapod.mechanics.elements.springs import Place, Spring, series_stiffness, springs_along, springs_before_piston
from flexapod.model import Leg, Robot
from flexapod.verification.engines.exudyn_builder import CARRIAGE_MASS, Builder, CableChain, Link, Tree

SCREW_END = 1e-2  # kg, of the screw at its nut, as travel: next to nothing beside a rotor of hundreds
_TURNS, _SLIDES = ("RevoluteX", "RevoluteY"), ("PrismaticX", "PrismaticY", "PrismaticZ")


@dataclass(frozen=True, kw_only=True)
class EndSprings:
    """Springs [N/m] and dampers [N s/m] at an end of a leg, (3,) each, two across it and one along; 0: rigid."""

    stiffness: Array
    damping: Array

    @classmethod
    def from_leg(cls, leg: Leg, at: Place) -> EndSprings:
        """Build the springs and dampers at the base or the platform end of a leg."""
        joint = leg.base_joint if at == "base" else leg.platform_joint
        across = joint.across_and_along[0] if joint.across_and_along else 0.0
        along = series_stiffness([x for x in springs_along(leg) if x.at == at], 0.0, 0.0)
        damping = (joint.stiffness_damping or 0.0) * bool(across)
        return cls(stiffness=np.array([across, across, along[0]]), damping=np.array([damping, damping, along[1]]))

    @property
    def compliant_directions(self) -> list[int]:
        """Directions in which the end is compliant, of 0, 1, 2."""
        return np.flatnonzero(self.stiffness).tolist()


@dataclass(frozen=True, kw_only=True)
class LegSensors:
    """Sensors of a leg's coordinates, of the force of its drive and of the place of its tip."""

    coordinates: int
    drive: int
    tip: int


def turn_count(leg: Leg) -> int:
    """Number of axes of the base joint: two of a universal joint, one of a hinge."""
    return 1 if leg.letters.base == "R" else 2


def add_leg(
    builder: Builder, robot: Robot, i: int, length: Array, body: int, *, elements: int, guide: float
) -> LegSensors:
    """Leg i with its drive, joined to the platform, a body about its centre of mass; `length` (T,) [m] is commanded."""
    leg, flexible = robot.legs[i], elements > 0
    foot, head = EndSprings.from_leg(leg, "base"), EndSprings.from_leg(leg, "platform")
    follows = flexible and bool(head.compliant_directions or leg.platform_joint.friction)
    links, slide, inner = (
        _links(robot, i, foot, flexible, follows),
        turn_count(leg) + len(foot.compliant_directions),
        length[0],
    )
    rest = np.zeros(len(links))
    if flexible:
        rest[-1], inner = length[0], length[0] - leg.piston.length
    rest[slide] = inner
    tree = builder.tree(links, rest, place=robot.base_joints[i], gravity=robot.gravity)
    ends = [builder.link_marker(tree, link) for link in ([slide, slide + 3] if follows else [slide])]
    if flexible:
        chain = _piston(builder, robot, i, tree, slide - 1, inner, elements, guide)
        cable = [builder.node_marker(chain.nodes[k]) for k in (0, -1)]
        for of_tree, of_cable in zip(ends, cable, strict=False):
            builder.ball(of_tree, of_cable)
        ends.append(ends[-1] if follows else cable[-1])
    for k, direction in enumerate(foot.compliant_directions, start=turn_count(leg)):
        ground = builder.ground, builder.coordinate_marker(tree.node, k)
        builder.spring(ground, foot.stiffness[direction], foot.damping[direction])
    tip, joint = ends[-1], builder.body_marker(body, robot.platform_joints[i] - robot.payload.com)
    pressed = builder.normal_force(_held(builder, tip, joint, head))
    if leg.base_joint.friction is not None:
        for k in range(turn_count(leg)):
            builder.coordinate_friction(
                builder.coordinate_marker(tree.node, k), leg.base_joint.friction.numbers, pressed
            )
    if leg.platform_joint.friction is not None:
        builder.ball_friction(tip, joint, leg.platform_joint.friction.numbers, pressed)
    return LegSensors(
        drive=builder.add_sensor(
            "object", _driven(builder, leg, builder.coordinate_marker(tree.node, slide), length), "Force"
        ),
        coordinates=builder.add_sensor("node", tree.node, "Coordinates"),
        tip=builder.add_sensor("marker", tip, "Position"),
    )


def _tilt(limbs: kinematics.Limbs, i: int) -> Array:
    """Axes of a cylinder in its home frame, (3, 3): a hinge need not be square to its leg."""
    return exponential(np.array([0.0, limbs.home[i, kinematics.COORDINATES.index("beta")], 0.0]))


def _links(robot: Robot, i: int, foot: EndSprings, flexible: bool, follows: bool) -> list[Link]:
    """Cross, cylinder and piston or carriage.

    Turns about x and y of the leg's home frame, slides of the base joint, then a slide along z. A body of next to no
    mass that `follows` a flexible tip, with three slides in the cylinder, has its axes for the platform joint.
    """
    leg, limbs, still = robot.legs[i], kinematics.rigid_limbs(robot), np.eye(3)
    tube, rod, tilt = leg.cylinder, leg.piston, _tilt(limbs, i)
    joints = [*_TURNS[: turn_count(leg)], *(_SLIDES[k] for k in foot.compliant_directions)]
    frames = [limbs.frames[i], *[still] * (turn_count(leg) - 1), tilt, *[still] * len(foot.compliant_directions)]
    links = [Link(joint=joint, frame=frame) for joint, frame in zip(joints, frames, strict=False)]
    axes = still if foot.compliant_directions else tilt  # of the cylinder's link
    inertia = axes @ np.diag([tube.inertia, tube.inertia, tube.axial_inertia + rod.axial_inertia]) @ axes.T
    links[-1] = replace(links[-1], mass=tube.mass, com=tube.com * axes[:, 2], inertia=inertia)
    last = Link(joint="PrismaticZ", frame=frames[-1], mass=CARRIAGE_MASS)
    if not flexible:
        across = rod.mass * rod.length**2 / 12
        com, inertia = np.array([0.0, 0.0, -rod.length / 2]), np.diag([across, across, 0.0])
        last = replace(last, mass=rod.mass, com=com, inertia=inertia)
    if not follows:
        return [*links, last]
    x, y, z = (Link(joint=joint) for joint in _SLIDES)
    return [*links, last, replace(x, frame=axes, on=len(links) - 1), y, replace(z, mass=CARRIAGE_MASS)]


def _piston(
    builder: Builder, robot: Robot, i: int, tree: Tree, tube: int, inner: float, count: int, guide: float
) -> CableChain:
    """Chain of cables from the inner end on, with the rings on the link `tube` that guide it."""
    leg, rod, limbs = robot.legs[i], robot.legs[i].piston, kinematics.rigid_limbs(robot)
    tilt = _tilt(limbs, i)
    axis, k, size = limbs.frames[i] @ tilt[:, 2], np.arange(count + 1)[:, None], rod.length / count
    places = robot.base_joints[i] + axis * inner + axis * k * size
    rest = np.hstack([places, np.tile(axis, (count + 1, 1))])
    starts = np.asarray(size * k[:-1, 0], dtype=float)
    chain = builder.chain(rest, starts, size, rhoA=rod.rhoA, EI=rod.EI, EA=rod.EA, gravity=robot.gravity)
    along = np.array([0.0, 0.0, 1.0]) if tube >= turn_count(leg) else tilt[:, 2]
    for place in (leg.cylinder.mouth, leg.cylinder.mouth - guide):
        builder.ring(builder.link_marker(tree, tube, place * along), chain, place - inner)
    return chain


def _held(builder: Builder, tip: int, joint: int, end: EndSprings) -> int | None:
    """Join a leg's tip, in axes of the cylinder, and the platform joint; number of its springs, if any."""
    if not end.compliant_directions:
        builder.ball(joint, tip)
        return None
    if len(end.compliant_directions) < 3:
        builder.joint(tip, joint, [*(int(k not in end.compliant_directions) for k in range(3)), 0, 0, 0])
    return builder.bushing(tip, joint, end.stiffness, end.damping)


def _driven(builder: Builder, leg: Leg, slide: int, length: Array) -> int:
    """Let a leg's drive take the coordinate of its slide along the commanded `length` (T,) [m].

    The connector whose force is that on the piston.
    """
    travel, screw, springs = length - length[0], leg.screw, springs_before_piston(leg)
    if leg.drive.friction is not None and screw is None:
        builder.coordinate_friction(slide, leg.drive.friction.numbers)
    if screw is None and not springs:
        return builder.prescribe_coordinate(slide, travel)
    if screw is None:
        at = length if leg.cylinder_of_oil is not None else length[:1]  # what else is in series is the same everywhere
        return builder.spring((builder.ground, slide), *_along(springs, at), travel)
    rotor = builder.mass(screw.inertia / screw.per_turn**2)
    if screw.holds:
        builder.prescribe_coordinate(rotor, travel)
    else:
        builder.spring((builder.ground, rotor), *screw.loop_spring, travel)
    along, end = [x for x in springs_along(leg) if x.at == "nut"], rotor
    if screw.friction is not None:  # it acts where the shaft is wound up, at the nut
        twist = [x for x in along if x.name == "twist"]
        along, end = [x for x in along if x.name != "twist"], builder.mass(SCREW_END)
        builder.spring((rotor, end), *_along(twist, length))
        torque, _, presliding, excess, slower, viscous, time = screw.friction.numbers
        turn = screw.per_turn
        builder.coordinate_friction(
            end, (torque / turn, 0.0, presliding * turn, excess, slower / turn, viscous / turn**2, time)
        )
    return builder.spring((end, slide), *_along(along, length))


def _along(springs: list[Spring], lengths: Array) -> tuple[Array, Array]:
    """Stiffness and damping, (T,) each, of springs in series at lengths of the leg (T,)."""
    stiffness, damping = np.array([series_stiffness(springs, x, 0.0) for x in lengths]).T
    return stiffness, damping
