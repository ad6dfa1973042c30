"""Rotations of the legs and of the payload, Eqs. (T3.4)-(T3.5) and (T4.1)."""

from flexapod.symbolic.vocabulary import SX, cos, sin, vertcat, zeros


def universal_joint(alpha: SX, beta: SX) -> SX:
    """Rx(alpha) Ry(beta): leg coordinates to the leg's home frame, Eq. (T3.4)."""
    R = zeros(3, 3)
    ca, sa, cb, sb = cos(alpha), sin(alpha), cos(beta), sin(beta)
    R[0, 0], R[0, 1], R[0, 2] = cb, 0, sb
    R[1, 0], R[1, 1], R[1, 2] = sa * sb, ca, -sa * cb
    R[2, 0], R[2, 1], R[2, 2] = -ca * sb, sa, ca * cb
    return R


def universal_joint_rate(beta: SX, alpha_dot: SX, beta_dot: SX) -> SX:
    """Angular velocity in leg coordinates; its third entry is the joint's real spin, Eq. (T3.5)."""
    return vertcat(alpha_dot * cos(beta), beta_dot, alpha_dot * sin(beta))


def from_quaternion(e: SX) -> SX:
    """Rotation matrix of a unit quaternion (w, x, y, z), platform to world, Eq. (T4.1)."""
    w, x, y, z = e[0], e[1], e[2], e[3]
    R = zeros(3, 3)
    R[0, 0], R[0, 1], R[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    R[1, 0], R[1, 1], R[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    R[2, 0], R[2, 1], R[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
    return R


def small_rotation(theta: SX) -> SX:
    """exp(theta^) to second order: exact for first and second derivatives at theta = 0, Eq. (T4.2)."""
    S = zeros(3, 3)
    S[0, 1], S[0, 2], S[1, 2] = -theta[2], theta[1], -theta[0]
    S[1, 0], S[2, 0], S[2, 1] = theta[2], -theta[1], theta[0]
    return SX.eye(3) + S + 0.5 * (S @ S)
