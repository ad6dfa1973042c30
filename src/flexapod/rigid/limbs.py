"""The legs of a robot as numbers: places and frames of their joints at home, and what each coordinate does.

A leg is one chain of eight coordinates, `COORDINATES`. A kind of joint is not another model: each coordinate of each
leg is free, held, driven or absent.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from flexapod.rigid.jacobian import characteristic_length
from flexapod.rigid.kinematics import leg_frames
from flexapod.typing import Array

if TYPE_CHECKING:
    from flexapod.model import Robot

__all__ = ["ABSENT", "COORDINATES", "DRIVEN", "FREE", "HELD", "Limbs", "limbs"]

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
    pose_closure: NDArray[np.bool_]
    hub_held: NDArray[np.bool_]
    position: Array
    rotation: Array
    L_c: float

    def __len__(self) -> int:
        return len(self.chain)


def limbs(robot: Robot, rigid: bool = False) -> Limbs:
    """The legs of `robot`; with `rigid` those of its rigid path, whose springs and welds at joints are released."""
    count = len(robot.legs)
    position, rotation = np.array([0.0, 0.0, robot.home_height]), np.eye(3)
    tips = position + robot.platform_joints @ rotation.T
    frames = leg_frames(robot.base_joints, tips, [leg.u_axis for leg in robot.legs])
    home = np.zeros((count, len(COORDINATES)))
    home[:, COORDINATES.index("l")] = np.linalg.norm(tips - robot.base_joints, axis=1)
    state = np.full((count, len(COORDINATES)), ABSENT, dtype=np.int8)
    state[:, [COORDINATES.index("alpha"), COORDINATES.index("beta")]] = FREE
    state[:, COORDINATES.index("l")] = DRIVEN
    return Limbs(
        chain=("UPS",) * count,
        base=robot.base_joints,
        frames=frames,
        carriage="",
        carriage_axis=np.zeros((count, 3)),
        carriage_arm=np.zeros((count, 3)),
        carriage_zero=np.zeros(count),
        platform=robot.platform_joints,
        platform_frames=rotation.T @ frames,
        leg_frames=np.tile(np.eye(3), (count, 1, 1)),
        home=home,
        state=state,
        pose_closure=np.zeros(count, dtype=bool),
        hub_held=np.zeros(6, dtype=bool),
        position=position,
        rotation=rotation,
        L_c=characteristic_length(robot.platform_joints),
    )
