"""The payload as a rigid body on SE(3) and its joints, Eqs. (T4.3)-(T4.6)."""

from types import SimpleNamespace

from flexapod.mechanics.elements.frames import Frame
from flexapod.mechanics.elements.mount import displaced
from flexapod.mechanics.elements.rotations import from_quaternion, small_rotation
from flexapod.mechanics.symbolic.vocabulary import SX, cross, jacobian, matrix33, time_derivative, vertcat, zeros


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


def plate_frame(p: SimpleNamespace, R: SX, u: SX, moved: SX, rate: SX) -> Frame:
    """Frame of the plate below a payload on a mount, at the plate's centre of mass; its origin from the payload's CoM.

    ``moved``, ``rate`` (6): displacement along platform axes and roll, pitch, yaw of the plate against the payload.
    """
    payload = Frame(origin=zeros(3), axes=R, velocity=R.T @ u[:3], omega=u[3:])
    return displaced(payload, p.plate_at, moved, rate).moved(p.plate_at, zeros(3))


def plate_balance(p: SimpleNamespace, R: SX, u: SX, u_dot: SX, m: tuple[SX, ...]) -> SX:
    """What the plate adds to the balances of the payload (6) and of the mount's coordinates (6), Eq. (T24.6).

    ``m``: the mount's coordinates, rates and accelerations. Momentum and spin projected on the motions that the
    coordinates allow.
    """
    q, v, v_dot = m
    frame, J = plate_frame(p, R, u, q, v), matrix33(p.plate_inertia)
    w = frame.omega
    moving = vertcat(u, v)

    def rate(x: SX) -> SX:
        return time_derivative(x, (q, v), (moving, vertcat(u_dot, v_dot)))

    acceleration = rate(frame.velocity) + cross(w, frame.velocity)
    # platform axes turn while they are differentiated: R enters by the linear velocity alone
    acceleration -= jacobian(frame.velocity, u[:3]) @ (R @ cross(u[3:], R.T @ u[:3]))
    spin = J @ rate(w) + cross(w, J @ w)
    return (
        jacobian(frame.velocity, moving).T @ (p.plate_mass * acceleration - p.plate_weighs * (frame.axes.T @ p.gravity))
        + jacobian(w, moving).T @ spin
    )
