"""Results of the modes at one pose: shapes of platform and legs, kinds, and where the robot rests."""

from __future__ import annotations

import numpy as np

from flexapod import model, rigid
from flexapod.rigid.rotations import matrix, quaternion
from flexapod.solve.modes import RobotModes
from flexapod.study.after.kinds import mode_kinds
from flexapod.study.after.legs import base_points, bending_basis, lateral
from flexapod.typing import Array

STATIONS = np.linspace(0.0, 1.0, 41)


def mode_values(robot: model.Robot, found: RobotModes, path: rigid.Poses) -> dict[str, Array]:
    """Variables of `flexapod.modes` at one pose, by name; ``path`` is the rigid pose."""
    at, R, com = found.equilibrium.state.pose, matrix(found.equilibrium.state.pose[3:]), robot.com
    platform = np.concatenate([found.shapes[:, -6:-3], found.shapes[:, -3:] @ R.T], axis=1)
    return {
        "frequency": found.frequency,
        "damping_ratio": found.damping_ratio,
        "kind": np.array(mode_kinds(found)),
        "platform_shape": platform,
        "leg_shape": _leg_shapes(robot, found),
        "leg_stretch": _stretch(robot, found, platform),
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


def _stretch(robot: model.Robot, found: RobotModes, platform: Array) -> Array:
    """Change of joint-to-joint lengths in each mode, (m, legs) [m]: rows of the Jacobian at the CoM, Eq. (T2.21)."""
    state, system, legs = found.equilibrium.state, found.system, rigid.rigid_limbs(robot)
    at = state.pose
    if not legs.carriage:
        joints = robot.platform_joints - robot.com
        return platform @ rigid.length_jacobian(legs.base, joints, at[:3], matrix(at[3:]), np.zeros(3)).T
    chi = system.kernel.shapes.index("chi")
    by_leg = found.shapes[:, :-6].reshape(len(found.shapes), system.legs, system.n)[..., chi]
    feet = base_points(legs, state.q[:, chi])
    arms = (robot.platform_joints - robot.com) @ matrix(at[3:]).T
    axes = at[:3] + arms - feet
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    tips = platform[:, None, :3] + np.cross(platform[:, None, 3:], arms)
    moved = by_leg[..., None] * _ways(legs, feet)
    return ((tips - moved) * axes).sum(axis=-1)


def _ways(legs: rigid.Limbs, feet: Array) -> Array:
    """Velocities of the feet (legs, 3) for unit rates of their carriages."""
    if legs.carriage == "slider":
        return legs.carriage_axis
    return np.cross(legs.carriage_axis, feet - legs.base + legs.carriage_arm)
