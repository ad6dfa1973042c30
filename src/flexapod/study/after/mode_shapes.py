"""Results of the modes at one pose: shapes of platform and legs, kinds, and where the robot rests."""

from __future__ import annotations

import numpy as np

from flexapod import model, rigid
from flexapod.rigid.rotations import matrix, quaternion
from flexapod.solve.modes import RobotModes
from flexapod.study.after.kinds import mode_kinds
from flexapod.study.after.legs import bending_basis, lateral
from flexapod.typing import Array

__all__ = ["STATIONS", "mode_values"]

STATIONS = np.linspace(0.0, 1.0, 41)


def mode_values(robot: model.Robot, found: RobotModes, path: rigid.Poses) -> dict[str, Array]:
    """Variables of `flexapod.modes` at one pose, by name; ``path`` is the rigid pose."""
    at, R, com = found.equilibrium.state.pose, matrix(found.equilibrium.state.pose[3:]), robot.payload.com
    platform = np.concatenate([found.shapes[:, -6:-3], found.shapes[:, -3:] @ R.T], axis=1)
    return {
        "frequency": found.frequency,
        "damping_ratio": found.damping_ratio,
        "kind": np.array(mode_kinds(found)),
        "platform_shape": platform,
        "leg_shape": _leg_shapes(robot, found),
        "leg_stretch": _stretch(robot, at, platform),
        "platform_position": at[:3] - R @ com,
        "platform_quaternion": quaternion(R),
        "com_sag": at[:3] - path.point(com)[0][0],
    }


def _leg_shapes(robot: model.Robot, found: RobotModes) -> Array:
    """Lateral displacement of every leg off the line of its joints, (m, legs, 2, stations) [m]."""
    shapes, count = found.system.kernel.shapes, len(robot.legs)
    basis = bending_basis(shapes)
    legs = lateral(shapes, found.shapes[:, :-6].reshape(len(found.shapes), count, found.system.n))
    result = np.zeros((*legs.shape[:3], len(STATIONS)))
    for i, leg in enumerate(robot.legs):
        length = found.equilibrium.state.q[i, shapes.l_index]
        zeta = np.clip((STATIONS * length - leg.cylinder.mouth) / (length - leg.cylinder.mouth), 0.0, 1.0)
        values = basis.values(zeta) if basis.count else np.zeros((0, len(STATIONS)))
        off_chord = values - np.outer(basis.tip, STATIONS)
        result[:, i] = legs[:, i] @ off_chord
    return result


def _stretch(robot: model.Robot, pose: Array, platform: Array) -> Array:
    """Change of joint-to-joint lengths in each mode, (m, legs) [m]: rows of the Jacobian at the CoM, Eq. (T2.21)."""
    jacobian = rigid.length_jacobian(
        robot.base_joints, robot.platform_joints - robot.payload.com, pose[:3], matrix(pose[3:]), np.zeros(3)
    )
    return platform @ jacobian.T
