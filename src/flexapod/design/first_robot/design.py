"""A first robot, computed: the thinnest parts that bear its load, and all sizes that follow from them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from flexapod import kinematics, model
from flexapod.analysis.checks.estimates import buckling_load
from flexapod.analysis.description.robot_description import describe_legs
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.errors import InputError
from flexapod.common.quantities import text
from flexapod.design.first_robot import sizing
from flexapod.design.first_robot.box import boxed_robot, robot_of_home
from flexapod.design.first_robot.electric_choice import electric_robot
from flexapod.design.first_robot.hydraulic import hydraulic_robot
from flexapod.design.first_robot.sizing import OPTION, Body, Joints, Request, SizedLeg
from flexapod.design.first_robot.study_text import Plan, write_study_text

LARGEST = {"m": 0.5, "rad": math.radians(30)}  # amplitude, of the home height along an axis, about one
LEAST_SINGULAR = 0.1  # singular value of the scaled Jacobian on the path
ACCELERATION = 1.0  # largest of the platform's joints [m/s^2]
FASTEST = 0.1  # shortest motion [s]


def first_robot(request: Request) -> str:
    """The text of a study file whose strokes, mouths and piston lengths fit each other.

    Parameters
    ----------
    request : Request

    Returns
    -------
    str
        Each value marked as given or computed, with the reason.

    Raises
    ------
    InputError
        No robot of these proportions does it; the message names the number to change.
    """
    if request.demand is not None and request.demand.ranges:
        return boxed_robot(request, _robot_of_stroke)
    return _robot_of_stroke(request)


def robot_at_home(request: Request, home: float) -> str | None:
    """The text of the robot of another home height, for the same box of poses if there is one; None where none fits."""
    if request.demand is not None and request.demand.ranges:
        return robot_of_home(request, _robot_of_stroke, home)
    try:
        return _robot_of_stroke(replace(request, home=home))
    except InputError:
        return None


def _robot_of_stroke(request: Request) -> str:
    """The text of a study file of a robot whose home is known."""
    joints = sizing.size_joints(request)
    body, stroke = sizing.size_body(request, joints), sizing.leg_stroke(request)
    if request.drive == "electric":
        return write_study_text(electric_robot(_moved(request, joints, body, stroke)))
    if request.drive == "hydraulic":
        return write_study_text(hydraulic_robot(_moved(request, joints, body, stroke)))
    return write_study_text(_ideal(request, joints, body, stroke))


def _moved(request: Request, joints: Joints, body: Body, stroke: float) -> Plan:
    """The robot with legs of any thickness: its motion depends on their strokes alone."""
    leg = sizing.size_leg(joints, stroke, sizing.RODS[0])
    if leg is None:
        raise _no_stroke(request, joints, stroke, sizing.RODS[0])
    return _plan(request, joints, body, leg)


def _ideal(request: Request, joints: Joints, body: Body, stroke: float) -> Plan:
    """The robot with ideal legs: the thinnest standard piston."""
    safety = diameter = 0.0
    for diameter in _diameters(request, joints, stroke):
        leg = sizing.size_leg(joints, stroke, diameter)
        if leg is None:
            raise _no_stroke(request, joints, stroke, diameter)
        found = _plan(request, joints, body, leg)
        safety = _safety(found)
        if safety >= sizing.SAFETY:
            return found
    raise _too_weak(request, diameter, safety)


def _diameters(request: Request, joints: Joints, stroke: float) -> list[float]:
    """Diameters to try, thinnest first."""
    room = sizing.fitting_diameters(joints)
    if request.diameter is not None:
        most = joints.gap / 1.25 / sizing.OUTER
        if request.diameter > most:
            raise InputError(
                "leaves no room between the two legs of a pair",
                key=f"{OPTION} diameter",
                value=request.texts["diameter"],
                allowed=f"at most {text(most, 'm')}: joints are {text(joints.gap, 'm')} apart",
                next_step="Give thinner pistons, a larger platform, or a larger home",
            )
        return [request.diameter]
    if not room.size:
        raise InputError(
            "leaves no room for two legs side by side", key=f"{OPTION} platform", value=request.texts.get("platform"),
            next_step="Give a larger platform",
        )  # fmt: skip
    return [d for d in room.tolist() if _slender(joints, stroke, d)] or room[-1:].tolist()


def _slender(joints: Joints, stroke: float, diameter: float) -> bool:
    """Test whether a piston is stout enough outside its cylinder; a stroke that does not fit is cut to what fits."""
    leg = sizing.size_leg(joints, min(stroke, 0.99 * sizing.longest_stroke(joints, diameter)), diameter)
    return leg is None or leg.longest - leg.mouth <= sizing.SLENDER * diameter


def _plan(request: Request, joints: Joints, body: Body, leg: SizedLeg) -> Plan:
    """The robot with this leg, and a motion that it can follow."""
    still = Plan(request=request, joints=joints, body=body, leg=leg, amplitude=0.0, duration=1.0)
    amplitude = _amplitude(request, model.loads(write_study_text(still)), leg)  # type: ignore[arg-type]
    radius = joints.platform if request.motion in model.AXES[3:] else 1.0
    needed = math.sqrt(10 / math.sqrt(3) * amplitude * radius / ACCELERATION)  # the quintic's largest acceleration
    duration = request.duration or max(FASTEST, math.ceil(100 * needed) / 100)
    return Plan(request=request, joints=joints, body=body, leg=leg, amplitude=amplitude, duration=duration)


def _amplitude(request: Request, study: model.Study, leg: SizedLeg) -> float:
    """Amplitude of the motion from home: `SHARE` of the half stroke, well away from singular poses."""
    robot, axis = study.robot, model.AXES.index(request.motion)
    turning = axis >= 3
    amplitudes = np.linspace(0.0, 1.0, 401) * (LARGEST["rad"] if turning else LARGEST["m"] * request.home)
    coordinates = np.zeros((len(amplitudes), 6))
    coordinates[:, axis] = amplitudes
    home = kinematics.home_pose(robot)
    path = kinematics.Poses.at_rest(home.position + coordinates[:, :3], kinematics.rotation_matrix(coordinates[:, 3:]))
    length = kinematics.reach(robot, path).length
    used = np.abs(length - robot.home_lengths).max(axis=1) / (0.5 * sizing.SHARE * (leg.longest - leg.shortest))
    singular = np.array([_smallest(robot, path, k) for k in range(0, len(amplitudes), 20)])
    if singular[0] < LEAST_SINGULAR:
        raise InputError(
            "gives legs that hardly hold the platform, too flat or too upright: the smallest singular value of the "
            f"scaled Jacobian is {singular[0]:.2g}",
            key=f"{OPTION} home",
            value=request.texts.get("home", request.home),
            allowed=f"proportions that give it {LEAST_SINGULAR:g} at least",
            next_step="Bring base and platform nearer to 0.6 and 0.36 of home, or leave them out",
        )
    far = np.repeat(np.minimum.accumulate(singular), 20)[: len(amplitudes)] < LEAST_SINGULAR
    k = int(np.argmax((used > 1) | far)) if ((used > 1) | far).any() else len(amplitudes)
    if k == len(amplitudes) or far[k]:
        return _nice(amplitudes[k - 1], turning=turning)
    low, high = amplitudes[k - 1], amplitudes[k]  # between them the stroke's share is used up
    share = np.clip((1 - used[k - 1]) / (used[k] - used[k - 1]), 0, 1)
    return _nice(low + 0.98 * share * (high - low), turning=turning)


def _smallest(robot: model.Robot, path: kinematics.Poses, k: int) -> float:
    at = kinematics.Poses.at_rest(path.position[k : k + 1], path.rotation[k : k + 1])
    return kinematics.nearest_singularity(robot, at).smallest_singular_value


def _nice(value: float, *, turning: bool) -> float:
    """The value to three digits, downwards: in degrees where it is an angle."""
    shown = math.degrees(value) if turning else value
    digit = 10.0 ** (math.floor(math.log10(shown)) - 2)
    kept = round(math.floor(shown / digit) * digit, 12)
    return math.radians(kept) if turning else kept


def _safety(plan: Plan) -> float:
    """Safety factor of a leg under the loads of the path, against yield and against buckling at its longest."""
    study: model.Study = model.loads(write_study_text(plan))  # type: ignore[assignment]
    legs = describe_legs(RigidPath(study))
    first = study.robot.legs[0]
    euler = float(buckling_load(first, np.array([plan.leg.longest - plan.leg.mouth]))[0])
    thrust = max(max(leg.force_max.value for leg in legs), 0.0)
    stressed = max(leg.stress.total.value for leg in legs if leg.stress is not None)
    return min(euler / max(thrust, 1e-12), (first.piston.yield_stress or np.inf) / stressed)


def _no_stroke(request: Request, joints: Joints, stroke: float, diameter: float) -> InputError:
    most = sizing.longest_stroke(joints, diameter)
    legs = f"legs of {text(joints.length, 'm')} and pistons of {text(diameter, 'm')}"
    larger = 1.05 * request.home * stroke / max(most, 1e-3 * joints.length)
    return InputError(
        "does not fit into legs of this length: drawn in, a piston is as long as its stroke and what guides it",
        key=f"{OPTION} stroke",
        value=request.texts.get("stroke", text(stroke, "m")),
        allowed=f"at most {text(0.995 * most, 'm')} with {legs}" if most > 0 else f"none with {legs}",
        next_step=f"Give a shorter stroke, or home = {text(larger, 'm')}",
    )


def _too_weak(request: Request, diameter: float, safety: float) -> InputError:
    # Loads on pistons that grow with the robot: stress and Euler load over thrust fall with the square of its size.
    larger = 1.05 * request.home * math.sqrt(sizing.SAFETY / max(safety, 1e-9))
    given = request.diameter is not None
    return InputError(
        f"is too much for pistons of {text(diameter, 'm')}{'' if given else ', the thickest that fit'}: they are "
        f"{safety:.2g} times safe against buckling and yield",
        key=f"{OPTION} payload",
        value=request.texts.get("payload", request.payload),
        allowed=f"{sizing.SAFETY:g} times: about {request.payload * safety / sizing.SAFETY:.2g} kg",
        next_step="Give thicker pistons" if given else f"Give home = {text(larger, 'm')}, or a smaller payload",
    )
