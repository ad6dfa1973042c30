"""Limits of drives over what poses and a motion ask: forces, speeds, accelerations."""

from __future__ import annotations

import numpy as np

from flexapod import kinematics
from flexapod.analysis.checks.screws import buckling_shares, critical_speed, drag_torque
from flexapod.analysis.description.hydraulic_description import describe_hydraulics
from flexapod.analysis.description.screw_description import describe_screws
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.common.arrays import Array, Mask
from flexapod.model import Leg, Robot, Study

STARTING = np.array(1e-9)  # [rad/s]: of a screw that has just begun to turn


def has_force_limits(robot: Robot) -> bool:
    """Test whether any drive has a limit of its force, torque or pressure."""
    return any(np.isfinite(_force_limits(leg)).any() for leg in robot.legs)


def _force_limits(leg: Leg) -> Array:
    """Largest push and pull of a drive at rest [N], (2,); inf without limits."""
    most = np.full(2, np.inf)
    if leg.screw is not None:
        limits, screw = leg.screw.limits, leg.screw
        if limits.force is not None:
            most = np.minimum(most, limits.force)
        if limits.torque is not None:
            most = np.minimum(most, limits.torque * screw.rotor.ratio / screw.per_turn)
    if leg.cylinder_of_oil is not None and leg.cylinder_of_oil.limits.pressure is not None:
        most = np.minimum(most, leg.cylinder_of_oil.limits.pressure * np.array(leg.cylinder_of_oil.areas))
    return most


def rest_shares(robot: Robot, force: Array) -> Array:
    """Forces of drives at rest (P, legs) [N] over their limits, (P, legs); 0 of drives without limits."""
    limits = np.array([_force_limits(leg) for leg in robot.legs])
    return np.maximum(force, 0.0) / limits[:, 0] + np.maximum(-force, 0.0) / limits[:, 1]


def shaft_shares(robot: Robot, length: Array, force: Array) -> Array:
    """Thrusts of screws at rest over what their shafts bear without buckling, of legs (P, legs) [m], [N]; else 0."""
    found = np.zeros(force.shape)
    for i, leg in enumerate(robot.legs):
        if leg.screw is not None:
            found[:, i] = buckling_shares(leg.screw, length[:, i] - leg.begins, force[:, i])
    return found


def motion_shares(path: RigidPath) -> Array:
    """Largest need of the drives along a path over their limits, (legs,); 0 of drives without limits."""
    found = np.zeros(path.robot.count)
    for one in describe_screws(path):
        limits = path.robot.legs[one.leg - 1].screw.limits  # type: ignore[union-attr]
        needs = ((one.thrust.value, limits.force), (one.torque.value, limits.torque))
        needs += ((one.rms_torque, limits.rms_torque),)
        found[one.leg - 1] = max([0.0, *(need / limit for need, limit in needs if limit is not None)])
    for one in describe_hydraulics(path):
        limit = path.robot.legs[one.leg - 1].cylinder_of_oil.limits.pressure  # type: ignore[union-attr]
        found[one.leg - 1] = 0.0 if limit is None else one.pressure.value / limit
    return found


def rate_limits(robot: Robot) -> Array:
    """Rates of the drives' strokes that their motors, shafts and supply allow, (legs,) [m/s]; inf without limits."""
    most = np.full(robot.count, np.inf)
    for i, leg in enumerate(robot.legs):
        if leg.screw is not None:
            speed, screw = critical_speed(leg.screw), leg.screw
            if screw.limits.speed is not None:
                speed = min(speed, screw.limits.speed / screw.rotor.ratio)
            most[i] = speed * screw.per_turn
        if leg.cylinder_of_oil is not None and leg.cylinder_of_oil.limits.flow is not None:
            most[i] = min(most[i], leg.cylinder_of_oil.limits.flow / max(leg.cylinder_of_oil.areas))
    return most


def free_columns(robot: Robot) -> Mask:
    """Mask (6,) of the motions of the platform, of a robot whose platform moves in all directions or in a plane."""
    return ~kinematics.rigid_limbs(robot).hub_held


def speeds(at: kinematics.RigidPoses, *, turning: bool) -> Array:
    """Speed of the tool at which each driven leg reaches its rate limit, worst direction, (P, legs) [m/s, rad/s]."""
    robot = at.robot
    columns = np.flatnonzero(free_columns(robot)[3:] if turning else free_columns(robot)[:3]) + 3 * turning
    per_speed = np.linalg.norm(at.drive_jacobian(robot.tool)[:, :, columns], axis=2)
    driven = np.array([bool(leg.driven) for leg in robot.legs])
    found = np.full((len(at.poses), robot.count), np.inf)
    with np.errstate(divide="ignore"):
        found[:, driven] = rate_limits(robot)[driven] / per_speed
    return found


def accelerations(study: Study, poses: kinematics.Poses) -> Array:
    """Acceleration from rest, worst direction, at which each drive reaches its limits, (P, legs) [m/s^2].

    Rigid inverse dynamics of payload and legs, linear in the acceleration; the torque of a screw is that of one which
    turns against its thrust, with friction.
    """
    robot = study.robot
    axes = np.eye(3)[free_columns(robot)[:3]]
    still = _forces(study, poses, np.zeros(3))
    moved = [_forces(study, poses, axis) for axis in axes]
    per_force = np.stack([force - still[0] for force, _ in moved], axis=-1)  # (P, legs, axes)
    per_accel = np.stack([accel - still[1] for _, accel in moved], axis=-1)
    found = np.full(still[0].shape, np.inf)
    for i, leg in enumerate(robot.legs):
        force, gain = still[0][:, i], np.linalg.norm(per_force[:, i], axis=-1)
        pairs = [_left(np.abs(force), gain, limit) for limit in _thrust_limits(leg)]
        most = None if leg.screw is None else leg.screw.limits.torque
        if leg.screw is not None and most is not None:
            screw, ratio = leg.screw, leg.screw.rotor.ratio
            torque = np.abs(force) * screw.per_turn / screw.efficiency + np.abs(drag_torque(screw, STARTING))
            change = (
                per_force[:, i] * screw.per_turn / screw.efficiency + screw.inertia * per_accel[:, i] / screw.per_turn
            )
            pairs.append(_left(torque / ratio, np.linalg.norm(change, axis=-1) / ratio, most))
        if pairs:
            found[:, i] = np.min(pairs, axis=0)
    return found


def _thrust_limits(leg: Leg) -> list[float]:
    """Limits of the thrust itself [N]: of a screw that of its catalogue, of a cylinder that of its smaller area."""
    found = []
    if leg.screw is not None and leg.screw.limits.force is not None:
        found.append(leg.screw.limits.force)
    if leg.cylinder_of_oil is not None and leg.cylinder_of_oil.limits.pressure is not None:
        found.append(leg.cylinder_of_oil.limits.pressure * min(leg.cylinder_of_oil.areas))
    return found


def _left(need: Array, gain: Array, limit: float) -> Array:
    """Acceleration at which a need that grows in proportion reaches its limit; 0 where it is beyond it at rest."""
    with np.errstate(divide="ignore"):
        return np.maximum(limit - need, 0.0) / gain


def _forces(study: Study, poses: kinematics.Poses, acceleration: Array) -> tuple[Array, Array]:
    """Forces of the drives [N] and accelerations of the strokes [m/s^2], each (P, legs)."""
    zero = np.zeros((len(poses), 3))
    moving = kinematics.Poses(
        position=poses.position, rotation=poses.rotation, velocity=zero, omega=zero, alpha=zero,
        acceleration=np.broadcast_to(acceleration, zero.shape),
    )  # fmt: skip
    path = RigidPath(study, np.zeros(len(poses)), moving)
    return path.forces.drive_force, path.legs.accel
