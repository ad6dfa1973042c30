"""Named results of a robot from its recorded time integration."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from flexapod.analysis.results.causes import shares_and_sums
from flexapod.analysis.results.lazy_arrays import ArraySource
from flexapod.analysis.results.leg_results import leg_labels, leg_results, sliding_words
from flexapod.analysis.results.legs import bending_basis, has_strokes, screw_travel, stroke_forces
from flexapod.analysis.results.rigid_path import RigidPath
from flexapod.analysis.results.time_history import Record
from flexapod.common.arrays import Array
from flexapod.kinematics.robot import robot_limbs
from flexapod.kinematics.rotations import canonical, difference, quaternion
from flexapod.kinematics.trajectory import coordinates, turning_axes
from flexapod.model import Robot, Study
from flexapod.solve.frames import base_on_mount, floor, shared_by_legs
from flexapod.solve.system import System

if TYPE_CHECKING:
    from flexapod.solve.kernel import Kernel


def robot_results(system: System, path: RigidPath, record: Record) -> dict[str, ArraySource]:
    """All variables of a robot's simulation but the rigid forces, by name; `path` at the recorded instants."""
    robot = path.robot
    return {
        **payload_results(path, record),
        **leg_results(system, path, record),
        **cause_results(system, path, record),
        **energy_results(record, robot.base_motion is not None),
        **frame_results(system, path, record),
        **command_results(path.study, record.time),
    }


def robot_coords(robot: Robot, system: System, record: Record) -> dict[str, ArrayLike]:
    """Labels of the dimensions whose size depends on the study."""
    shapes = system.kernel.shapes
    labels: dict[str, ArrayLike] = {"time": record.time, "leg": np.arange(1, robot.count + 1), **leg_labels(robot)}
    if count := bending_basis(shapes).count:
        labels["shape"] = np.arange(1, count + 1)
    if shapes.bristles:
        labels["slide"] = sliding_words(system)
    if shapes.beam.axial.count:
        labels["axial_shape"] = np.arange(shapes.beam.axial.count)
    return labels


def payload_results(path: RigidPath, record: Record) -> dict[str, ArraySource]:
    """Payload and tool against the rigid path."""
    robot, com = path.robot, record.pose[:, :3]
    e = cache(lambda: canonical(record.pose[:, 3:]))
    e_rigid = cache(lambda: quaternion(path.rotation))
    com_rigid = cache(lambda: path.place(robot.com))
    tool, tool_rigid = (
        cache(lambda: com + record.attitude @ (robot.tool - robot.com)),
        cache(lambda: path.place(robot.tool)),
    )
    return {
        "com_position_rigid": com_rigid,
        "com_position": com,
        "com_deviation": lambda: com - com_rigid(),
        "tool_position_rigid": tool_rigid,
        "tool_position": tool,
        "tool_deviation": lambda: tool() - tool_rigid(),
        "rotation_deviation": lambda: difference(e(), e_rigid()),
        "platform_quaternion": e,
        "platform_quaternion_rigid": e_rigid,
        "platform_angular_velocity": lambda: np.einsum("tij,tj->ti", record.attitude, record.turn),
    }


def cause_results(system: System, path: RigidPath, record: Record) -> dict[str, ArraySource]:
    """Deviation of the centre of mass by cause."""
    found = cache(lambda: shares_and_sums(system, path, record))
    return {
        "deviation_by_cause": lambda: found()[0],
        "deviation_residual": lambda: record.pose[:, :3] - path.place(path.robot.com) - found()[1],
    }


def rigid_force_results(path: RigidPath, kernel: Kernel | None = None) -> dict[str, ArraySource]:
    """Drive and joint forces of the rigid robot; `kernel`: equations of a simulation that has integrated the robot."""
    forces = cache(lambda: path.forces if kernel is None else path.forces_of_simulation(kernel))
    found: dict[str, ArraySource] = {
        "drive_force_rigid": lambda: forces().drive_force * screw_travel(path.robot),
        "joint_force_rigid": lambda: forces().joint_force,
    }
    if has_strokes(path.robot):
        found["actuator_force_rigid"] = lambda: stroke_forces(robot_limbs(path.robot), forces().drive_force)
    return found


def energy_results(record: Record, moved: bool = False) -> dict[str, Array]:
    """Energies, works and closure residual; kinetic + potential + strain + dissipated - works is constant.

    `moved`: the base, on which that does work.
    """
    return {
        "energy_kinetic": record.energy[:, 0],
        "energy_potential": record.energy[:, 1],
        "energy_strain": record.energy[:, 2],
        "energy_dissipated": record.sums[:, 0],
        "work_drive": record.sums[:, 1],
        "work_external": record.sums[:, 2],
        "closure_residual": record.closure,
        **({"work_base": record.sums[:, 3]} if moved else {}),
    }


def frame_results(system: System, path: RigidPath, record: Record) -> dict[str, ArraySource]:
    """Motion of base and plates on mounts, forces on the floor, and deviation relative to the base plate."""
    robot = path.robot
    found: dict[str, ArraySource] = {}
    for name, what in (("g", "base_motion"), ("f", "base_mount"), ("m", "platform_mount")):
        if system.kernel.shapes.has(name):
            moved = shared_by_legs(system, record.q, name)
            found |= {f"{what}_displacement": moved[:, :3], f"{what}_rotation": moved[:, 3:]}
    if system.floor.any():  # (T24.10)
        held = record.drive[:, :, system.floor].sum(axis=1)
        axes = turning_axes(shared_by_legs(system, record.q, "g")[:, 3:])
        moment = np.linalg.solve(axes.swapaxes(1, 2), held[:, 3:, None])[..., 0]
        found |= {"base_motion_force": held[:, :3], "base_motion_moment": moment}
    if system.kernel.shapes.has("f"):
        seen = cache(lambda: _from_the_base(robot, system, record))
        found |= {
            "tool_deviation_base": lambda: seen()[0] - path.poses.place(robot.tool),
            "rotation_deviation_base": lambda: difference(quaternion(seen()[1]), quaternion(path.poses.rotation)),
        }
    return found


def _from_the_base(robot: Robot, system: System, record: Record) -> tuple[Array, Array]:
    """Tool (T, 3) and attitude of the payload (T, 3, 3) as seen from the base plate."""
    R = record.attitude
    tool = record.pose[:, :3] + R @ (robot.tool - robot.com)
    return base_on_mount(system, robot, record.q).seen(*floor(system, robot, record.q).seen(tool, R))


def command_results(study: Study, t: Array) -> dict[str, ArraySource]:
    """Commanded surge, sway, heave and roll, pitch, yaw with rates and accelerations at instants (T,)."""
    law = cache(lambda: coordinates(study.motion, t))
    endings = {"": "position", "_rate": "rate", "_acceleration": "acceleration"}
    return {
        f"{kind}_command{ending}": lambda part=part, columns=columns: getattr(law(), part)[:, columns]
        for kind, columns in (("translation", slice(0, 3)), ("rotation", slice(3, 6)))
        for ending, part in endings.items()
    }
