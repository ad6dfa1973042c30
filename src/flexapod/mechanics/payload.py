"""The payload as a rigid body on SE(3) and its joint points, Eqs. (T4.3)-(T4.6)."""

from types import SimpleNamespace

from flexapod.elements.rotations import from_quaternion, small_rotation
from flexapod.symbolic.vocabulary import SX, cross, matrix33, mtimes, vertcat


def displaced_pose(pose: SX, step: SX) -> tuple[SX, SX]:
    """Centre of mass and rotation after the increment (dx, theta): x + dx, R exp(theta^), Eq. (T4.3)."""
    return pose[:3] + step[:3], from_quaternion(pose[3:]) @ small_rotation(step[3:])


def joint_points(p: SimpleNamespace, x: SX, R: SX) -> SX:
    """World positions of the six spherical joints, one below the other, Eq. (T4.4)."""
    return vertcat(*[x + mtimes(R, p.joints[3 * i : 3 * i + 3]) for i in range(6)])


def newton_euler(p: SimpleNamespace, R: SX, u: SX, u_dot: SX, forces: SX, wrench: SX) -> SX:
    """Balance of force (world) and of moment about the CoM (platform axes), Eqs. (T4.5)-(T4.6).

    u = (velocity of the CoM in the world frame, angular velocity in platform axes); ``forces`` are the six joint forces
    on the platform and ``wrench`` the force and moment at the tool, all in world axes.
    """
    J = matrix33(p.inertia)
    Omega, Omega_dot = u[3:], u_dot[3:]
    force = p.mass * p.gravity + wrench[:3]
    moment = cross(p.tool, R.T @ wrench[:3]) + R.T @ wrench[3:]
    for i in range(6):
        f = forces[3 * i : 3 * i + 3]
        force += f
        moment += cross(p.joints[3 * i : 3 * i + 3], R.T @ f)
    return vertcat(
        p.mass * u_dot[:3] - force,  # (T4.5)
        J @ Omega_dot + cross(Omega, J @ Omega) - moment,  # (T4.6)
    )
