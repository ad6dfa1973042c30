"""The legs of a robot as numbers: places and frames of their joints at home, and what each coordinate does.

A leg is one chain of eight coordinates, `COORDINATES`. A kind of joint is not another model: each coordinate of each
leg is free, held, driven or absent.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from flexapod.common.arrays import Array, Mask
from flexapod.kinematics.frames import base_frame, platform_frame
from flexapod.kinematics.jacobian import characteristic_length

if TYPE_CHECKING:
    from flexapod.model import Joint, Leg, Robot

COORDINATES = ("chi", "alpha", "beta", "spin", "l", "gamma1", "gamma2", "gamma3")
"""Carriage, two angles at the base joint, turn about the leg's axis, length, three angles at the platform joint."""

FREE, HELD, DRIVEN, ABSENT = range(4)

States = NDArray[np.int8]


@dataclass(frozen=True, kw_only=True)
class Limbs:
    """n legs at home, chain by chain; lengths in m, angles in rad.

    From base to tip a leg turns and stretches as ``R = Rot(chi) R0 Rx(alpha) Ry(beta) Rz(spin)``,
    ``tip = b(chi) + l R e_z``, and meets the platform with ``F_P^T R_platform^T R F_L Rx(gamma1) Ry(gamma2) Rz(gamma3)
    = 1``, all of it true at home with the values of `home`: carriage, alpha, spin and gammas are zero there.

    Attributes
    ----------
    chain : tuple of str
        Letters of each leg, base to platform.
    base : ndarray, shape (n, 3)
        Base joints at home, world axes.
    frames : ndarray, shape (n, 3, 3)
        R0, leg to world: x is the first axis of the base joint.
    carriage : {"", "slider", "crank"}
        What moves base joints; a robot has one kind.
    carriage_axis : ndarray, shape (n, 3)
        Unit vector along a slider's rail or a crank's shaft, world axes; zero for a leg without carriage.
    carriage_arm : ndarray, shape (n, 3)
        From the crank's shaft to the base joint at home.
    carriage_zero : ndarray, shape (n,)
        What the study file calls the carriage's place at home: chi, which is zero there, plus this.
    platform : ndarray, shape (n, 3)
        Platform joints, platform axes.
    platform_frames, leg_frames : ndarray, shape (n, 3, 3)
        F_P and F_L: axes of the platform joint in platform axes and in those of the leg.
    home : ndarray, shape (n, 8)
        `COORDINATES` at home.
    state : ndarray of int, shape (n, 8)
        FREE, HELD, DRIVEN or ABSENT.
    pose_closure : ndarray of bool, shape (n,)
        The platform joint is not an ideal ball: the leg meets the platform with place and attitude.
    idle : ndarray of bool, shape (n,)
        The leg can turn about its own axis without anything else moving; no coordinate says so.
    hub_held : ndarray of bool, shape (6,)
        What nothing but the plane, or the base, holds of the platform: along and about world x, y, z.
    position, rotation : ndarray, shapes (3,), (3, 3)
        Of the platform frame at home.
    L_c : float
        Length that makes rotations comparable with displacements, (T2.22).
    """

    chain: tuple[str, ...]
    base: Array
    frames: Array
    carriage: Literal["", "slider", "crank"]
    carriage_axis: Array
    carriage_arm: Array
    carriage_zero: Array
    platform: Array
    platform_frames: Array
    leg_frames: Array
    home: Array
    state: States
    pose_closure: Mask
    idle: Mask
    hub_held: Mask
    position: Array
    rotation: Array
    L_c: float

    def __post_init__(self) -> None:
        for value in vars(self).values():
            if isinstance(value, np.ndarray):
                value.flags.writeable = False

    def __len__(self) -> int:
        return len(self.chain)

    @cached_property
    def unknown(self) -> Mask:
        """Coordinates that move, (n, 8)."""
        return np.isin(self.state, (FREE, DRIVEN))

    @cached_property
    def given(self) -> Mask:
        """Coordinates that joints or drives hold, (n, 8)."""
        return np.isin(self.state, (HELD, DRIVEN))

    @cached_property
    def plain(self) -> bool:
        """Test whether all legs are of the kind UPS, whose kinematics has a closed form."""
        angles = self.state[:, [COORDINATES.index("alpha"), COORDINATES.index("beta")]]
        moves = self.unknown[:, COORDINATES.index("l")]
        return not self.carriage and not self.pose_closure.any() and bool((angles == FREE).all() and moves.all())

    @cached_property
    def guides(self) -> bool:
        """Test whether legs or the plane leave the platform fewer than six motions."""
        rows = np.where(self.pose_closure, 6, 3)
        return bool(self.hub_held.any() or (self.unknown.sum(axis=1) < rows).any())


def limbs(robot: Robot, rigid: bool = False) -> Limbs:
    """The legs of `robot`; with `rigid` those of its rigid path, whose springs and welds at joints are released.

    Raises
    ------
    InputError
        An axis lies along its leg.
    """
    count, turn, tips, feet = robot.count, robot.home_rotation, robot.home_tips, robot.home_bases
    kinds: list[Literal["slider", "crank"]] = [leg.carriage.kind for leg in robot.legs if leg.carriage is not None]
    legs = [
        _Leg.of(i, leg, foot, tip, turn, robot.normal if robot.plane else None, rigid)
        for i, (leg, foot, tip) in enumerate(zip(robot.legs, feet, tips, strict=True), start=1)
    ]
    home = np.zeros((count, len(COORDINATES)))
    home[:, COORDINATES.index("beta")] = [leg.beta for leg in legs]
    home[:, COORDINATES.index("l")] = np.linalg.norm(tips - feet, axis=1)
    spread = characteristic_length(robot.platform_joints)
    cranks = [leg.carriage is not None and leg.carriage.kind == "crank" for leg in robot.legs]
    return Limbs(
        chain=tuple(leg.chain for leg in robot.legs),
        base=feet,
        frames=np.array([leg.frame for leg in legs]),
        carriage=kinds[0] if kinds else "",
        carriage_axis=np.array([np.zeros(3) if leg.carriage is None else leg.carriage.unit for leg in robot.legs]),
        carriage_arm=np.where(np.array(cranks)[:, None], feet - robot.base_joints, 0.0),
        carriage_zero=robot.home_carriages,
        platform=robot.platform_joints,
        platform_frames=np.array([turn.T @ leg.joint for leg in legs]),
        leg_frames=np.array([leg.axes.T @ leg.joint for leg in legs]),
        home=home,
        state=np.array([leg.state for leg in legs], dtype=np.int8),
        pose_closure=np.array([leg.pose for leg in legs]),
        idle=np.array([leg.idle for leg in legs]),
        hub_held=_hub_held(robot),
        position=robot.home_position,
        rotation=turn,
        L_c=spread if spread > 1e-9 * home.max() else float(home[:, COORDINATES.index("l")].mean()),
    )


def _hub_held(robot: Robot) -> Mask:
    """Platform motions that the plane holds: along its normal, about axes in it; all of a fixed platform."""
    if robot.platform_fixed:
        return np.ones(6, dtype=bool)
    across = robot.normal != 0
    return np.concatenate([across, ~across]) if robot.plane else np.zeros(6, dtype=bool)


class _Leg(NamedTuple):
    """One leg: axes (3, 3) of base joint, of the leg itself and of the platform joint at home, in the world."""

    frame: Array
    axes: Array
    joint: Array
    beta: float
    state: list[int]
    pose: bool
    idle: bool

    @classmethod
    def of(cls, number: int, leg: Leg, foot: Array, tip: Array, turn: Array, normal: Array | None, rigid: bool) -> _Leg:
        """Leg `number` from `foot` to `tip`; `turn` of the platform and `normal` of a planar robot's plane."""
        letters, planar = leg.letters, normal is not None
        base, end = letters.base, letters.platform
        if planar:  # what is held by the plane is left to it: hinges become universal and ball joints
            base, end = base.replace("R", "U"), end.replace("R", "S").replace("U", "S")
        exact = base == "R" or end != "S"
        frame, beta = base_frame(number, normal if planar else leg.base_joint.axis, foot, tip, exact=exact)
        axes = frame @ _about_y(beta)
        axis = None if leg.platform_joint.axis is None else turn @ leg.platform_joint.axis
        joint = platform_frame(number, end, normal if planar else axis, axes)
        base_springs, end_springs = (_springs(x, rigid) for x in (leg.base_joint, leg.platform_joint))
        gammas = _gammas(end, end_springs, rigid, planar)
        rubs = not rigid and leg.platform_joint.friction is not None
        sprung = any(base_springs) or end_springs.moves
        seen = sprung or rubs  # by springs or friction
        gammas = (FREE, FREE, FREE) if seen and gammas[0] == ABSENT else gammas
        pose = any(g != ABSENT for g in gammas)
        twists = base == "S" or letters.stroke == "C" or (base == "F" and base_springs.torsion)
        state = [
            ABSENT if leg.carriage is None else DRIVEN if leg.driven == "carriage" else FREE,
            *_angles(base, base_springs.bending or rigid),
            (FREE if sprung or end != "S" else HELD) if twists and pose else ABSENT,  # held: between balls it is idle
            HELD if leg.strut is not None else DRIVEN if leg.driven == "stroke" else FREE,
            *gammas,
        ]
        return cls(frame, axes, joint, beta, state, pose, twists and not pose)


class _Springs(NamedTuple):
    bending: bool
    torsion: bool
    moves: bool


def _springs(joint: Joint, rigid: bool) -> _Springs:
    """Test whether springs hold a joint across the leg and about it, and whether it deflects as a flexure."""
    if rigid:
        return _Springs(False, False, False)
    whole = joint.stiffness is not None and bool(joint.stiffness[3:, 3:].any())
    return _Springs(whole or bool(joint.bending), whole or bool(joint.torsion), joint.flexes)


def _angles(base: str, sprung: bool) -> tuple[int, int]:
    """States of alpha and beta."""
    if base == "F" and not sprung:
        return HELD, HELD
    return FREE, HELD if base == "R" else FREE


def _gammas(end: str, springs: _Springs, rigid: bool, planar: bool) -> tuple[int, int, int]:
    """States of the angles at the platform joint."""
    across = FREE if springs.bending or rigid else HELD
    along = FREE if springs.torsion or rigid else HELD
    found = {
        "S": (FREE, FREE, FREE),
        "U": (FREE, FREE, FREE if springs.torsion else HELD),
        "R": (FREE, FREE if springs.bending else HELD, FREE if springs.torsion else HELD),
        "F": (across, across, along),
        "": (HELD, HELD, HELD),
    }[end]
    if planar and found != (FREE, FREE, FREE):
        found = found[0], FREE, FREE
    ideal = found == (FREE, FREE, FREE) and not (springs.bending or springs.torsion)
    return (ABSENT, ABSENT, ABSENT) if ideal else found


def _about_y(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
