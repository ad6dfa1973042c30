"""From a recorded time integration of a robot to named results."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from flexapod import rigid
from flexapod.model import Robot, Study
from flexapod.rigid.trajectory import coordinates
from flexapod.solve.parameters import drive_spring
from flexapod.solve.rotation import matrix
from flexapod.solve.system import RobotSystem
from flexapod.solve.tables import Commands, command_law
from flexapod.study.causes import deviation_by_cause, length_errors
from flexapod.study.record import Record
from flexapod.typing import Array

__all__ = ["command_results", "energy_results", "robot_coords", "robot_results"]


def robot_results(study: Study, system: RobotSystem, record: Record) -> dict[str, Array]:
    """All variables of a robot's simulation but the rigid forces, by name."""
    path = rigid.poses(study.robot, study.motion, record.time)
    commands = command_law(study.robot, study.motion, study.load)(record.time)
    return {
        **_payload_results(study.robot, path, record),
        **_leg_results(study.robot, system, commands, record),
        **_cause_results(study.robot, system, path, commands, record),
        **energy_results(record),
        **command_results(study, record.time),
    }


def robot_coords(system: RobotSystem, record: Record) -> dict[str, ArrayLike]:
    """Labels of the dimensions whose size depends on the study."""
    shapes = system.kernel.shapes
    labels: dict[str, ArrayLike] = {"time": record.time}
    if shapes.a.count:
        labels["shape"] = np.arange(1, shapes.a.count + 1)
    if shapes.axial.count:
        labels["axial_shape"] = np.arange(shapes.axial.count)
    return labels


def _payload_results(robot: Robot, path: rigid.Poses, record: Record) -> dict[str, Array]:
    load, com = robot.payload, record.pose[:, :3]
    turn = Rotation.from_quat(record.pose[:, 3:], scalar_first=True)
    rigid_turn = Rotation.from_matrix(path.rotation)
    com_rigid, tool_rigid = path.point(load.com)[0], path.point(load.tool)[0]
    tool = com + turn.apply(load.tool - load.com)
    return {
        "com_position_rigid": com_rigid,
        "com_position": com,
        "com_deviation": com - com_rigid,
        "tool_position_rigid": tool_rigid,
        "tool_position": tool,
        "tool_deviation": tool - tool_rigid,
        "rotation_deviation": (turn * rigid_turn.inv()).as_rotvec(),
        "platform_quaternion": turn.as_quat(canonical=True, scalar_first=True),
        "platform_quaternion_rigid": rigid_turn.as_quat(canonical=True, scalar_first=True),
        "platform_angular_velocity": turn.apply(record.turn),
    }


def _flexible_lengths(robot: Robot, record: Record) -> Array:
    """Joint-to-joint lengths of the flexible robot, (T, 6) [m], Eq. (T8.1)."""
    R = matrix(record.pose[:, 3:])
    joints = robot.platform_joints - robot.payload.com
    return rigid.leg_lengths(robot.base_joints, joints, record.pose[:, :3], R)


def _leg_results(robot: Robot, system: RobotSystem, commands: Commands, record: Record) -> dict[str, Array]:
    shapes, q = system.kernel.shapes, record.q
    k, first = shapes.a.count, 3 + shapes.axial.count
    lateral = q[:, :, first:].reshape(*q.shape[:2], 2, k)
    results = {
        "leg_length_command": commands.length,
        "leg_length": _flexible_lengths(robot, record),
        "leg_stroke": q[:, :, shapes.l_index],
        "leg_angle": q[:, :, :2],
        "actuator_force": _drive_forces(robot, system, commands, record),
        "tip_deflection": lateral @ shapes.a.tip,
        "joint_force": record.lam,
    }
    if k:
        results["lateral_amplitude"] = lateral
    if shapes.axial.count:
        results["axial_amplitude"] = q[:, :, 3:first]
    return results


def _drive_forces(robot: Robot, system: RobotSystem, commands: Commands, record: Record) -> Array:
    """Force of every drive on its piston, (T, 6) [N]: constraint, or feed-forward, spring and damper, Eq. (T8.8)."""
    stiffness, damping = np.array([drive_spring(leg) for leg in robot.legs]).T
    l_index = system.kernel.shapes.l_index
    spring = stiffness * (commands.length - record.q[:, :, l_index])
    spring = spring + damping * (commands.rate - record.rate[:, :, 0])
    return np.where(system.held, record.drive[:, :, 0], commands.force + spring)


def _cause_results(
    robot: Robot, system: RobotSystem, path: rigid.Poses, commands: Commands, record: Record
) -> dict[str, Array]:
    shapes = system.kernel.shapes
    errors = length_errors(
        length=_flexible_lengths(robot, record),
        command=commands.length,
        stroke=record.q[:, :, shapes.l_index],
        stretch=record.q[:, :, 3] if shapes.axial.count else np.zeros(commands.length.shape),
    )
    shares = deviation_by_cause(robot, path, errors)
    deviation = record.pose[:, :3] - path.point(robot.payload.com)[0]
    return {"deviation_by_cause": shares, "deviation_residual": deviation - shares.sum(axis=(1, 2))}


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
