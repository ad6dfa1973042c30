"""Newton-Euler inverse dynamics of the rigid robot, Eqs. (T2.26)-(T2.36).

Order of the computation: the moment balance of each leg about its universal joint gives the force across the leg at
the platform joint; the six balances of the payload give the force along the legs; the piston gives the drive force.

References
----------
Dasgupta & Mruthyunjaya, "A Newton-Euler formulation for the inverse dynamics of the Stewart platform manipulator",
Mech. Mach. Theory 33 (1998) 1135-1152. Here the legs turn about their own axis as the universal joint makes them.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np

from flexapod.common.arrays import Array
from flexapod.common.errors import ComputationError
from flexapod.kinematics.inverse import JointTurn, LegState, leg_rotations
from flexapod.kinematics.jacobian import sharing_inverse
from flexapod.kinematics.rotations import Vector, blocks, cross, rotate_vector, time_first, time_last
from flexapod.kinematics.trajectory import Poses


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
    def upright(self) -> LegBodies:
        """Bodies with columns (n, 1), for arrays (n, T)."""
        return LegBodies(**{field.name: getattr(self, field.name)[:, None] for field in fields(self)})

    @property
    def axial(self) -> Array:
        """Moment of inertia about the leg's axis [kg m^2], of the shape of the masses."""
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


class LoadSharing(NamedTuple):
    """Load sharing of n legs UPS that are not six driven ones: which of them carry, and how stiff they are."""

    stiffness: Array  # (n,), axial [N/m]
    pushed: Array  # (n,), forces of drives [N]; NaN of those that hold the robot, at least six


@dataclass(frozen=True, kw_only=True)
class RigidForces:
    """Forces of the rigid robot along a path of T poses, world axes.

    Attributes
    ----------
    actuator_force : ndarray, shape (T, n)
        Of the drive on the piston along the leg [N]; positive pushes out.
    joint_force : ndarray, shape (T, n, 3)
        Of the legs on the platform [N].
    base_force, base_moment : ndarray, shape (T, n, 3)
        Of the base on the legs, at the universal joints [N], [N m].
    """

    actuator_force: Array
    joint_force: Array
    base_force: Array
    base_moment: Array


class LegArrays(NamedTuple):
    """Legs of a block of poses, (n, T) each: lengths, turns of the universal joints, rates of the angles."""

    length: Array
    rate: Array
    accel: Array
    turn: JointTurn
    alpha_dot: Array
    beta_dot: Array
    alpha_ddot: Array
    beta_ddot: Array

    @classmethod
    def from_state(cls, legs: LegState, where: slice) -> LegArrays:
        """Build the arrays of a range of poses from the state of the legs."""
        alpha, beta = time_last(legs.alpha[where]), time_last(legs.beta[where])
        names = ("length", "rate", "accel", "alpha_dot", "beta_dot", "alpha_ddot", "beta_ddot")
        rest = {name: time_last(getattr(legs, name)[where]) for name in names}
        return cls(turn=JointTurn.from_angles(alpha, beta), **rest)


class LegMotion(NamedTuple):
    """Legs in their own axes (z along the leg): angular velocity, its rate, accelerations of the bodies' centres."""

    w: Vector  # [rad/s]
    w_dot: Vector  # components' rate [rad/s^2]
    cylinder_acceleration: Vector  # [m/s^2]
    piston_acceleration: Vector


def leg_motion(bodies: LegBodies, legs: LegArrays) -> LegMotion:
    """Angular rates of the legs, turn about their axis included, and CoM accelerations, Eqs. (T2.27)-(T2.28)."""
    cb, sb = legs.turn.cb, legs.turn.sb
    w = wx, wy, wz = legs.alpha_dot * cb, legs.beta_dot, legs.alpha_dot * sb
    joint = legs.alpha_dot * legs.beta_dot
    w_dot = legs.alpha_ddot * cb - joint * sb, legs.beta_ddot, legs.alpha_ddot * sb + joint * cb
    swing = w_dot[1] + wx * wz, wy * wz - w_dot[0], wx**2 + wy**2  # acceleration for each metre from the joint
    r, r_dot = bodies.piston_com(legs.length), 2 * legs.rate
    return LegMotion(
        w=w,
        w_dot=w_dot,
        cylinder_acceleration=[bodies.cylinder_com * x for x in (swing[0], swing[1], -swing[2])],
        piston_acceleration=(
            r * swing[0] + r_dot * wy,
            r * swing[1] - r_dot * wx,
            legs.accel - r * swing[2],
        ),
    )


def transverse_forces(bodies: LegBodies, legs: LegArrays, motion: LegMotion, gravity: Vector) -> tuple[Vector, Vector]:
    """Force of the platform on the legs, across them, and moment of the base, in leg axes, Eqs. (T2.29)-(T2.31)."""
    length, (wx, wy, wz), w_dot = legs.length, motion.w, motion.w_dot
    transverse, axial = bodies.transverse(length), bodies.axial
    transverse_dot = 2 * bodies.piston_mass * bodies.piston_com(length) * legs.rate
    static = bodies.static_moment(length)
    twist = axial * w_dot[2] / legs.turn.cb  # (T2.29)
    none = np.zeros_like(length)
    moment = -twist * legs.turn.sb, none, twist * legs.turn.cb
    hx = transverse * w_dot[0] + transverse_dot * wx + (axial - transverse) * wy * wz
    hy = transverse * w_dot[1] + transverse_dot * wy + (transverse - axial) * wx * wz
    across = (hy - static * gravity[0]) / length, (moment[0] - hx - static * gravity[1]) / length, none
    return across, moment


def axial_drive_force(bodies: LegBodies, motion: LegMotion, gravity: Vector, along: Array) -> Array:
    """Drive force from that of the leg on the platform, both along the leg [N], Eq. (T2.34)."""
    return along + bodies.piston_mass * (motion.piston_acceleration[2] - gravity[2])


def _payload_balance(payload: PayloadBody, gravity: Array, poses: Poses, wrench: Array) -> Array:
    """Force and moment that the legs exert on the payload at its CoM, (6, T), Eqs. (T2.32)-(T2.33)."""
    turn, w, alpha = time_last(poses.rotation), time_last(poses.omega), time_last(poses.alpha)
    back = turn.swapaxes(0, 1)
    inertia, w_local = payload.inertia[..., None], rotate_vector(back, w)
    spin = np.add(
        rotate_vector(inertia, rotate_vector(back, alpha)),
        cross(w_local, rotate_vector(inertia, w_local)),
    )
    arm, lever = rotate_vector(turn, payload.com), rotate_vector(turn, payload.tool - payload.com)
    acceleration = poses.acceleration.T + cross(alpha, arm) + np.array(cross(w, cross(w, arm)))
    force = payload.mass * (acceleration - gravity[:, None]) - wrench[:3]
    return np.concatenate([force, rotate_vector(turn, spin) - wrench[3:] - cross(lever, wrench[:3])])


def _along_the_legs(
    balance: Array, arms: Vector, axes: Vector, sides: Vector, own: Array, sharing: LoadSharing | None
) -> Array:
    """Force of the legs on the platform along them [N], (n, T), from the payload's balances, Eqs. (T2.32)-(T2.33).

    ``own`` (n, T): of the pistons, what a drive's force is reduced by on the way to the platform.
    """
    lines = np.array([*axes, *cross(arms, axes)])  # (6, n, T)
    rest = balance - np.array([x.sum(axis=0) for x in (*sides, *cross(arms, sides))])
    try:
        if sharing is None:
            found = np.linalg.solve(np.moveaxis(lines, -1, 0), rest.T[..., None])[..., 0]
            return np.asarray(found.T, dtype=np.float64)
        holds = np.isnan(sharing.pushed)
        along = sharing.pushed[:, None] - own
        rest = rest - np.einsum("int,nt->it", lines[:, ~holds], along[~holds])
        shares = sharing_inverse(np.moveaxis(lines[:, holds], -1, 0).swapaxes(1, 2), sharing.stiffness[holds])
        along[holds] = (shares @ rest.T[..., None])[..., 0].T  # (T7.30)
    except np.linalg.LinAlgError:
        raise ComputationError(
            "The legs cannot carry the payload: a pose of the path is singular",
            next_step="Check the path for singular poses and change the layout or the motion",
        ) from None
    return along


def _inertial_forces(bodies: LegBodies, motion: LegMotion, gravity: Vector) -> list[Array]:
    """Mass times acceleration less weight of each leg, in leg axes."""
    return [
        bodies.cylinder_mass * (c - g) + bodies.piston_mass * (p - g)
        for c, p, g in zip(motion.cylinder_acceleration, motion.piston_acceleration, gravity, strict=True)
    ]


def inverse_dynamics(
    frames: Array,
    platform_joints: Array,
    bodies: LegBodies,
    payload: PayloadBody,
    gravity: Array,
    poses: Poses,
    legs: LegState,
    wrench: Array | None = None,
    sharing: LoadSharing | None = None,
) -> RigidForces:
    """Drive forces and joint reactions that move the rigid robot along a path, Eqs. (T2.26)-(T2.35).

    Parameters
    ----------
    frames : ndarray, shape (n, 3, 3)
        Home frames of the legs, from `kinematics.leg_frames`.
    platform_joints : ndarray, shape (n, 3)
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
    sharing : LoadSharing, optional
        Of legs that are not six driven ones.

    Returns
    -------
    RigidForces

    Raises
    ------
    ComputationError
        If a pose is exactly singular.
    """
    count = len(poses)
    external = np.broadcast_to(np.zeros(6) if wrench is None else np.asarray(wrench, dtype=float), (count, 6))
    shapes, n = {"actuator_force": (count, len(frames))}, len(frames)
    forces = {field.name: np.empty(shapes.get(field.name, (count, n, 3))) for field in fields(RigidForces)}
    robot = frames, platform_joints - payload.com, bodies.upright
    for where in blocks(count):
        part = poses.part(where)
        balance = _payload_balance(payload, gravity, part, time_last(external[where]))
        found = _forces(*robot, gravity, part, LegArrays.from_state(legs, where), balance, sharing)
        for name, values in zip(forces, found, strict=True):
            forces[name][where] = values
    return RigidForces(**forces)


def _forces(
    frames: Array, joints: Array, bodies: LegBodies, gravity: Array, poses: Poses, legs: LegArrays, balance: Array,
    sharing: LoadSharing | None,
) -> tuple[Array, Array, Array, Array]:  # fmt: skip
    """Entries of `RigidForces` for one block; `joints` (n, 3) from the payload's CoM, `balance` (6, T)."""
    motion, home = leg_motion(bodies, legs), np.moveaxis(frames, 0, -1)[..., None]  # (3, 3, n, 1)

    def in_world(vector: Vector) -> tuple[Array, Array, Array]:
        return rotate_vector(home, legs.turn.out_of_leg(vector))

    leg_gravity = legs.turn.into_leg(rotate_vector(home.swapaxes(0, 1), gravity))
    across, moment = transverse_forces(bodies, legs, motion, leg_gravity)
    sides = [-x for x in in_world(across)]
    none = np.zeros_like(legs.length)
    axes = in_world((none, none, none + 1.0))
    own = none if sharing is None else axial_drive_force(bodies, motion, leg_gravity, none)
    along = _along_the_legs(balance, joints @ time_last(poses.rotation), axes, sides, own, sharing)
    joint_force = [side + along * axis for side, axis in zip(sides, axes, strict=True)]
    inertial = in_world(_inertial_forces(bodies, motion, leg_gravity))
    return (
        axial_drive_force(bodies, motion, leg_gravity, along).T,
        time_first(joint_force),
        time_first([i + f for i, f in zip(inertial, joint_force, strict=True)]),  # (T2.35)
        time_first(in_world(moment)),
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
