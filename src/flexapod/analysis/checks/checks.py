"""Checks of a path before anything is computed: strokes, pistons, universal joints, singularities, start."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flexapod import kinematics
from flexapod.analysis.checks.resource_limits import check_outputs
from flexapod.analysis.results.bodies import clearance, joint_angle_limits, joint_angles
from flexapod.analysis.results.remarks import remark
from flexapod.analysis.results.rigid_path import RigidPath, open_force_words, path_instants
from flexapod.common.arrays import Array
from flexapod.common.errors import InputError, check_kind
from flexapod.common.ranking import first_largest, first_least, largest_item
from flexapod.common.resources import one_thread
from flexapod.kinematics.inverse import BETA_LIMIT
from flexapod.kinematics.workspace import BEFORE, BEYOND, LONGEST, PULLED_OUT, SHORTEST
from flexapod.model import ActuatorStudy, HydraulicDrive, Robot, Study
from flexapod.solve.statics.locked_robot import refuse_pure_force, refuse_taut

SINGULAR = 1e-8  # smallest singular value of the scaled Jacobian below which a pose is refused
UPRIGHT = 1e-6  # cosine of an elevation: the inertia about Z is its square
NEAR_SINGULAR = 0.05  # and below which it is remarked on: leg forces and length errors are magnified about 20 times
ROUNDING = 1e-9  # rad: of the angle between unit vectors
FEW = 32  # instants of a path for one at which legs are looked at first
MOVED = 1e-9  # m, of cranks rad: what legs that stand move by rounding

_KEYS = {
    SHORTEST: "leg.stroke.min",
    LONGEST: "leg.stroke.max",
    PULLED_OUT: "leg.piston.length",
    BEFORE: "leg.carriage.stroke.min",
    BEYOND: "leg.carriage.stroke.max",
}


@one_thread()
def check_path(study: Study, path: RigidPath | None = None) -> list[str]:
    """Refuse a study whose path no robot could follow; return remarks on what is only doubtful.

    Parameters
    ----------
    study : Study
    path : RigidPath, optional
        Its path at `path_instants`, where it is known.

    Raises
    ------
    InputError
        A leg leaves its stroke, a piston its cylinder, a universal joint folds, a pose is singular (smallest singular
        value of the scaled Jacobian, Eq. (T2.24), below 1e-8 or a change of sign of its determinant), a pure force
        drive is to start from equilibrium, the study's times do not fit each other, or rigid legs are held so often
        that they cannot move.
    """
    check_kind(study, Study, "study", "a study of a robot, as flexapod.load gives it")
    if path is not None:
        check_kind(path, RigidPath, "path", "that of the study, or None")
    try:
        if study.initial.start == "equilibrium":
            refuse_pure_force(study.robot, "the equilibrium start")
            refuse_taut(study.robot, study.simulation)
    except InputError as error:
        raise error.with_location(file=study.path) from None
    path = path or RigidPath(study)
    return [*check_geometry(study, path), *_rigid_remarks(path)]


def _rigid_remarks(path: RigidPath) -> list[str]:
    """Refuse rigid legs that cannot follow the motion; remarks on forces that rigid statics leaves open."""
    study, robot = path.study, path.robot
    if study.simulation.fidelity != "rigid":
        return []
    found, ideal = (
        kinematics.mobility(legs) for legs in (kinematics.robot_limbs(robot), kinematics.rigid_limbs(robot))
    )
    moved = max(np.ptp(way, axis=0).max() for way in (path.reach.length, path.reach.carriage))
    if found.platform.shape[1] < ideal.platform.shape[1] and moved > MOVED:
        what = "is over-constrained by its fixed joints: legs that do not give way cannot follow the motion"
    elif robot.platform_fixed and any(leg.driven and leg.drive.type == "prescribed" for leg in robot.legs):
        what = "does not say what forces are in legs that drives hold between fixed points: they are open"
    else:
        return open_force_words(path.forces)
    raise InputError(
        f"robot {robot.type} {what}",
        file=study.path,
        key="simulation.fidelity",
        value="rigid",
        allowed="a fidelity whose legs give way: lumped, assumed-modes and others",
    )


def check_geometry(study: Study, path: RigidPath | None = None) -> list[str]:
    """The checks of `check_path` that concern the path alone."""
    path, robot = path or RigidPath(study), study.robot
    try:
        remarks = check_outputs(study)
        limbs = kinematics.rigid_limbs(robot)
        if limbs.guides or np.count_nonzero(limbs.state == kinematics.DRIVEN) < 6:
            kinematics.refuse_loose(limbs)
        for early in path.coarse_paths:
            _refuse_lost(robot, early.time, early.reach)
            _refuse_excess(robot, early.time, early.reach)
        t, found = path.time, path.reach
        _refuse_lost(robot, t, found)
        _refuse_excess(robot, t, found)
        _refuse_off_the_screw(robot, t, found.length)
        _refuse_folded(t, found)
        _refuse_turned(path)
        _refuse_singular(t, path.nearest)
    except InputError as error:
        raise error.with_location(file=study.path) from None
    return remarks + _remarks(robot, t, found.length, path.nearest) + _touching(path)


def pose_remarks(at: kinematics.RigidPoses) -> list[str]:
    """Remarks on a pose near a singularity and pistons that reach behind their universal joint.

    Raises
    ------
    InputError
        The nut of a leg is outside its screw.
    """
    t, length = np.zeros(1), at.reach.length
    _refuse_off_the_screw(at.robot, t, length)
    return _remarks(at.robot, t, length, at.nearest)


def _remarks(robot: Robot, t: Array, length: Array, found: kinematics.NearestSingularity) -> list[str]:
    remarks = [e.message for e in kinematics.pull_out(robot, t, length) if not e.fatal]
    if found.smallest_singular_value < NEAR_SINGULAR:
        remarks.append(
            remark(
                "near singular",
                time=t[found.worst],
                value=found.smallest_singular_value,
                condition=found.condition,
                limit=NEAR_SINGULAR,
            )
        )
    return remarks


def _refuse_lost(robot: Robot, t: Array, found: kinematics.Reach) -> None:
    if found.lost.any():
        k = int(np.argmax(found.lost))
        raise InputError(
            f"{kinematics.lost_words(kinematics.rigid_limbs(robot), found.gap[k])} at t = {t[k]:.6g} s",
            key="motion",
            allowed="poses that all legs reach",
            next_step="Reduce the motion, or change the places of the joints or the length of the struts",
        )


def _refuse_excess(robot: Robot, t: Array, reach: kinematics.Reach) -> None:
    found = [*kinematics.strokes(robot, t, reach.length), *kinematics.pull_out(robot, t, reach.length)]
    fatal = [e for e in (*found, *kinematics.carriages(robot, t, reach.carriage)) if e.fatal]
    if not fatal:
        return
    worst = largest_item(fatal, key=lambda e: abs(e.value - e.limit))
    others = [str(leg) for leg in sorted({e.leg for e in fatal} - {worst.leg})]
    also = f"; so do legs {', '.join(others)}" if len(others) > 1 else "".join(f"; so does leg {n}" for n in others)
    raise InputError(
        worst.message.rstrip(".") + also,
        key=_KEYS.get(worst.kind, "leg.cylinder.mouth"),
        next_step="Reduce the motion, or change the limit named here",
    )


def _refuse_off_the_screw(robot: Robot, t: Array, length: Array) -> None:
    """The nut or the head, at the piston's inner end, has to stay on the screw or in the hydraulic cylinder."""
    for i, leg in enumerate(robot.legs):
        along = length[:, i] - leg.begins
        if leg.cylinder_of_oil is not None:
            _refuse_out_of_oil(i, leg.cylinder_of_oil, t, along)
        if leg.screw is None:
            continue
        if along.min() >= 0 and along.max() <= leg.screw.length:
            continue
        low, high = first_least(along), first_largest(along)
        k = low if -along[low] > along[high] - leg.screw.length else high
        if 0 <= along[k] <= leg.screw.length:
            continue
        at = "" if len(t) == 1 else f" at t = {t[k]:.6g} s"
        raise InputError(
            f"ends before the nut of leg {i + 1}, which is {along[k]:.4g} m from the bearing{at}"
            if along[k] > 0
            else f"begins after the nut of leg {i + 1}, which is {-along[k]:.4g} m behind the bearing{at}",
            key="leg.drive.length" if along[k] > 0 else "leg.drive.bearing.position",
            value=leg.screw.length if along[k] > 0 else leg.screw.bearing.position,
            allowed="a nut (length of the leg - piston.length - bearing.position) between 0 and the screw's length",
            next_step="Change length, bearing.position or piston.length, or reduce the motion",
        )


def _refuse_out_of_oil(i: int, drive: HydraulicDrive, t: Array, along: Array) -> None:
    volumes = drive.volumes(along)
    outside = np.maximum(-along, along - drive.stroke)
    k = first_largest(np.where(volumes.min(axis=0) > 0, outside, np.inf))
    if outside[k] <= 0 and volumes[:, k].min() > 0:
        return
    at = "" if len(t) == 1 else f" at t = {t[k]:.6g} s"
    raise InputError(
        f"does not reach as far as the piston of leg {i + 1}, which is {along[k]:.4g} m from the cylinder's bottom{at}",
        key="leg.drive.stroke",
        value=drive.stroke,
        allowed="a piston (length of the leg - piston.length - drive.bottom) between 0 and drive.stroke, and oil on "
        "both sides",
        next_step="Change stroke, bottom, dead_volume or piston.length, or reduce the motion",
    )


class _Fold(NamedTuple):
    """Words of a refusal: what happens to the joint of a leg, where to look, what is allowed, what to do."""

    what: str
    key: str
    allowed: str
    next_step: str


_FOLDS = {
    "universal joint": _Fold(
        "the universal joint of leg {} folds to beta =",
        "leg.u_axis",
        "|beta| at most 85 deg",
        "Turn the universal joint's first axis (u_axis), or reduce the motion",
    ),
    "base joint": _Fold(
        "the joint at the base of leg {} folds to",
        "leg.base_joint.axis",
        "at most 85 deg",
        "Turn the axis of the joint, or reduce the motion",
    ),
    "platform joint": _Fold(
        "the joint at the platform of leg {} folds to",
        "leg.platform_joint.axis",
        "at most 85 deg",
        "Turn the axis of the joint, or reduce the motion",
    ),
    "carriage": _Fold(
        "between leg {} and the way of its carriage the angle is",
        "leg.carriage",
        "at most 85 deg: at 90 deg the carriage cannot hold the leg, and beyond the leg stands on the other side",
        "Reduce the motion, or choose the other side (carriage.side)",
    ),
}


def _refuse_folded(t: Array, found: kinematics.Reach) -> None:
    for joint, angle in found.angles.items():
        if angle.max() <= BETA_LIMIT:
            continue
        words = _FOLDS[joint]
        k, leg = np.unravel_index(first_largest(angle), angle.shape)
        first = t[np.argmax(angle[:, leg] > BETA_LIMIT)]
        raise InputError(
            f"{words.what.format(leg + 1)} {np.rad2deg(angle[k, leg]):.1f} deg "
            f"at t = {t[k]:.6g} s (beyond the limit from t = {first:.6g} s on)",
            key=words.key,
            allowed=words.allowed,
            next_step=words.next_step,
        )


def _refuse_turned(path: RigidPath) -> None:
    largest = joint_angle_limits(path.robot)
    if not np.isfinite(largest).any():
        return
    found = joint_angles(path.robot, path.axes, path.poses.rotation)
    k, leg, end = np.unravel_index(first_largest(found - largest), found.shape)
    if found[k, leg, end] <= largest[leg, end] + ROUNDING:
        return
    name = ("base", "platform")[end]
    first = path.time[np.argmax(found[:, leg, end] > largest[leg, end])]
    raise InputError(
        f"is left: leg {leg + 1} turns by {np.rad2deg(found[k, leg, end]):.2f} deg from home at its {name} joint "
        f"at t = {path.time[k]:.6g} s (beyond the limit from t = {first:.6g} s on)",
        key=f"leg.{name}_joint.max_angle",
        value=f"{np.rad2deg(largest[leg, end]):.4g} deg",
        allowed=f"at least {np.rad2deg(found[k, leg, end]):.4g} deg on this path",
        next_step="Reduce the motion, or choose a joint that turns farther",
    )


def _touching(path: RigidPath) -> list[str]:
    """Legs that run into each other."""
    if _legs_clear(path):
        return []
    nearest = clearance(path.robot, path.poses.place(path.robot.platform_joints), path.axes, path.legs.length)
    if nearest is None or nearest.gap.min() >= 0:
        return []
    k = first_least(nearest.gap)
    one, other = nearest.legs[k] + 1
    return [remark("legs overlap", one=one, other=other, overlap=-float(nearest.gap[k]), time=float(path.time[k]))]


def _legs_clear(path: RigidPath) -> bool:
    """Test at a few instants whether no legs UPS touch: a gap changes by no more than both legs' tips move."""
    if not kinematics.rigid_limbs(path.robot).plain:
        return False
    count, tips = len(path.time), path.poses.place(path.robot.platform_joints)
    of = np.arange(count) // FEW
    some = np.minimum(np.arange(of[-1] + 1) * FEW + FEW // 2, count - 1)
    at = path.resting(some)
    found = clearance(path.robot, tips[some], at.directions, at.reach.length)
    moved = np.sqrt(((tips - tips[some[of]]) ** 2).sum(axis=2).max(axis=1))
    return found is None or bool((found.gap[of] > 2 * moved + ROUNDING).all())


def _refuse_singular(t: Array, found: kinematics.NearestSingularity) -> None:
    words = ""
    if found.smallest_singular_value < SINGULAR:
        words = f"is singular at t = {t[found.worst]:.6g} s" + ", from the start" * (found.worst == 0)
    elif len(found.sign_changes):
        k = int(found.sign_changes[0])
        words = f"passes through a singular pose between t = {t[k]:.6g} and {t[k + 1]:.6g} s"
    if words:
        raise InputError(
            f"the path {words}: smallest singular value {found.smallest_singular_value:.2g} of the scaled Jacobian",
            key="motion",
            allowed=f"at least {SINGULAR:g}, and no change of sign of its determinant",
            next_step="There the legs cannot hold the platform: change the joints' places (half_angle) or the motion",
        )


def check_actuator_path(study: ActuatorStudy) -> list[str]:
    """Refuse an extension law that pulls the beam wholly into the hub or out of it; return remarks on times.

    Raises
    ------
    InputError
        The free length leaves (0, length] at an instant of the law, a torque about Z starts to turn a beam without
        inertia about its axis that stands upright, or the study's times do not fit each other.
    """
    try:
        remarks = check_outputs(study)
    except InputError as error:
        raise error.with_location(file=study.path) from None
    actuator, law = study.actuator, study.motion.extension
    spins = actuator.axial_inertia + actuator.tip_axial_inertia + actuator.hub_axial_inertia
    if study.motion.rotation is None and actuator.space and not spins and abs(np.cos(actuator.elevation)) < UPRIGHT:
        raise InputError(
            "stands the beam upright: nothing has an inertia about Z that the torque could turn",
            file=study.path,
            key="actuator.elevation",
            value=actuator.elevation,
            allowed="other elevations, or a beam with an inertia about its axis",
            next_step="Give actuator.hub_axial_inertia, or prescribe motion.rotation",
        )
    if law is None:
        return remarks
    t = path_instants(study)
    free = actuator.free_length + kinematics.motion_law(law, t).position
    for bad, words, limit in (
        (free <= 0, "slides wholly into the hub", 0.0),
        (free > actuator.length * (1 + 1e-12), "leaves the hub", actuator.length),
    ):
        if bad.any():
            raise InputError(
                f"the beam {words} at t = {t[np.argmax(bad)]:.6g} s: free length {free[np.argmax(bad)]:.6g} m, "
                f"limit {limit:.6g} m",
                file=study.path,
                key="motion.extension",
                next_step="Shorten simulation.duration, or change the law or actuator.free_length",
            )
    return remarks
