"""Resting place of a platform on legs that are welded to it, for large displacements: geometrically exact rods.

A leg turns on a cross at the base; its cylinder is rigid and grips the piston at the mouth; from there on the piston
is a rod that bends, twists and stretches (Kirchhoff and Clebsch: moments are linear in curvature and twist, whatever
the rotation). Rods are integrated by Runge and Kutta's method from the mouth to the tip, Newton's method finds what
meets at the platform, with derivatives by complex steps, as for parallel continuum robots: C. B. Black, J. Till,
D. C. Rucker, IEEE Trans. Robotics 34 (2018) 29-47. Rods: S. S. Antman, Nonlinear Problems of Elasticity (2005), ch. 8.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

STEPS = 40  # of a rod: error of the fourth order, 1e-8 of a turn of half a radian
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, kw_only=True)
class Robot:
    """Points at home: base joints (n, 3) in world axes, tips (n, 3) in platform axes, the platform's origin at home."""

    base: np.ndarray
    tips: np.ndarray
    home: np.ndarray
    com: np.ndarray  # platform axes
    mass: float
    mouth: float
    piston: float  # its whole length
    EI: float
    EA: float
    GJ: float
    rhoA: float = 0.0
    cylinder: tuple[float, float] = (0.0, 0.0)  # mass, centre from the base joint
    welded: tuple[bool, ...] = ()  # else a ball at the tip; default all welded
    gravity: np.ndarray = field(default_factory=lambda: np.array([0.0, 0.0, -9.81]))

    @property
    def weld(self):
        return np.array(self.welded or [True] * len(self.base))

    def frames(self):
        """Axes (n, 3, 3) of the legs at home: x level and across, z from base joint to tip."""
        z = self.home + self.tips - self.base
        z = z / np.linalg.norm(z, axis=1)[:, None]
        x = np.cross(UP, z)
        x = x / np.linalg.norm(x, axis=1)[:, None]
        return np.stack([x, np.cross(z, x), z], axis=2)


@dataclass(frozen=True)
class Rest:
    """Place and turn of the platform at rest; forces and moments (n, 3) of the legs on it at their tips; rods."""

    position: np.ndarray
    rotation: np.ndarray
    force: np.ndarray
    moment: np.ndarray
    unknowns: np.ndarray
    off_axis: np.ndarray  # distance of each tip from its cylinder's axis
    base_force: np.ndarray  # along the cylinder, at the mouth
    curvature: np.ndarray  # largest bending of each rod, 1/m


def rotation(axis, angle):
    """About x (0), y (1) or z (2); complex angles allowed."""
    c, s, R = np.cos(angle), np.sin(angle), np.zeros((*np.shape(angle), 3, 3), complex)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R[..., axis, axis] = 1
    R[..., i, i] = R[..., j, j] = c
    R[..., i, j], R[..., j, i] = -s, s
    return R


def turned(v):
    """Rotation (Cayley's map) of a vector of small angles; complex numbers allowed."""
    W = cross_matrix(v) / 2
    one = np.eye(3)
    return np.linalg.solve(one - W, one + W)


def cross_matrix(v):
    W = np.zeros((*v.shape[:-1], 3, 3), complex)
    W[..., 0, 1], W[..., 0, 2], W[..., 1, 2] = -v[..., 2], v[..., 1], -v[..., 0]
    return W - np.swapaxes(W, -1, -2)


def skew_part(R):
    return np.stack([R[..., 2, 1] - R[..., 1, 2], R[..., 0, 2] - R[..., 2, 0], R[..., 1, 0] - R[..., 0, 1]], -1) / 2


def times(R, v):
    return np.einsum("...ij,...j->...i", R, v)


def rod(robot, r, R, n, m, length):
    """From the mouth to the tip: place, axes, force, moment, and the largest bending on the way."""
    h, most = length / STEPS, 0.0
    compliance = 1 / np.array([robot.EI, robot.EI, robot.GJ])
    weight = robot.rhoA * robot.gravity

    def rates(r, R, n, m):
        curvature = times(np.swapaxes(R, -1, -2), m) * compliance
        tangent = R[..., 2]
        stretched = tangent * (1 + np.sum(n * tangent, -1) / robot.EA)[..., None]
        return stretched, R @ cross_matrix(curvature), -weight + 0 * n, -np.cross(stretched, n)

    state = (r, R, n, m)
    for _ in range(STEPS):
        local = times(np.swapaxes(state[1], -1, -2), state[3])[..., :2].real / robot.EI
        most = np.maximum(most, np.linalg.norm(local, axis=-1))
        step = (h[:, None], h[:, None, None], h[:, None], h[:, None])
        k1 = rates(*state)
        k2 = rates(*(x + d / 2 * k for x, d, k in zip(state, step, k1, strict=True)))
        k3 = rates(*(x + d / 2 * k for x, d, k in zip(state, step, k2, strict=True)))
        k4 = rates(*(x + d * k for x, d, k in zip(state, step, k3, strict=True)))
        state = tuple(
            x + d / 6 * (a + 2 * b + 2 * c + e) for x, d, a, b, c, e in zip(state, step, k1, k2, k3, k4, strict=True)
        )
    return (*state, most)


def legs(robot, lengths, position, R, x):
    """Rows (n, 8) that vanish at rest: cross free of moment, tip on the platform (or its moment nil), turn as welded.

    x (..., n, 8): two angles of the cross, force and moment at the mouth in units of F and F * 1 m.
    """
    frames = robot.frames()
    first = frames @ rotation(0, x[..., 0])
    A = first @ rotation(1, x[..., 1])
    z, force, moment = A[..., 2], F * x[..., 2:5], F * x[..., 5:8]
    free = lengths - robot.mouth
    inside = robot.piston - free
    drawn = robot.mouth + np.sum(force * z, -1) * inside / robot.EA
    twist = rotation(2, np.sum(moment * z, -1) * inside / robot.GJ)
    start = robot.base + z * drawn[..., None]
    end, E, tip_force, tip_moment, most = rod(robot, start, A @ twist, force, moment, free)
    mass, com = robot.cylinder
    arm = mass * com + robot.rhoA * inside * (robot.mouth - inside / 2)
    held = moment + np.cross(start - robot.base, force) + np.cross(arm[:, None] * z, robot.gravity)
    joint = np.stack([np.sum(frames[..., 0] * held, -1), np.sum(first[..., 1] * held, -1)], -1) / F
    place = times(R, robot.tips) + position
    E_P = np.swapaxes(E, -1, -2) @ (R @ frames)
    attached = np.where(robot.weld[:, None], skew_part(E_P), tip_moment / F)
    return np.concatenate([joint, end - place, attached], -1), (end, tip_force, tip_moment, most, A)


F = 1e3  # N: makes forces and lengths alike


def balance(robot, position, R, end, tip_force, tip_moment):
    """Force and moment about the centre of mass on the platform, over F."""
    arm = end - (position + times(R, robot.com))[..., None, :]
    force = robot.mass * robot.gravity - tip_force.sum(-2)
    moment = -(tip_moment + np.cross(arm, tip_force)).sum(-2)
    return np.concatenate([force, moment], -1) / F


def rest(robot, lengths, position, R, x=None, tolerance=1e-11):
    """Newton's method for the platform's place and all rods, from a guess; lengths (n,) as the drives hold them."""
    count = len(robot.base)
    x = np.zeros((count, 8)) if x is None else x.copy()
    h = 1e-30
    for _ in range(60):
        own = x + 1j * h * np.eye(8)[:, None, :]  # (8, n, 8)
        moves = 1j * h * np.eye(6)
        places, turns = position + moves[:, None, :3], R @ turned(moves[:, 3:])
        rows, parts = legs(robot, lengths, position, R.astype(complex), own)
        rows_p, _ = legs(robot, lengths, places, turns[:, None], np.broadcast_to(x + 0j, (6, count, 8)))
        value = rows[0].real
        base_parts = [np.asarray(p) for p in parts]
        J = np.zeros((8 * count + 6, 8 * count + 6))
        r = np.zeros(8 * count + 6)
        r[: 8 * count] = value.ravel()
        now = [p[0].real for p in base_parts[:3]]
        r[8 * count :] = balance(robot, position, R, *now)
        for i in range(count):
            at = slice(8 * i, 8 * i + 8)
            J[at, at] = rows[:, i].imag.T / h
            J[at, -6:] = rows_p[:, i].imag.T / h
            mixed = [np.broadcast_to(n, (8, *n.shape)).astype(complex).copy() for n in now]
            for k in range(3):
                mixed[k][:, i] = base_parts[k][:, i]
            J[-6:, at] = balance(robot, position, R, *mixed).imag.T / h
        fixed = [np.broadcast_to(n, (6, *n.shape)) for n in now]
        J[-6:, -6:] = balance(robot, places[:, 0], turns, *fixed).imag.T / h
        if np.abs(r).max() < tolerance:
            end, force, moment, most, A = (p[0].real if np.iscomplexobj(p) else p[0] for p in parts)
            z = A[..., 2]
            arm = end - robot.base
            off = np.linalg.norm(arm - z * np.sum(arm * z, -1)[:, None], axis=1)
            push = F * np.sum(x[:, 2:5] * z, -1)
            return Rest(position, R, -force, -moment, x, off, push, most)
        step = np.linalg.solve(J, -r)
        share = min(1.0, 0.3 / np.abs(step[-3:]).max(), 0.05 / np.abs(step[-6:-3]).max())
        x = x + share * step[:-6].reshape(count, 8)
        position = position + share * step[-6:-3]
        R = R @ turned(share * step[-3:]).real
    raise ValueError(f"no equilibrium: {np.abs(r).max():.2g} is left")


def rolled(robot, angles):
    """Resting places while the drives follow the lengths that a robot with balls would have, roll by roll [rad].

    Yields angle, displacement of the centre of mass from where the rigid robot has it, and the rest.
    """
    position, R, x = robot.home, np.eye(3), None
    for angle in angles:
        turn = rotation(0, angle).real
        lengths = np.linalg.norm(robot.home + robot.tips @ turn.T - robot.base, axis=1)
        found = rest(robot, lengths, position, R, x)
        position, R, x = found.position, found.rotation, found.unknowns
        yield angle, position + R @ robot.com - robot.home - turn @ robot.com, found
