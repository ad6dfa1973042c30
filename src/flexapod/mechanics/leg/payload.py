"""Payload as a rigid body on SE(3) with its joints, and closures of legs, Eqs. (T4.3)-(T4.6), (T13.12)-(T13.16).

Closures are of a point, or of the pose where a leg knows the payload's; a tip without payload has loads.
"""

from __future__ import annotations

from types import SimpleNamespace

from flexapod.mechanics.elements.frames import Frame, from_quaternion, hat, small_rotation
from flexapod.mechanics.elements.mount import displaced_frame, roll_pitch_yaw
from flexapod.mechanics.leg.joints import gimbal
from flexapod.mechanics.leg.leg import LegEquations
from flexapod.mechanics.symbolic.vocabulary import (
    SX,
    ChainRule,
    cross,
    dot,
    jacobian,
    matrix33,
    substitute,
    symbol,
    time_derivative,
    trace,
    vertcat,
    zeros,
)


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
    return displaced_frame(payload, p.plate_at, moved, rate).moved(p.plate_at, zeros(3))


def plate_balance(p: SimpleNamespace, R: SX, u: SX, u_dot: SX, m: tuple[SX, ...]) -> SX:
    """Terms of the plate in the balances of the payload (6) and of the mount's coordinates (6), Eq. (T24.6).

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


def pose_closure(
    body: LegEquations, qs: SimpleNamespace, p: SimpleNamespace, lam: SX, pose: SX, step: SX
) -> tuple[SX, SX]:
    """Gap between the leg's tip and the joint of the payload (6) [m], and the wrench of ``lam`` on the payload (6).

    ``step`` displaces the payload from ``pose``. The wrench is the force in the world and the moment about the CoM in
    platform axes.
    """
    x, R = displaced_pose(pose, step)
    in_platform, axes, tip = matrix33(p.platform_frame), body.tip_axes @ matrix33(p.leg_frame), body.tip
    joint = _joint(qs, p)
    if hasattr(qs, "m"):
        in_platform = roll_pitch_yaw(qs.m[3:]) @ in_platform
    if hasattr(p, "platform_flexure"):
        tip += axes @ vertcat(qs.e1, qs.e2, qs.e3)
    Q = (R @ in_platform).T @ gimbal(axes, qs)
    force, mu = lam[:3], 0.5 * p.L_c * lam[3:]
    gap = vertcat(tip - joint_point(joint, x, R), 0.5 * p.L_c * _skew(Q))  # (T13.12)
    wrench = joint_wrench(joint, R, force)
    wrench[3:] += in_platform @ (trace(Q) * mu - Q.T @ mu)  # (T13.13)
    return gap, wrench


def ball_closure(
    body: LegEquations, qs: SimpleNamespace, p: SimpleNamespace, lam: SX, pose: SX, step: SX
) -> tuple[SX, SX]:
    """Closure of a ball on a plate below the payload, on a mount: gap (3) and wrench (6) as of `pose_closure`."""
    x, R = displaced_pose(pose, step)
    joint = _joint(qs, p)
    return body.tip - joint_point(joint, x, R), joint_wrench(joint, R, lam)


def _joint(qs: SimpleNamespace, p: SimpleNamespace) -> SX:
    """Place of the joint from the payload's CoM in platform axes, moved by the mount of its plate, Eq. (T24.5)."""
    if not hasattr(qs, "m"):
        return p.joint
    return p.platform_mount_at + qs.m[:3] + roll_pitch_yaw(qs.m[3:]) @ (p.joint - p.platform_mount_at)


def _skew(Q: SX) -> SX:
    """Vector of Q - Q^T."""
    return vertcat(Q[2, 1] - Q[1, 2], Q[0, 2] - Q[2, 0], Q[1, 0] - Q[0, 1])


def load_force(body: LegEquations, by_q: ChainRule, load: SX) -> SX:
    """Generalised force of a load on the tip, Eq. (T13.16).

    ``load`` (12): force and moment in the world's axes, then force and moment that follow the tip's axes.
    """
    A = by_q.value(body.tip_axes)
    force, moment = load[:3] + A @ load[6:9], load[3:6] + A @ load[9:]
    frozen = symbol("frozen", 15)
    turning = dot(hat(frozen[12:]) @ matrix33(frozen[3:12]), body.tip_axes)
    work = dot(frozen[:3], body.tip) + 0.5 * turning
    return substitute(by_q.gradient(work), (frozen,), (vertcat(force, A.reshape((9, 1)), moment),))
