"""From a recorded time integration of a robot to named results."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from flexapod import rigid
from flexapod.model import Robot, Study
from flexapod.rigid.rotations import canonical, difference, matrix, quaternion
from flexapod.rigid.trajectory import coordinates
from flexapod.solve.system import System
from flexapod.study.after.causes import deviation_by_cause, length_errors
from flexapod.study.path import RigidPath
from flexapod.study.record import Record
from flexapod.typing import Array

__all__ = [
    "cause_results",
    "command_results",
    "energy_results",
    "leg_results",
    "payload_results",
    "rigid_force_results",
    "robot_coords",
    "robot_results",
]


def robot_results(study: Study, system: System, record: Record, path: RigidPath) -> dict[str, Array]:
    """All variables of a robot's simulation but the rigid forces, by name; `path` at the recorded instants."""
    robot = study.robot
    legs = leg_results(robot, system, path, record)
    return {
        **payload_results(robot, path, record),
        **legs,
        **cause_results(robot, system, path, record, legs["leg_length"]),
        **energy_results(record),
        **command_results(study, record.time),
    }


def robot_coords(system: System, record: Record) -> dict[str, ArrayLike]:
    """Labels of the dimensions whose size depends on the study."""
    shapes = system.kernel.shapes
    labels: dict[str, ArrayLike] = {"time": record.time}
    if shapes.a.count:
        labels["shape"] = np.arange(1, shapes.a.count + 1)
    if shapes.axial.count:
        labels["axial_shape"] = np.arange(shapes.axial.count)
    return labels


def payload_results(robot: Robot, path: RigidPath, record: Record) -> dict[str, Array]:
    """Payload and tool against the rigid path."""
    load, com = robot.payload, record.pose[:, :3]
    e, e_rigid = canonical(record.pose[:, 3:]), quaternion(path.poses.rotation)
    R = matrix(e)
    com_rigid, tool_rigid = path.poses.place(load.com), path.poses.place(load.tool)
    tool = com + R @ (load.tool - load.com)
    return {
        "com_position_rigid": com_rigid,
        "com_position": com,
        "com_deviation": com - com_rigid,
        "tool_position_rigid": tool_rigid,
        "tool_position": tool,
        "tool_deviation": tool - tool_rigid,
        "rotation_deviation": difference(e, e_rigid),
        "platform_quaternion": e,
        "platform_quaternion_rigid": e_rigid,
        "platform_angular_velocity": np.einsum("tij,tj->ti", R, record.turn),
    }


def _flexible_lengths(robot: Robot, record: Record) -> Array:
    """Joint-to-joint lengths of the flexible robot, (T, legs) [m], Eq. (T8.1)."""
    R = matrix(record.pose[:, 3:])
    joints = robot.platform_joints - robot.payload.com
    return rigid.leg_lengths(robot.base_joints, joints, record.pose[:, :3], R)


def leg_results(robot: Robot, system: System, path: RigidPath, record: Record) -> dict[str, Array]:
    """Lengths, angles, deflections and forces of the legs."""
    shapes, q = system.kernel.shapes, record.q
    k, first = shapes.a.count, 3 + shapes.axial.count
    lateral = q[:, :, first:].reshape(*q.shape[:2], 2, k)
    results = {
        "leg_length_command": path.legs.length,
        "leg_length": _flexible_lengths(robot, record),
        "leg_stroke": q[:, :, shapes.l_index],
        "leg_angle": q[:, :, :2],
        "actuator_force": record.drive[:, :, 0],
        "tip_deflection": lateral @ shapes.a.tip,
        "joint_force": record.lam,
    }
    if k:
        results["lateral_amplitude"] = lateral
    if shapes.axial.count:
        results["axial_amplitude"] = q[:, :, 3:first]
    return results


def cause_results(robot: Robot, system: System, path: RigidPath, record: Record, length: Array) -> dict[str, Array]:
    """Deviation of the centre of mass by cause; ``length`` (T, legs): joint to joint [m]."""
    shapes = system.kernel.shapes
    errors = length_errors(
        length=length,
        command=path.legs.length,
        stroke=record.q[:, :, shapes.l_index],
        stretch=record.q[:, :, 3] if shapes.axial.count else np.zeros(length.shape),
    )
    shares = deviation_by_cause(robot, path.poses, errors)
    deviation = record.pose[:, :3] - path.poses.place(robot.payload.com)
    return {
        "deviation_by_cause": shares,
        "deviation_residual": deviation - shares.reshape(len(shares), -1, 3).sum(axis=1),
    }


def rigid_force_results(path: RigidPath) -> dict[str, Array]:
    """Drive and joint forces of the rigid robot."""
    return {"actuator_force_rigid": path.forces.actuator_force, "joint_force_rigid": path.forces.joint_force}


def energy_results(record: Record) -> dict[str, Array]:
    """Energies, works and closure residual; kinetic + potential + strain + dissipated - works is constant."""
    return {
        "energy_kinetic": record.energy[:, 0],
        "energy_potential": record.energy[:, 1],
        "energy_strain": record.energy[:, 2],
        "energy_dissipated": record.sums[:, 0],
        "work_drive": record.sums[:, 1],
        "work_external": record.sums[:, 2],
        "closure_residual": record.closure,
    }


def command_results(study: Study, t: Array) -> dict[str, Array]:
    """Commanded surge, sway, heave and roll, pitch, yaw with rates and accelerations at instants (T,)."""
    law = coordinates(study.motion, t)
    endings = {"": law.position, "_rate": law.rate, "_acceleration": law.acceleration}
    return {
        f"{kind}_command{ending}": part[:, columns]
        for kind, columns in (("translation", slice(0, 3)), ("rotation", slice(3, 6)))
        for ending, part in endings.items()
    }
