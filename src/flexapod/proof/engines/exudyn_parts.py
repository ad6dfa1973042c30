"""Parts of a leg that give way in Exudyn's terms: springs at its joints, screws, servos. Imports Exudyn.

Along and across a leg a joint at the base is two or three slides of the kinematic tree, between hinges and cylinder;
at the platform a connector of springs in the axes of the cylinder. A screw is a mass that turns, as travel of its nut,
and a spring whose stiffness follows the commanded length.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod.elements.springs import Place, before_piston, in_series, springs_along
from flexapod.model import Leg
from flexapod.proof.engines.exudyn_friction import rub_coordinate
from flexapod.proof.engines.exudyn_system import System, items
from flexapod.typing import Array

SCREW_END = 1e-2  # kg, of the screw at its nut, as travel: next to nothing beside a rotor of hundreds


@dataclass(frozen=True, kw_only=True)
class SoftEnd:
    """Springs [N/m] and dampers [N s/m] at an end of a leg, across and along it; 0 where the end is rigid."""

    across: float
    along: float
    across_damping: float
    along_damping: float

    @property
    def slides(self) -> list[int]:
        """Directions in which it gives way, of 0, 1, 2."""
        return [0, 1] * bool(self.across) + [2] * bool(self.along)

    @property
    def stiffness(self) -> Array:
        """Of the three directions, (3,)."""
        return np.array([self.across, self.across, self.along])

    @property
    def damping(self) -> Array:
        """Of the three directions, (3,)."""
        return np.array([self.across_damping, self.across_damping, self.along_damping])


def soft_end(leg: Leg, at: Place) -> SoftEnd:
    """What gives way at the base or the platform end of a leg."""
    joint = leg.base_joint if at == "base" else leg.platform_joint
    across = joint.across_and_along[0] if joint.across_and_along else 0.0
    along = in_series([x for x in springs_along(leg) if x.at == at], 0.0, 0.0)
    damping = joint.stiffness_damping or 0.0
    return SoftEnd(across=across, along=along[0], across_damping=damping * bool(across), along_damping=along[1])


def hold_slides(system: System, node: int, first: int, end: SoftEnd) -> None:
    """Springs on the slides of the base joint, coordinates of a node from the number `first` on."""
    for k, direction in enumerate(end.slides):
        system.spring(
            (system.ground, system.coordinate(node, first + k)), end.stiffness[direction], end.damping[direction]
        )


def hold_platform(system: System, tip: int, joint: int, end: SoftEnd) -> int | None:
    """Join the markers of a leg's tip, in axes of the cylinder, and of the platform joint; its springs, if any."""
    mbs, held = system.mbs, [int(k not in end.slides) for k in range(3)]
    if not end.slides:
        mbs.AddObject(items.ObjectJointSpherical(markerNumbers=[joint, tip]))
    elif any(held):
        mbs.AddObject(items.ObjectJointGeneric(markerNumbers=[tip, joint], constrainedAxes=[*held, 0, 0, 0]))
    if not end.slides:
        return None
    turns = np.zeros(3)
    return mbs.AddObject(
        items.ObjectConnectorRigidBodySpringDamper(
            markerNumbers=[tip, joint],
            stiffness=np.diag([*end.stiffness, *turns]),
            damping=np.diag([*end.damping, *turns]),
        )
    )


def drive(system: System, leg: Leg, slide: int, length: Array) -> int:
    """Let a leg's drive take the marker of its slide along the commanded `length` (T,) [m].

    The connector whose force is that on the piston.
    """
    travel, screw, springs = length - length[0], leg.screw, before_piston(leg)
    if leg.drive.friction is not None and screw is None:
        rub_coordinate(system, slide, leg.drive.friction.numbers)
    if screw is None and not springs:
        return system.hold(slide, travel)
    if screw is None:
        at = length if leg.cylinder_of_oil is not None else length[:1]  # what else is in series is the same everywhere
        stiffness, damping = np.array([in_series(springs, x, 0.0) for x in at]).T
        return system.spring((system.ground, slide), stiffness, damping, travel)
    rotor = _mass(system, screw.inertia / screw.per_turn**2)
    if screw.holds:
        system.hold(rotor, travel)
    else:
        system.spring((system.ground, rotor), *screw.loop_spring, travel)
    along, end = [x for x in springs_along(leg) if x.at == "nut"], rotor
    if screw.friction is not None:  # it acts where the shaft is wound up, at the nut
        twist = [x for x in along if x.name == "twist"]
        along, end = [x for x in along if x.name != "twist"], _mass(system, SCREW_END)
        system.spring((rotor, end), *np.array([in_series(twist, x, 0.0) for x in length]).T)
        torque, _, presliding, excess, slower, viscous, time = screw.friction.numbers
        turn = screw.per_turn
        rub_coordinate(
            system, end, (torque / turn, 0.0, presliding * turn, excess, slower / turn, viscous / turn**2, time)
        )
    stiffness, damping = np.array([in_series(along, x, 0.0) for x in length]).T
    return system.spring((end, slide), stiffness, damping)


def _mass(system: System, mass: float) -> int:
    """The coordinate of a mass that moves along a line."""
    node = system.mbs.AddNode(items.Node1D(referenceCoordinates=[0.0]))
    system.mbs.AddObject(items.ObjectMass1D(physicsMass=mass, nodeNumber=node))
    return system.coordinate(node, 0)
