"""Robots on legs UPS and RPS by Exudyn: the same joints, springs, drives; pistons rigid or cables of elements."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod import rigid
from flexapod.elements.springs import springs_along
from flexapod.errors import InputError
from flexapod.model import Joint, Leg, Motion, Robot
from flexapod.proof.engines.exudyn_integration import Integration
from flexapod.proof.engines.exudyn_process import TIME_LIMIT, ask
from flexapod.typing import Array

#: s; longer ones ring more where the jerk jumps, shorter ones carry Newton's tolerance into the forces.
STEP = 2.5e-4
#: Elements per piston, distance of the rings [m]: one halved with the other, to extrapolate from.
MESHES = ((30, 0.01), (60, 0.005))

#: Legs that the model has.
CHAINS = ("UPS", "RPS")

_AT_REST = 1e-9  # m/s, m/s^2


@dataclass(frozen=True, kw_only=True)
class RobotProblem:
    """A robot, its motion and how Exudyn models and integrates it.

    `elements` per piston, 0 for rigid ones; `guide` [m]: distance of the two frictionless rings, at the mouth and
    behind it, that hold a flexible piston in its cylinder.
    """

    robot: Robot
    motion: Motion
    integration: Integration
    elements: int
    guide: float

    def __post_init__(self) -> None:
        if self.elements < 0:
            raise InputError("is negative", key="elements", value=self.elements, allowed="0 (rigid pistons), 1, 2 ...")
        if self.elements and self.guide <= 0:
            raise InputError("leaves the piston free to turn", key="guide", value=self.guide, allowed="above 0 m")
        for key in ("geometry", "heat"):
            if getattr(self.robot, key) is not None:
                raise InputError("is not modelled in Exudyn", key=key, allowed="the robot as it is drawn")
        for number, leg in enumerate(self.robot.legs, start=1):
            if leg.chain not in CHAINS or leg.passive:
                raise InputError(
                    "is not modelled in Exudyn", key=f"leg {number}: chain", value=leg.chain, allowed=", ".join(CHAINS)
                )
            _check_parts(number, leg)
            for key, there in (("sections", leg.piston.sections), ("shear", leg.piston.shear)):
                if self.elements and there:
                    raise InputError(
                        "is not modelled in Exudyn",
                        key=f"leg {number}: piston.{key}",
                        next_step="Compare uniform, slender pistons, or take rigid ones (elements=0)",
                    )
            if self.elements and not leg.piston.rhoA:
                raise InputError(
                    "makes cables without mass, which Exudyn cannot move",
                    key=f"leg {number}: piston.rhoA",
                    value=0,
                    next_step="Give a small rhoA, or take rigid pistons (elements=0)",
                )
            if leg.damping and self.elements:
                raise InputError(
                    "is not modelled in Exudyn",
                    key=f"leg {number}: damping",
                    value=leg.damping,
                    allowed="0",
                    next_step="Compare without damping",
                )
        for name in ("base_mount", "platform_mount", "base_motion"):
            if getattr(self.robot, name) is not None:
                raise InputError("is not modelled in Exudyn", key=f"robot.{name}", allowed="rigid frames at rest")
        self._check_path()

    def _check_path(self) -> None:
        legs = rigid.inverse_kinematics(self.robot, rigid.poses(self.robot, self.motion, self.integration.time))
        if np.abs(legs.rate[0]).max() > _AT_REST or np.abs(legs.accel[0]).max() > _AT_REST:
            raise InputError(
                "starts with a rate or an acceleration; Exudyn starts from static equilibrium, at rest",
                key="motion",
                allowed="a law that starts smoothly, such as profile = 'quintic'",
            )
        if not self.elements:
            return
        for number, (leg, length) in enumerate(zip(self.robot.legs, legs.length.T, strict=True), start=1):
            inner, outer = leg.cylinder.mouth - self.guide, leg.cylinder.mouth
            if length.max() - leg.piston.length >= inner or length.min() <= outer:
                raise InputError(
                    f"the piston of leg {number} leaves the rings {inner:g} m and {outer:g} m from the universal joint",
                    key="guide",
                    value=self.guide,
                    next_step="Choose a smaller guide, a longer piston or a smaller motion",
                )


def _check_parts(number: int, leg: Leg) -> None:
    """Raise InputError for what the model of a leg's joints, springs and drive does not have."""

    def refused(key: str, allowed: str) -> InputError:
        return InputError("is not modelled in Exudyn", key=f"leg {number}: {key}", allowed=allowed)

    for key, there in (("guide", leg.guide), ("cylinder.diameter", leg.cylinder.section)):
        if there is not None:
            raise refused(key, "a piston clamped in the mouth of a rigid cylinder")
    if leg.screw is not None and leg.screw.motor.ripple is not None:
        raise refused("drive.motor.ripple", "a motor without")
    if leg.screw is not None and leg.screw.lag:
        raise refused("drive.motor.bandwidth", "a motor without")
    if leg.piston.bow or leg.base_joint.eccentricity or leg.platform_joint.eccentricity:
        raise refused("bow, eccentricity", "straight legs")
    if leg.turning:
        raise refused("piston.keyed", "true")
    if leg.drive.type == "force" or (leg.screw is not None and (leg.screw.command == "torque" or leg.holds_stroke)):
        raise refused("drive", "prescribed, servo, screw with command = 'position' or 'servo' at the rotor")
    if leg.screw is not None and leg.screw.loop is not None and leg.screw.loop.integral:
        raise refused("drive.loop.integral", "stiffness and damping")
    for end in ("base_joint", "platform_joint"):
        joint: Joint = getattr(leg, end)
        if joint.flexes or joint.bending is not None or joint.torsion is not None:
            raise refused(end, "stiffness = { axial, radial } alone")
        if joint.friction is not None and joint.friction.arm and leg.platform_joint.stiffness is None:
            raise refused(f"{end}.friction", "a moment, or a platform joint with stiffness, whose force presses")
        if joint.lossy:
            raise refused(f"{end}.loss", "damping")
    for spring in springs_along(leg):
        if spring.loss:
            raise refused(f"{spring.name}.loss", "damping")


@dataclass(frozen=True, kw_only=True)
class RobotResult:
    """Motion of the robot as Exudyn finds it, at T instants.

    Attributes
    ----------
    time : ndarray, shape (T,)
        [s].
    com_deviation : ndarray, shape (T, 3)
        Centre of mass, from its place in the robot with rigid legs of the commanded length [m], world axes.
    actuator_force : ndarray, shape (T, legs)
        Of the drive on the piston along the leg [N]; positive pushes out.
    tip_deflection : ndarray, shape (T, legs, 2)
        Of the piston's tip from the cylinder's axis [m], along a and b.
    seconds : float
        That the integration took, without building, start and records.
    """

    time: Array
    com_deviation: Array
    actuator_force: Array
    tip_deflection: Array
    seconds: float


def simulate_robot(
    robot: Robot,
    motion: Motion,
    integration: Integration,
    *,
    elements: int = 30,
    guide: float = 0.01,
    time_limit: float = TIME_LIMIT,
) -> RobotResult:
    """Motion of a robot from its static equilibrium on, computed by Exudyn.

    Parameters
    ----------
    robot, motion : Robot, Motion
        Drives that have a position; pistons without damping, no load; the motion starts smoothly from rest.
    integration : Integration
    elements : int
        ANCF cable elements per piston (Euler-Bernoulli, finite strain and rotation); 0: rigid pistons.
    guide : float
        Distance of the two rings that stand for the clamp at the mouth [m]: their softness is the largest error, about
        guide over free length in the lateral deflection, and of first order.
    time_limit : float
        Seconds after which Exudyn is stopped.

    Raises
    ------
    InputError
        Something that this model does not have, or a piston that leaves its rings.
    ComputationError
        Exudyn is not installed, does not end in time, crashes, or does not converge.
    """
    problem = RobotProblem(robot=robot, motion=motion, integration=integration, elements=elements, guide=guide)
    return ask("flexapod.proof.engines.exudyn_robot_model", problem, time_limit=time_limit)
