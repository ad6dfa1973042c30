"""The payload as a rigid body on SE(3) and its joints, Eqs. (T4.3)-(T4.6)."""

from types import SimpleNamespace

from flexapod.elements.rotations import from_quaternion, small_rotation
from flexapod.symbolic.vocabulary import SX, cross, matrix33, vertcat


def displaced_pose(pose: SX, step: SX) -> tuple[SX, SX]:
    """Centre of mass and rotation after the increment (dx, theta): x + dx, R exp(theta^), Eq. (T4.3)."""
    return pose[:3] + step[:3], from_quaternion(pose[3:]) @ small_rotation(step[3:])


def joint_point(joint: SX, x: SX, R: SX) -> SX:
    """World position of a spherical joint, Eq. (T4.4); ``joint`` from the CoM in platform axes."""
    return x + R @ joint


def joint_wrench(joint: SX, R: SX, force: SX) -> SX:
    """Force on the platform (world) and its moment about the CoM (platform axes) at a joint: P^T lam of (T4.7)."""
    return vertcat(force, cross(joint, R.T @ force))


def newton_euler(p: SimpleNamespace, R: SX, u: SX, u_dot: SX, net: SX, wrench: SX) -> SX:
    """Balance of force (world) and of moment about the CoM (platform axes), Eqs. (T4.5)-(T4.6).

    u = (velocity of the CoM in the world frame, angular velocity in platform axes); ``net`` is the sum over the legs of
    `joint_wrench`, ``wrench`` the force and moment at the tool in world axes.
    """
    J = matrix33(p.inertia)
    Omega, Omega_dot = u[3:], u_dot[3:]
    force = p.mass * p.gravity + wrench[:3] + net[:3]
    moment = cross(p.tool, R.T @ wrench[:3]) + R.T @ wrench[3:] + net[3:]
    return vertcat(
        p.mass * u_dot[:3] - force,  # (T4.5)
        J @ Omega_dot + cross(Omega, J @ Omega) - moment,  # (T4.6)
    )
