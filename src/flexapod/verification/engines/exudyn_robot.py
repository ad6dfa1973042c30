"""Robots on legs UPS and RPS by Exudyn: the same joints, springs, drives; pistons rigid or cables of elements."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from flexapod import kinematics
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError
from flexapod.kinematics.rotations import quaternion
from flexapod.mechanics.elements.springs import springs_along
from flexapod.model import Joint, Leg, Motion, Robot
from flexapod.verification.engines.exudyn_builder import Builder
from flexapod.verification.engines.exudyn_integration import Integration
from flexapod.verification.engines.exudyn_legs import EndSprings, add_leg, turn_count
from flexapod.verification.engines.exudyn_process import TIME_LIMIT, solve_in_process

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
                raise _refused(key, "the robot as it is drawn")
        for number, leg in enumerate(self.robot.legs, start=1):
            if leg.chain not in CHAINS or leg.passive:
                raise _refused(f"leg {number}: chain", ", ".join(CHAINS), value=leg.chain)
            for key, there, allowed in _lacking(leg):
                if there:
                    raise _refused(f"leg {number}: {key}", allowed)
            if self.elements:
                _check_cables(number, leg)
        for name in ("base_mount", "platform_mount", "base_motion"):
            if getattr(self.robot, name) is not None:
                raise _refused(f"robot.{name}", "rigid frames at rest")
        self._check_path()

    def _check_path(self) -> None:
        legs = kinematics.inverse_kinematics(
            self.robot, kinematics.poses(self.robot, self.motion, self.integration.time)
        )
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


def _refused(key: str, allowed: str, **more: Any) -> InputError:
    return InputError("is not modelled in Exudyn", key=key, allowed=allowed, **more)


def _lacking(leg: Leg) -> Iterator[tuple[str, object, str]]:
    """Features of a leg that the model lacks: key, whether the leg has it, what is allowed."""
    screw, straight = leg.screw, "a piston clamped in the mouth of a rigid cylinder"
    yield from ((element.at, True, "legs without it") for element in leg.elements)
    yield "guide", leg.guide is not None, straight
    yield "cylinder.diameter", leg.cylinder.section is not None, straight
    yield "drive.motor.ripple", screw and screw.motor.ripple is not None, "a motor without"
    yield "drive.motor.bandwidth", screw and screw.lag, "a motor without"
    yield (
        "bow, eccentricity",
        leg.piston.bow or leg.base_joint.eccentricity or leg.platform_joint.eccentricity,
        "straight legs",
    )
    yield "piston.keyed", leg.turning, "true"
    pushes = leg.drive.type == "force" or (screw and (screw.command == "torque" or leg.holds_stroke))
    yield "drive", pushes, "prescribed, servo, screw with command = 'position' or 'servo' at the rotor"
    yield "drive.loop.integral", screw and screw.loop is not None and screw.loop.integral, "stiffness and damping"
    for end in ("base_joint", "platform_joint"):
        joint: Joint = getattr(leg, end)
        hinges = joint.flexes or joint.bending is not None or joint.torsion is not None
        yield end, hinges, "stiffness = { axial, radial } alone"
        pressed = joint.friction is not None and joint.friction.arm and leg.platform_joint.stiffness is None
        yield f"{end}.friction", pressed, "a moment, or a platform joint with stiffness, whose force presses"
        yield f"{end}.loss", joint.lossy, "damping"
    for spring in springs_along(leg):
        yield f"{spring.name}.loss", spring.loss, "damping"


def _check_cables(number: int, leg: Leg) -> None:
    """Raise InputError for what cables in place of a piston do not have."""
    for key, there in (("sections", leg.piston.sections), ("shear", leg.piston.shear)):
        if there:
            raise InputError(
                "is not modelled in Exudyn",
                key=f"leg {number}: piston.{key}",
                next_step="Compare uniform, slender pistons, or take rigid ones (elements=0)",
            )
    if not leg.piston.rhoA:
        raise InputError(
            "makes cables without mass, which Exudyn cannot move",
            key=f"leg {number}: piston.rhoA",
            value=0,
            next_step="Give a small rhoA, or take rigid pistons (elements=0)",
        )
    if leg.damping:
        raise _refused(f"leg {number}: damping", "0", value=leg.damping, next_step="Compare without damping")


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
    return solve_in_process(solve, problem, time_limit=time_limit)


def solve(problem: RobotProblem, builders: type[Builder] = Builder) -> RobotResult:
    """Build the robot, integrate, and read the sensors."""
    robot, plan, builder = problem.robot, problem.integration, builders(problem.integration)
    path = kinematics.poses(robot, problem.motion, plan.time)
    lengths = kinematics.inverse_kinematics(robot, path).length
    load, start = robot.payload, robot.home_position + robot.home_rotation @ robot.payload.com
    body = builder.body(load.mass, load.inertia, start, quaternion(robot.home_rotation), robot.gravity)
    mesh = {"elements": problem.elements, "guide": problem.guide}
    legs = [add_leg(builder, robot, i, lengths[:, i], body, **mesh) for i in range(robot.count)]
    centre = builder.add_sensor("body", body, "Displacement")
    seconds = builder.solve(equilibrium=True)
    rigid_centre, _, _ = path.point(load.com)
    coordinates = [builder.records([leg.coordinates])[:, 0] for leg in legs]
    return RobotResult(
        time=plan.time,
        com_deviation=builder.records([centre])[:, 0] - (rigid_centre - start),
        actuator_force=-builder.records([leg.drive for leg in legs])[..., 0],
        tip_deflection=_tip_deflection(robot, coordinates, builder.records([leg.tip for leg in legs])),
        seconds=seconds,
    )


def _tip_deflection(robot: Robot, coordinates: list[Array], tips: Array) -> Array:
    """Tips (T, legs, 3) [m] seen from the axes of the cylinders at their `coordinates` (T, any), (T, legs, 2)."""
    limbs = kinematics.rigid_limbs(robot)
    beta = np.tile(limbs.home[:, kinematics.COORDINATES.index("beta")], (len(tips), 1))
    for i, leg in enumerate(robot.legs):
        if turn_count(leg) == 2:
            beta[:, i] = coordinates[i][:, 1]
    axes = kinematics.leg_rotations(limbs.frames, np.column_stack([q[:, 0] for q in coordinates]), beta)
    found = np.einsum("tnij,tni->tnj", axes, tips - robot.base_joints)[..., :2]
    for i, leg in enumerate(robot.legs):
        if 0 in EndSprings.from_leg(leg, "base").compliant_directions:
            found[:, i] -= coordinates[i][:, turn_count(leg) : turn_count(leg) + 2]
    return found
