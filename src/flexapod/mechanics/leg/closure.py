"""How a leg meets the payload where it knows its pose; loads on a tip without payload, Eqs. (T13.12)-(T13.16)."""

from types import SimpleNamespace

from flexapod.mechanics.elements.mount import turn
from flexapod.mechanics.elements.rotations import hat
from flexapod.mechanics.leg.leg import LegEquations
from flexapod.mechanics.leg.payload import displaced_pose, joint_point, joint_wrench
from flexapod.mechanics.leg.platform_joint import gimbal
from flexapod.mechanics.symbolic.vocabulary import SX, Through, dot, matrix33, substitute, symbol, trace, vertcat


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
        in_platform = turn(qs.m[3:]) @ in_platform
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
    """Of a ball on a plate below the payload, on a mount: gap (3) and wrench (6) as of `pose_closure`."""
    x, R = displaced_pose(pose, step)
    joint = _joint(qs, p)
    return body.tip - joint_point(joint, x, R), joint_wrench(joint, R, lam)


def _joint(qs: SimpleNamespace, p: SimpleNamespace) -> SX:
    """Place of the joint from the payload's CoM in platform axes, moved by the mount of its plate, Eq. (T24.5)."""
    if not hasattr(qs, "m"):
        return p.joint
    return p.platform_mount_at + qs.m[:3] + turn(qs.m[3:]) @ (p.joint - p.platform_mount_at)


def _skew(Q: SX) -> SX:
    """Vector of Q - Q^T."""
    return vertcat(Q[2, 1] - Q[1, 2], Q[0, 2] - Q[2, 0], Q[1, 0] - Q[0, 1])


def load_force(body: LegEquations, by_q: Through, load: SX) -> SX:
    """Generalised force of a load on the tip, Eq. (T13.16).

    ``load`` (12): force and moment in the world's axes, then force and moment that follow the tip's axes.
    """
    A = by_q.value(body.tip_axes)
    force, moment = load[:3] + A @ load[6:9], load[3:6] + A @ load[9:]
    frozen = symbol("frozen", 15)
    turning = dot(hat(frozen[12:]) @ matrix33(frozen[3:12]), body.tip_axes)
    work = dot(frozen[:3], body.tip) + 0.5 * turning
    return substitute(by_q.gradient(work), (frozen,), (vertcat(force, A.reshape((9, 1)), moment),))
