"""Newton-Euler inverse dynamics of the rigid robot, Eqs. (T2.26)-(T2.36).

Order of the computation: the moment balance of each leg about its universal joint gives the force across the leg at
the platform joint; the six balances of the payload give the force along the legs; the piston gives the drive force.

References
----------
Dasgupta & Mruthyunjaya, "A Newton-Euler formulation for the inverse dynamics of the Stewart platform manipulator",
Mech. Mach. Theory 33 (1998) 1135-1152. Here the legs turn about their own axis as the universal joint makes them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flexapod.errors import ComputationError
from flexapod.rigid.kinematics import LegState, leg_rotations
from flexapod.rigid.trajectory import Poses
from flexapod.typing import Array

__all__ = ["LegBodies", "PayloadBody", "RigidForces", "energies", "inverse_dynamics"]


@dataclass(frozen=True, kw_only=True)
class LegBodies:
    """Masses of n legs, each array of shape (n,).

    Attributes
    ----------
    cylinder_mass, cylinder_com, cylinder_inertia, cylinder_axial
        [kg], distance from the universal joint [m], transverse about the CoM and axial [kg m^2].
    piston_mass, piston_length, piston_axial
        [kg], [m] of a uniform slender rod, [kg m^2].
    """

    cylinder_mass: Array
    cylinder_com: Array
    cylinder_inertia: Array
    cylinder_axial: Array
    piston_mass: Array
    piston_length: Array
    piston_axial: Array

    @property
    def axial(self) -> Array:
        """Moment of inertia about the leg's axis [kg m^2], shape (n,)."""
        return self.cylinder_axial + self.piston_axial

    def piston_com(self, length: Array) -> Array:
        """Distance of the piston's CoM from the universal joint [m] at joint-to-joint `length` (T, n)."""
        return length - self.piston_length / 2

    def static_moment(self, length: Array) -> Array:
        """Mass times distance of its centre from the universal joint [kg m], shape (T, n)."""
        return self.cylinder_mass * self.cylinder_com + self.piston_mass * self.piston_com(length)

    def transverse(self, length: Array) -> Array:
        """Moment of inertia about the universal joint, across the leg [kg m^2], Eq. (T2.26), shape (T, n)."""
        return (
            self.cylinder_inertia
            + self.cylinder_mass * self.cylinder_com**2
            + self.piston_mass * (self.piston_length**2 / 12 + self.piston_com(length) ** 2)
        )


@dataclass(frozen=True, kw_only=True)
class PayloadBody:
    """Payload with the platform: mass [kg], inertia (3, 3) about the CoM, com (3,), tool (3,), platform axes."""

    mass: float
    inertia: Array
    com: Array
    tool: Array


@dataclass(frozen=True, kw_only=True)
class RigidForces:
    """Forces of the rigid robot along a path of T poses, world axes.

    Attributes
    ----------
    actuator_force : ndarray, shape (T, 6)
        Of the drive on the piston along the leg [N]; positive pushes out.
    joint_force : ndarray, shape (T, 6, 3)
        Of the legs on the platform [N].
    base_force, base_moment : ndarray, shape (T, 6, 3)
        Of the base on the legs, at the universal joints [N], [N m].
    """

    actuator_force: Array
    joint_force: Array
    base_force: Array
    base_moment: Array


@dataclass(frozen=True, kw_only=True)
class _LegMotion:
    """Legs in their own axes (z along the leg): rotation to world, angular velocity and its rate, accelerations."""

    rotation: Array  # (T, n, 3, 3)
    w: Array  # (T, n, 3) [rad/s]
    w_dot: Array  # (T, n, 3) components' rate [rad/s^2]
    cylinder_acceleration: Array  # (T, n, 3) of the CoM [m/s^2]
    piston_acceleration: Array


def _leg_motion(frames: Array, bodies: LegBodies, legs: LegState) -> _LegMotion:
    """Angular rates of the legs, turn about their axis included, and CoM accelerations, Eqs. (T2.27)-(T2.28)."""
    cb, sb = np.cos(legs.beta), np.sin(legs.beta)
    w = np.stack([legs.alpha_dot * cb, legs.beta_dot, legs.alpha_dot * sb], axis=-1)
    turn = legs.alpha_dot * legs.beta_dot
    w_dot = np.stack(
        [legs.alpha_ddot * cb - turn * sb, legs.beta_ddot, legs.alpha_ddot * sb + turn * cb],
        axis=-1,
    )

    def acceleration(r: Array, r_dot: Array | float, r_ddot: Array | float) -> Array:
        return np.stack(
            [
                r * (w_dot[..., 1] + w[..., 0] * w[..., 2]) + 2 * r_dot * w[..., 1],
                r * (w[..., 1] * w[..., 2] - w_dot[..., 0]) - 2 * r_dot * w[..., 0],
                r_ddot - r * (w[..., 0] ** 2 + w[..., 1] ** 2),
            ],
            axis=-1,
        )

    return _LegMotion(
        rotation=leg_rotations(frames, legs.alpha, legs.beta),
        w=w,
        w_dot=w_dot,
        cylinder_acceleration=acceleration(np.broadcast_to(bodies.cylinder_com, legs.length.shape), 0.0, 0.0),
        piston_acceleration=acceleration(bodies.piston_com(legs.length), legs.rate, legs.accel),
    )


def _across_the_leg(bodies: LegBodies, legs: LegState, motion: _LegMotion, gravity: Array) -> tuple[Array, Array]:
    """Force of the platform on the legs, across them, and moment of the base, in leg axes, Eqs. (T2.29)-(T2.31)."""
    length, w, w_dot = legs.length, motion.w, motion.w_dot
    transverse, axial = bodies.transverse(length), bodies.axial
    transverse_dot = 2 * bodies.piston_mass * bodies.piston_com(length) * legs.rate
    static = bodies.static_moment(length)
    twist = axial * w_dot[..., 2] / np.cos(legs.beta)  # (T2.29)
    moment = twist[..., None] * np.stack([-np.sin(legs.beta), np.zeros_like(length), np.cos(legs.beta)], axis=-1)
    swing = w * w[..., 2:]
    hx = transverse * w_dot[..., 0] + transverse_dot * w[..., 0] + (axial - transverse) * swing[..., 1]
    hy = transverse * w_dot[..., 1] + transverse_dot * w[..., 1] + (transverse - axial) * swing[..., 0]
    across = np.stack(
        [
            (hy - static * gravity[..., 0]) / length,
            (moment[..., 0] - hx - static * gravity[..., 1]) / length,
            np.zeros_like(length),
        ],
        axis=-1,
    )
    return across, moment


def _along_the_legs(payload: PayloadBody, poses: Poses, arms: Array, axes: Array, sides: Array, load: Array) -> Array:
    """Force of the legs on the platform along them [N], (T, n), from the payload's balances, Eqs. (T2.32)-(T2.33)."""
    inertia = poses.rotation @ payload.inertia @ np.swapaxes(poses.rotation, -1, -2)
    spin = np.einsum("tij,tj->ti", inertia, poses.omega)
    _, _, com_acceleration = poses.point(payload.com)
    force = payload.mass * com_acceleration - load[:, :3] - sides.sum(axis=1)
    moment = np.einsum("tij,tj->ti", inertia, poses.alpha) + np.cross(poses.omega, spin)
    moment = moment - load[:, 3:] - np.cross(arms, sides).sum(axis=1)
    lines = np.concatenate([axes, np.cross(arms, axes)], axis=-1)
    balance = np.concatenate([force, moment], axis=-1)[..., None]
    try:
        return np.asarray(np.linalg.solve(np.swapaxes(lines, -1, -2), balance)[..., 0], dtype=np.float64)
    except np.linalg.LinAlgError:
        raise ComputationError(
            "The legs cannot carry the payload: a pose of the path is singular",
            next_step="Check the path for singular poses and change the layout or the motion",
        ) from None


def _inertial_forces(bodies: LegBodies, motion: _LegMotion, leg_gravity: Array) -> Array:
    """Mass times acceleration less weight of each leg, in leg axes (T, n, 3)."""
    cylinder = bodies.cylinder_mass[:, None] * (motion.cylinder_acceleration - leg_gravity)
    return cylinder + bodies.piston_mass[:, None] * (motion.piston_acceleration - leg_gravity)


def inverse_dynamics(
    frames: Array,
    platform_joints: Array,
    bodies: LegBodies,
    payload: PayloadBody,
    gravity: Array,
    poses: Poses,
    legs: LegState,
    wrench: Array | None = None,
) -> RigidForces:
    """Drive forces and joint reactions that move the rigid robot along a path, Eqs. (T2.26)-(T2.35).

    Parameters
    ----------
    frames : ndarray, shape (6, 3, 3)
        Home frames of the legs, from `kinematics.leg_frames`.
    platform_joints : ndarray, shape (6, 3)
        Platform axes [m].
    bodies, payload : LegBodies, PayloadBody
    gravity : ndarray, shape (3,)
        World axes [m/s^2].
    poses : Poses
        T poses.
    legs : LegState
        Of the same poses.
    wrench : ndarray, shape (T, 6) or (6,), optional
        External force and moment at the tool, world axes [N], [N m].

    Returns
    -------
    RigidForces

    Raises
    ------
    ComputationError
        If a pose is exactly singular.
    """
    motion = _leg_motion(frames, bodies, legs)
    leg_gravity = np.einsum("tnij,i->tnj", motion.rotation, gravity)
    across, moment = _across_the_leg(bodies, legs, motion, leg_gravity)
    sides = -np.einsum("tnij,tnj->tni", motion.rotation, across)
    axes = motion.rotation[..., 2]
    arms = np.einsum("tij,nj->tni", poses.rotation, platform_joints - payload.com)
    external = np.broadcast_to(np.zeros(6) if wrench is None else np.asarray(wrench, dtype=float), (len(poses), 6))
    lever = poses.rotation @ (payload.tool - payload.com)
    load = np.concatenate(
        [external[:, :3] + payload.mass * gravity, external[:, 3:] + np.cross(lever, external[:, :3])], axis=-1
    )
    along = _along_the_legs(payload, poses, arms, axes, sides, load)
    joint_force = sides + along[..., None] * axes
    thrust = bodies.piston_mass * (motion.piston_acceleration[..., 2] - leg_gravity[..., 2])
    inertial = _inertial_forces(bodies, motion, leg_gravity)
    return RigidForces(
        actuator_force=along + thrust,  # (T2.34)
        joint_force=joint_force,
        base_force=np.einsum("tnij,tnj->tni", motion.rotation, inertial) + joint_force,  # (T2.35)
        base_moment=np.einsum("tnij,tnj->tni", motion.rotation, moment),
    )


def energies(
    frames: Array,
    base_joints: Array,
    bodies: LegBodies,
    payload: PayloadBody,
    gravity: Array,
    poses: Poses,
    legs: LegState,
) -> tuple[Array, Array]:
    """Kinetic and gravity potential energy of the moving robot [J], shape (T,), Eq. (T2.36).

    Parameters
    ----------
    frames, bodies, payload, gravity, poses, legs
        As in `inverse_dynamics`.
    base_joints : ndarray, shape (6, 3)
        World axes [m].

    Returns
    -------
    kinetic, potential : ndarray, shape (T,)
        The potential is zero with all mass at the world's origin.
    """
    swing = (legs.alpha_dot * np.cos(legs.beta)) ** 2 + legs.beta_dot**2
    turn = (legs.alpha_dot * np.sin(legs.beta)) ** 2
    leg = bodies.transverse(legs.length) * swing + bodies.axial * turn + bodies.piston_mass * legs.rate**2
    com, com_dot, _ = poses.point(payload.com)
    local = np.einsum("tij,ti->tj", poses.rotation, poses.omega)
    body = payload.mass * np.sum(com_dot**2, axis=-1) + np.einsum("ti,ij,tj->t", local, payload.inertia, local)
    static = bodies.static_moment(legs.length)
    axes = leg_rotations(frames, legs.alpha, legs.beta)[..., 2]
    leg_moment = static[..., None] * axes + (bodies.cylinder_mass + bodies.piston_mass)[:, None] * base_joints
    potential = -(payload.mass * com + leg_moment.sum(axis=1)) @ gravity
    return (leg.sum(axis=-1) + body) / 2, potential
