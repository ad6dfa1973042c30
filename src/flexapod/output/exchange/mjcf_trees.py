"""Legs of a robot as trees of bodies for MuJoCo: each coordinate that moves and each compliance is a joint."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from flexapod import kinematics
from flexapod.common.arrays import Array
from flexapod.kinematics.rotations import exponential, quaternion
from flexapod.model import Leg, Robot

#: kg, kg m^2: MuJoCo takes no body without mass; a million times a million below a real leg.
LEAST = 1e-12
ACROSS, ALONG = np.eye(3)[:2], np.eye(3)[2]


@dataclass(frozen=True, kw_only=True)
class JointSpring:
    """A spring in a joint: `stiffness` [N/m, N m/rad], `damping` [N s/m, N m s/rad], `armature` [kg, kg m^2]."""

    stiffness: float = 0.0
    damping: float = 0.0
    armature: float = 0.0

    @property
    def text(self) -> str:
        """MJCF attributes of the spring that are not 0."""
        given = ((name, getattr(self, name)) for name in ("stiffness", "damping", "armature"))
        return "".join(f' {name}="{numbers(value)}"' for name, value in given if value)


@dataclass(frozen=True, kw_only=True)
class Bending:
    """Springs of a piston in the middle of its `free` part [m], where force and moment do not couple.

    `across`, `along` [N/m], `turn`, `twist` [N m/rad]; None: it does not twist.
    """

    free: float
    across: JointSpring
    along: JointSpring
    turn: JointSpring
    twist: JointSpring | None = None


@dataclass(frozen=True, kw_only=True)
class LegCompliance:
    """Compliance of a leg beside the coordinates of the rigid one.

    `joints`: springs by coordinate; `base`: at the base joint by leg axis, x, y, z; `piston`: None, it is one piece.
    `begin`: what the coordinate of the carriage is at home [m, rad].
    """

    joints: Mapping[str, JointSpring] = field(default_factory=dict)
    base: Mapping[str, JointSpring] = field(default_factory=dict)
    piston: Bending | None = None
    begin: float = 0.0


RIGID = LegCompliance()


@dataclass(frozen=True, kw_only=True)
class TreeBody:
    """A body: its frame in that of the one that carries it, joints and inertia as text, and what it carries."""

    name: str
    place: Array
    turn: Array
    joints: Sequence[str] = ()
    parts: Sequence[str] = ()
    inside: Sequence[TreeBody] = ()

    @property
    def text(self) -> str:
        """MJCF element of the body and of all that it carries."""
        start = f'<body name="{self.name}" pos="{numbers(self.place)}" quat="{numbers(quaternion(self.turn))}">'
        return "\n".join([start, *self.joints, *self.parts, *(body.text for body in self.inside), "</body>"])


def joint(name: str, kind: str, axis: Array, spring: JointSpring | None = None, more: str = "") -> str:
    """A joint about or along an axis of its body."""
    held = "" if spring is None else spring.text
    return f'<joint name="{name}" type="{kind}" axis="{numbers(axis)}"{more}{held}/>'


def leg_body(
    robot: Robot, limbs: kinematics.Limbs, i: int, gives: LegCompliance = RIGID, looks: bool = False
) -> TreeBody:
    """Leg i at home: `carriage`, `cylinder`, `piston`, of a piston that bends its outer part `bend`, and `tip`.

    A joint of a coordinate (`kinematics.COORDINATES`) has its name and the number of the leg: that of the carriage, of
    the cylinder on the base joint, of the piston on a slide along the leg, and, where the platform joint is not a ball,
    of the `tip` that follows. The frame of a piston has its origin at the platform joint; its coordinate is the length
    of the leg. `looks`: with capsules to see.
    """
    leg, number = robot.legs[i], i + 1
    moves: dict[str, bool] = dict(zip(kinematics.COORDINATES, limbs.unknown[i], strict=True))
    home: dict[str, float] = dict(zip(kinematics.COORDINATES, limbs.home[i], strict=True))
    tilt, none, still = np.array([0.0, home["beta"], 0.0]), np.zeros(3), np.eye(3)
    axes = {
        "alpha": exponential(-tilt)[:, 0],
        "beta": still[1],
        "spin": still[2],
        **{f"gamma{k}": axis for k, axis in enumerate(still, start=1)},
    }

    def moving_hinges(*names: str) -> list[str]:
        moving = [name for name in names if moves[name]]
        return [joint(f"{name}_{number}", "hinge", axes[name], gives.joints.get(name)) for name in moving]

    spun = leg.letters.stroke == "C"
    ends = [TreeBody(
        name=f"tip_{number}", place=none, turn=limbs.leg_frames[i], joints=moving_hinges("gamma1", "gamma2", "gamma3"),
        parts=[inertial(0, 0, 0, 0)],
    )] * bool(limbs.pose_closure[i])  # fmt: skip
    along, at = gives.joints.get("l"), f' ref="{numbers(home["l"])}"'
    at += f' springref="{numbers(home["l"])}"' * (along is not None)
    slide = [joint(f"l_{number}", "slide", ALONG, along, at)] if moves["l"] or along else []
    piston = _piston(leg, number, home["l"], gives, [*moving_hinges(*["spin"] * spun), *slide], ends, looks)
    base = [
        joint(f"base_{name}_{number}", "slide", axis, gives.base[name])
        for name, axis in zip("xyz", still, strict=True)
        if name in gives.base
    ]
    tube = leg.cylinder
    seen = [_capsule(0.0, tube.mouth, 1.5 * _radius(leg))] * (looks and tube.mouth > 0)
    cylinder = TreeBody(
        name=f"cylinder_{number}", place=none if leg.carriage else limbs.base[i],
        turn=limbs.frames[i] @ exponential(tilt),
        joints=[*base, *moving_hinges("alpha", "beta", *["spin"] * (not spun))],
        parts=[inertial(tube.mass, tube.com, tube.inertia, tube.axial_inertia), *seen], inside=[piston],
    )  # fmt: skip
    return _carriage(leg, limbs, i, gives, cylinder)


def _carriage(leg: Leg, limbs: kinematics.Limbs, i: int, gives: LegCompliance, cylinder: TreeBody) -> TreeBody:
    if leg.carriage is None:
        return cylinder
    kind, at = ("hinge" if leg.carriage.kind == "crank" else "slide"), numbers(-limbs.carriage_arm[i])
    more = f' pos="{at}" armature="{numbers(leg.carriage.inertia)}"'
    more += f' ref="{numbers(gives.begin)}"' * bool(gives.begin)
    return TreeBody(
        name=f"carriage_{i + 1}",
        place=limbs.base[i],
        turn=np.eye(3),
        joints=[joint(f"chi_{i + 1}", kind, limbs.carriage_axis[i], gives.joints.get("chi"), more)],
        parts=[inertial(leg.carriage.mass, 0, 0, 0)],
        inside=[cylinder],
    )


def _piston(
    leg: Leg,
    number: int,
    home: float,
    gives: LegCompliance,
    joints: Sequence[str],
    ends: Sequence[TreeBody],
    looks: bool,
) -> TreeBody:
    """The piston, in two parts where it bends: it is cut in the middle of its free part."""
    rod, still = leg.piston, np.eye(3)
    place = home * ALONG
    cut = gives.piston
    if cut is None:
        seen = [_capsule(-min(rod.length, home), 0.0, _radius(leg))] * looks
        parts = [_rod(leg, rod.length, 0.0), *seen]
        return TreeBody(name=f"piston_{number}", place=place, turn=still, joints=joints, parts=parts, inside=ends)
    middle, half = -0.5 * cut.free * ALONG, 0.5 * cut.free
    seen = [_capsule(-half, half, _radius(leg))] * looks
    bends = [joint(f"bend_{name}_{number}", "slide", way, cut.across) for name, way in zip("xy", ACROSS, strict=True)]
    bends.append(joint(f"bend_z_{number}", "slide", ALONG, cut.along))
    bends += [joint(f"turn_{name}_{number}", "hinge", way, cut.turn) for name, way in zip("xy", ACROSS, strict=True)]
    bends += [joint(f"twist_{number}", "hinge", ALONG, cut.twist)] * (cut.twist is not None)
    outer = TreeBody(
        name=f"bend_{number}",
        place=middle,
        turn=still,
        joints=bends,
        parts=[_rod(leg, half, half), *seen],
        inside=[replace(end, place=-middle) for end in ends],
    )
    parts = [_rod(leg, rod.length - half, -half)]
    return TreeBody(name=f"piston_{number}", place=place, turn=still, joints=joints, parts=parts, inside=[outer])


def _rod(leg: Leg, length: float, end: float) -> str:
    """Inertia of a piece of the piston that ends at `end` along the leg [m]."""
    rod = leg.piston
    mass, share = rod.rhoA * length, length / rod.length
    axial = rod.axial_inertia * share
    return inertial(mass, end - length / 2, max(mass * length**2 / 12, axial / 2), axial)  # a disc has the least


def inertial(mass: float, along: float, across: float, axial: float) -> str:
    """A body of revolution about z with its centre of mass at `along`."""
    moments = numbers(np.maximum([across, across, axial], LEAST))
    return f'<inertial pos="{numbers([0, 0, along])}" mass="{numbers([max(mass, LEAST)])}" diaginertia="{moments}"/>'


def payload_inertia(robot: Robot) -> str:
    """Mass, centre and inertia of the payload in the platform frame."""
    load = robot.payload
    full = [load.inertia[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    return f'<inertial pos="{numbers(load.com)}" mass="{numbers([load.mass])}" fullinertia="{numbers(full)}"/>'


def _capsule(begin: float, end: float, radius: float) -> str:
    return f'<geom type="capsule" fromto="0 0 {numbers(begin)} 0 0 {numbers(end)}" size="{numbers(radius)}"/>'


def _radius(leg: Leg) -> float:
    """Radius of the drawn piston [m]: half its depth, or that of a round rod of steel with its EA."""
    depth = leg.piston.depth
    return 0.5 * depth if depth else float(np.sqrt(leg.piston.EA / (np.pi * 2.1e11)))


def numbers(values: ArrayLike) -> str:
    """Numbers without loss of digits."""
    return " ".join(repr(float(x)) for x in np.ravel(values))
